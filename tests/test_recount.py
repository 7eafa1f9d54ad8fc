"""A recount of the published raw data gives the numbers of the documents, by nothing but ``reports.load``."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import replace
from operator import itemgetter
from pathlib import Path

import pandas as pd
import pytest

import reports
from bench.publishing.catalogue import PUBLICATIONS
from bench.publishing.doc_blocks import BLOCKS
from reports.records.folder import ResultsFolder
from reports.report import OF_TIMES
from reports.statistics.groups import groups_of
from reports.statistics.pairs import pair_rows, paired_scenes
from reports.statistics.ranking import rank
from reports.statistics.thresholds import of_fixed_scenes
from reports.tables.collapse_levels import collapse_level_tables
from reports.tables.pairs import pair_tables
from reports.tables.piles import pile_tables
from reports.tables.study import study_tables
from reports.tables.table import Table, to_markdown
from reports.tables.verdict import sentence

ROOT = Path(__file__).parent.parent
PUBLISHED = ROOT / "docs" / "results"
STUDIES = sorted(path.parent.name for path in PUBLISHED.glob("*/study.toml"))
DECIDED = ("right", "false_collapse", "false_stand", "creeps", "failed")


def rows_of(block: str) -> list[dict[str, str]]:
    """Rows of the table in a generated block of a document."""
    document = (ROOT / BLOCKS[block][0]).read_text(encoding="utf-8")
    found = re.search(rf"<!-- begin {block}\b.*?<!-- end {block} -->", document, re.DOTALL)
    assert found is not None
    lines = [line.strip("|").split("|") for line in found[0].splitlines() if line.startswith("|")]
    header, _, *rows = [[cell.strip() for cell in line] for line in lines]
    assert len(rows) > 4
    return [dict(zip(header, row, strict=True)) for row in rows]


def counted(right: pd.Series) -> str:
    """Such as ``38/40``; a dash if there is nothing to count."""
    return f"{right.sum()}/{len(right)}" if len(right) else "-"


def test_the_headline() -> None:
    """How each trial of the paper's study ended, and whether that was right."""
    trials = reports.load(PUBLISHED / "paper").trials.set_index(["scene", "engine", "policy"])
    rows = rows_of("headline")
    assert len(trials) == sum(len(row) - 3 for row in rows)
    for row in rows:
        for policy in (name for name in row if name not in ("scene", "theory", "engine")):
            assert row[policy] == ending(trials.loc[(row["scene"], row["engine"], policy)]), row


def ending(trial: Mapping[str, object]) -> str:
    if trial["status"] == "unsupported":
        return "n/a"
    text = f"{trial['height_levels']}/{trial['levels_planned']}"
    if trial["status"] == "timeout":
        text = f"≥{text}"
    elif trial["status"] == "collapsed":
        text = f"{'sinks' if trial['collapse_kind'] == 'sink' else 'falls'} at {trial['collapse_level']}"
    elif trial["verdict"] == "creeps":
        text += " creeps"
    return text + (" ✓" if trial["verdict"] == "right" else " ✗" if trial["verdict"] in DECIDED else "")


def test_many_seeds() -> None:
    """How many trials were right, of those that must stand and of those that must fall."""
    trials = reports.load(PUBLISHED / "publish").trials
    decided = trials[trials["verdict"].isin(DECIDED)]
    right = (decided["verdict"] == "right").groupby(
        [decided["engine"], decided["policy"], decided["expectation_outcome"]]
    )
    found = right.apply(counted).to_dict()
    for row in rows_of("many_seeds"):
        engine = row.pop("engine")
        assert row == {column: found.get((engine, *column.split(": ")), "-") for column in row}


def test_pairs() -> None:
    """In how many pairs both sides were right, of those of which both were decided, in profile `tuned`."""
    trials = reports.load(PUBLISHED / "truth").trials
    sides = trials[(trials["pair"] != "") & (trials["repeat"] == 0) & (trials["profile"] == "tuned")]
    sides = sides.assign(decided=sides["verdict"].isin(DECIDED), right=sides["verdict"] == "right")
    builds = sides.groupby(["engine", "policy", "pair", "seed"]).agg(
        sides=("right", "size"), decided=("decided", "all"), right=("right", "all")
    )
    judged = builds[(builds["sides"] == 2) & builds["decided"]]
    found = judged.groupby(["engine", "policy"])["right"].apply(counted).to_dict()
    for row in rows_of("pairs"):
        engine = row.pop("engine")
        assert row == {policy: found.get((engine, policy), "-") for policy in row}


@pytest.mark.parametrize("name", ["paper", "profiles", "truth"])
def test_the_verdict_of_a_report(name: str) -> None:
    """Which set-up is right in every pair and every other scene, at the least median frame time; or that none is."""
    trials = reports.load(PUBLISHED / name).trials
    judged = trials[(trials["expectation_outcome"] != "study") & (trials["repeat"] == 0)]
    scenes = judged.groupby("pair")["scene"].nunique()
    paired = judged["pair"].isin(scenes[scenes == 2].drop("", errors="ignore").index)
    unit = judged["pair"].where(paired, judged["scene"])
    right = (judged["verdict"] == "right").groupby([judged["engine"], judged["profile"], judged["policy"], unit]).all()
    counts = right.groupby(level=[0, 1, 2]).sum()
    median = judged.groupby(["engine", "profile", "policy", "scene"])["frame_ms_p50"].median().groupby(level=[0, 1, 2])
    frame_ms = median.median().reindex(counts.index)
    ranking = rank(groups_of(ResultsFolder(PUBLISHED / name).records))
    assert len(ranking.units) == unit.nunique()
    assert {tuple(place.set_up): place.right for place in ranking.places} == counts.to_dict()
    in_all = counts[counts == unit.nunique()].index
    assert [tuple(place.set_up) for place in ranking.all_right] == list(frame_ms[in_all].sort_values().index)
    best = frame_ms[in_all].idxmin() if len(in_all) else None
    expected = "No set-up is"
    if best is not None:
        method = "alone" if best[2] == "none" else f"with {best[2]}"
        expected = f"Cheapest set-up that is right in all .*: {best[0]} {best[1]} {method}"
    assert re.match(expected, sentence(ranking))


SLOPE_DEG, SLOPE_SEARCH = 20.0, 0.001
"""Slope [deg] on which the friction is bisected, and the width of the last bracket: see the study ``thresholds``."""


def in_game(study: str) -> pd.DataFrame:
    trials = reports.load(PUBLISHED / study).trials
    return trials[(trials["profile"] == "game") & (trials["repeat"] == 0)]


def effective_friction(trials: pd.DataFrame) -> float:
    """The middle between the least friction at which the block stood and the greatest at which it slid, in percent."""
    stood = trials[trials["status"] == "completed"]["parameters"].map(itemgetter("friction"))
    slid = trials[trials["status"] == "collapsed"]["parameters"].map(itemgetter("friction"))
    assert stood.min() - slid.max() <= SLOPE_SEARCH
    return 100 * (stood.min() + slid.max()) / 2 / math.tan(math.radians(SLOPE_DEG))


def greatest_ratio(trials: pd.DataFrame) -> float:
    """The middle between the greatest ratio that stood and the least that toppled, in percent of 1 / tan(slope)."""
    stood = trials[trials["status"] == "completed"]["parameters"].map(itemgetter("ratio"))
    fell = trials[trials["status"] == "collapsed"]["parameters"].map(itemgetter("ratio"))
    assert fell.min() - stood.max() <= 10 * SLOPE_SEARCH
    return 100 * (stood.max() + fell.min()) / 2 * math.tan(math.radians(SLOPE_DEG))


def test_what_separates_engines() -> None:
    """Each figure of the README's table."""
    studies = {name: in_game(name) for name in ("thresholds", "tilt", "soak", "heavy", "issues", "sleep")}
    for row in rows_of("separation"):
        engine, method = row["engine"], row["method"]
        of = {
            name: trials[(trials["engine"] == engine) & (trials["policy"] == method)]
            for name, trials in studies.items()
        }
        sliding, toppling = (
            of["thresholds"][of["thresholds"]["scene"].str.startswith(f"slope-{name}")]
            for name in ("friction", "ratio")
        )
        assert float(row["friction"].split(" ")[0]) == pytest.approx(effective_friction(sliding), abs=0.01)
        assert float(row["toppling"].split(" ")[0]) == pytest.approx(greatest_ratio(toppling), abs=0.01)
        stood = of["soak"][of["soak"]["status"] == "completed"]
        shown, creep = row["creep"].split(" ")[0], 1e6 * stood["creep_m_s"].median()
        assert creep < float(shown[1:]) if shown.startswith("<") else float(shown) == pytest.approx(creep, rel=0.05)
        assert ("lost" in row["creep"]) == (len(stood) < len(of["soak"]))
        for column, study in (("heavy on light", "heavy"), ("threads", "issues")):
            judged = of[study][of[study]["verdict"].isin(DECIDED)]
            assert row[column] == counted(judged["verdict"] == "right"), (row, column)
        sleeping = studies["sleep"][studies["sleep"]["engine"] == engine]
        asleep = sleeping[sleeping["policy"] == ("native" if method == "none" else method)]["asleep_s"]
        assert row["asleep"] == (f"{asleep.max():.2f}" if asleep.notna().any() else "-")


@pytest.mark.parametrize("name", STUDIES)
def test_every_published_study_can_be_loaded(name: str) -> None:
    results = reports.load(PUBLISHED / name)
    assert len(results.trials)
    assert results.study["name"]
    assert results.environment["commit"]
    assert set(results.trials["verdict"]) <= {*DECIDED, "undecided", "none"}
    timed_out = results.trials["status"] == "timeout"
    assert not results.trials["verdict"][timed_out].isin(DECIDED).any()


def with_plain_ratios(table: Table, trials: pd.DataFrame) -> Table:
    """The table of frame times as earlier versions wrote it: ratios are medians of however many pairs there are."""
    several = len(set(trials["profile"])) > 1
    engine = trials["engine"] + " " + trials["profile"] if several else trials["engine"]
    measured = trials.assign(shown=engine).dropna(subset="frame_ratio").groupby(["scene", "shown", "policy"])
    cells = {}
    for key, group in measured:
        low, high = group["frame_ratio_level"].min(), group["frame_ratio_level"].max()
        cells[key] = f"{group['frame_ratio'].median():.2f} at {low}" + ("" if low == high else f"-{high}")
    return replace(table, rows=tuple((*row[:-1], cells.get(row[:3], "-")) for row in table.rows))


@pytest.mark.parametrize("name", STUDIES)
def test_the_published_tables_can_be_made_again_from_the_published_trials(name: str) -> None:
    """Every row of all tables that need no frames, to the last digit."""
    folder = ResultsFolder(PUBLISHED / name)
    records = of_fixed_scenes(folder.records, folder.study)
    published = (PUBLISHED / name / "tables.md").read_text(encoding="utf-8")
    if not records:
        pytest.skip("all of its scenes are bisected")
    tables = [*study_tables(records), *pair_tables(pair_rows(groups := groups_of(records)), paired_scenes(groups))]
    if "pairs and its 95 % interval" not in published:
        trials = reports.load(PUBLISHED / name).trials
        tables = [with_plain_ratios(table, trials) if table.id == "frame_time" else table for table in tables]
    tables += [*pile_tables(records), *collapse_level_tables(records)]
    if not PUBLICATIONS[name].is_timed:
        tables = [table for table in tables if table.id not in OF_TIMES]
    rows = [line for line in to_markdown(tables).splitlines() if line.startswith("| ")]
    assert len(rows) > 20
    later = re.compile(r"(\| falls at \d+) after [\d.]+ s")  # earlier versions did not say after how long
    places = [max(published.find(f"{row}\n"), published.find(later.sub(r"\1", row) + "\n")) for row in rows]
    assert [row for row, place in zip(rows, places, strict=True) if place < 0] == []
