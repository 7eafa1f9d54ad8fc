"""The page of a study: an HTML file from the files of a results folder. The page works offline."""

from __future__ import annotations

import math
import os
import re
import shlex
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import jinja2
from markupsafe import Markup, escape

from reports.figures.colours import inks
from reports.figures.pairs import pairs_figure
from reports.figures.speed import speed_figure
from reports.figures.style import for_page, save
from reports.figures.survival import has_survival, survival_figure
from reports.page.documents import documents
from reports.page.gallery import shelves
from reports.page.heat_map import heat_maps
from reports.page.more_builds import difference_note, share_note
from reports.page.problems import problems
from reports.page.scene_names import scene_names, title_of
from reports.page.set_ups import first_place, set_up_description
from reports.page.summary import verdicts
from reports.page.traces import traces
from reports.records.atomic import write_atomic
from reports.records.folder import ResultsFolder
from reports.records.trial import TrialRecord
from reports.statistics.groups import Group, grouped, groups_of, ordered_policies
from reports.statistics.pairs import PairRow, pair_rows, paired_scenes
from reports.statistics.ranking import rank
from reports.statistics.scores import EngineScores, engine_scores
from reports.statistics.thresholds import of_fixed_scenes
from reports.tables.capabilities import capability_table
from reports.tables.comparison import COLUMNS, Column, ComparisonRow, Entry, comparison_rows, comparison_table
from reports.tables.latex import pairs_to_latex, to_latex
from reports.tables.pairs import pair_tables, paired_scenes_table, pairs_csv
from reports.tables.policies import POLICY_SENTENCES
from reports.tables.table import NOTHING, to_markdown, write_table_csv
from reports.tables.verdict import ranking_table, sentence
from reports.tables.wording import percent

_TEMPLATES = Path(__file__).parent / "templates"
_REM = 16.0
"""Default font size of browsers [px]."""
_MOST_MESSAGES = 3
"""Greatest number of distinct messages in one row."""
_ROWS_SHOWN = 200
"""Number of rows of the comparison that the page shows at first, because more rows take seconds to lay out."""
_PLACES_SHOWN = 12
"""Number of places of the ranking that the page shows at first, because most readers choose one of these places."""
_RUN = ("uv", "run", "-m", "bench", "run")
"""Command that runs a study, without its arguments."""
_SCRIPTS = ("theme.js", "landing.js", "comparison.js", "heat_map.js", "traces.js")
_QUESTION = "Do the bricks stand when they should, and fall when they should?"
"""First sentence of the page of a study without a description."""
_MARKS = {"right": "✓", "wrong": "✗", "mixed": "~"}


def write_page(folder: Path, records: Sequence[TrialRecord], missing: Sequence[str] = ()) -> Path:
    """Write ``report/index.html``, its figures, and tables of the comparison and the pairs into a results folder.

    Args:
        folder: a results folder.
        records: records of the folder, at least one.
        missing: ids of planned trials without a record.

    Returns:
        Path of the page.
    """
    report = folder / "report"
    figures = report / "figures"
    figures.mkdir(parents=True, exist_ok=True)
    kept, groups = ResultsFolder(folder), groups_of(records)
    scores, engines, names = engine_scores(groups), kept.engines, scene_names(records)
    fixed = of_fixed_scenes(records, kept.study)
    judged = rank(groups_of(fixed), kept.reference_engines)
    sentences = verdicts(scores)
    thinned, without_frames = traces(folder, groups)
    study = kept.study.get("name")
    rows, of_pairs, study_caption = comparison_rows(groups), pair_rows(groups), caption(folder, records)
    again = shlex.join([*_RUN, _study_file(folder) if study is not None else "STUDY"])
    policies, shown = ordered_policies(group.key.policy for group in groups), _columns(rows)
    page = (
        _environment()
        .get_template("page.html.j2")
        .render(
            title=title_of(records, study or folder.resolve().name),
            description=kept.study.get("description") or _QUESTION,
            caption=study_caption,
            css=_part("page.css"),
            scripts=[_part(name) for name in _SCRIPTS],
            verdict=sentence(judged, len(missing)),
            first=first_place(judged, engines),
            ranking=ranking_table(judged, records),
            maps=heat_maps(groups_of(fixed), judged, names),
            names=names,
            policies={name: POLICY_SENTENCES.get(name, "A policy of your own.") for name in policies},
            row_data=_row_data(groups, names, _study_file(folder) if study is not None else None),
            rows_shown=_ROWS_SHOWN,
            inks=inks(policies),
            numbers={policy: number for number, policy in enumerate(policies)},
            problems=problems(records, missing, without_frames, again),
            verdicts=sentences,
            share_note=share_note(groups, bool(of_pairs), again),
            difference_note=difference_note(groups, policies, again),
            documents=documents(report),
            ranked_rows_shown=_PLACES_SHOWN,
            set_ups={
                (one.engine, one.profile): set_up_description(engines, one.engine, one.profile) for one in sentences
            },
            pairs=_pairs(of_pairs, groups, names, figures, policies),
            rows=rows,
            columns=shown,
            left_out=[column for number, column in enumerate(COLUMNS) if number not in shown],
            marks=_MARKS,
            choices=_choices(groups, names),
            set_up_names=list(dict.fromkeys(" ".join(group.key[1:]) for group in groups)),
            survival=_survival(groups, figures, policies, names),
            speed=_speed(scores, figures, policies),
            traces=[{**trace, "scene": names[trace["scene"]]} for trace in thinned],
            shelves=shelves(report, groups),
            engines=engines,
            capabilities=capability_table(engines) if engines else None,
            again=again if study is not None else None,
            environment=_machine(folder),
            settings=kept.environment.get("settings", {}),
        )
    )
    write_atomic(report / "index.html", page.encode())
    _write_tables(report, rows, of_pairs, study_caption, study or folder.resolve().name)
    return report / "index.html"


def _columns(rows: Sequence[ComparisonRow]) -> dict[int, Column]:
    """Return the first three columns of the comparison, and all other columns with an entry in a row, by number."""
    return {
        number: column
        for number, column in enumerate(COLUMNS)
        if number < 3 or any(row.entries[number].text != NOTHING for row in rows)
    }


def _write_tables(
    report: Path, rows: Sequence[ComparisonRow], of_pairs: Sequence[PairRow], caption: str, label: str
) -> None:
    """Write the comparison as Markdown, CSV and LaTeX, and the pairs, if any, as CSV and LaTeX."""
    table = comparison_table(rows, caption)
    write_atomic(report / "comparison.md", to_markdown([table]).encode())
    write_table_csv(report / "comparison.csv", table)
    write_atomic(report / "tables.tex", to_latex(rows, caption, label).encode())
    if of_pairs:
        write_atomic(report / "pairs.csv", pairs_csv(of_pairs).encode())
        write_atomic(report / "pairs.tex", pairs_to_latex(of_pairs, caption, label).encode())


def caption(folder: Path, records: Sequence[TrialRecord]) -> str:
    """Return the caption of a table or page: numbers of trials and seeds, engine versions, dates and commit.

    The dates and the commit are absent if the environment of the folder lacks them.
    """
    seeds = len({record.seed for record in records})
    versions = sorted({f"{record.engine} {record.engine_version}" for record in records})
    environment = ResultsFolder(folder).environment
    begun = [session.get("begun", "")[:10] for session in environment.get("sessions", [])]
    when = f", run {' to '.join(dict.fromkeys([begun[0], begun[-1]]))}" if begun else ""
    commit = f", commit {environment['commit'][:10]}" if environment.get("commit") else ""
    return f"n = {len(records)} trials, {seeds} seed{'s' * (seeds > 1)}; {', '.join(versions)}{when}{commit}."


def _environment() -> jinja2.Environment:
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(_TEMPLATES), autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True
    )
    environment.filters["percent"] = percent
    environment.filters["messages"] = _messages
    environment.filters["seeds"] = lambda row: _seeds(row.group)
    environment.filters["sort_key"] = _sort_key
    environment.filters["with_code"] = _with_code
    return environment


def _part(name: str) -> Markup:
    """Return the content of a template file, which the page includes unchanged."""
    return Markup((_TEMPLATES / name).read_text(encoding="utf-8"))


def _study_file(folder: Path) -> str:
    """Return the path of the folder's study file, relative to the working directory, for a command line."""
    return os.path.relpath(folder / "study.toml")


def _row_data(groups: Sequence[Group], names: Mapping[str, str], study: str | None) -> dict[str, Any]:
    """Return the data for the commands that reproduce the rows, and the theory of each scene."""
    return {
        "command": [*_RUN, *([study] if study is not None else [])],
        "seeds": Counter(map(_seeds, groups)).most_common(1)[0][0],
        "scenes": {
            names[group.key.scene]: {"scenario": group.scenario, "theory": group.expectation.theory} for group in groups
        },
    }


def _seeds(group: Group) -> int:
    """Return the value of the option ``--seeds`` that plays all seeds of a group."""
    return max(trial.seed for trial in group.trials) + 1


def _sort_key(entry: Entry) -> str:
    """Return the HTML attributes of an entry: a class for an empty entry, a sort key for a text other than a number.

    The result is empty for a number, and for a text without a sort key.
    """
    if entry.text == NOTHING:
        return Markup(' class="n"')
    if math.isnan(entry.sort) or re.fullmatch(r"[\d.]+", entry.text):
        return ""
    return Markup(f' data-sort="{entry.sort:.6g}"')


def _with_code(text: str) -> Markup:
    """Return a text as HTML, with its parts between backticks as code."""
    return Markup(re.sub(r"`([^`]+)`", r"<code>\1</code>", str(escape(text))))


def _messages(row: ComparisonRow) -> list[str]:
    """Return up to ``_MOST_MESSAGES`` distinct messages of a row's draws, and the number of further messages."""
    found = list(dict.fromkeys(trial.message for trial in row.group.draws if trial.message))
    more = len(found) - _MOST_MESSAGES
    return found[:_MOST_MESSAGES] + ([f"and {more} more"] if more > 0 else [])


def _choices(groups: Sequence[Group], names: Mapping[str, str]) -> dict[str, list[str]]:
    choices = {
        "scene": list(names.values()),
        "family": list(dict.fromkeys(group.scenario for group in groups)),
        "engine": list(dict.fromkeys(group.key.engine for group in groups)),
        "profile": list(dict.fromkeys(group.key.profile for group in groups)),
        "policy": ordered_policies(group.key.policy for group in groups),
    }
    return {**choices, "outcome": ["right", "wrong", "mixed", "open"]}


def _pairs(
    rows: Sequence[PairRow], groups: Sequence[Group], names: Mapping[str, str], folder: Path, policies: Sequence[str]
) -> dict[str, Any] | None:
    """Return the figure and the tables of the pairs, and the table of their scenes; None without pairs."""
    if not rows:
        return None
    svg, scenes = save(pairs_figure(rows), folder / "pairs"), paired_scenes(groups)
    return {
        "tables": pair_tables(rows, scenes),
        "scenes": paired_scenes_table(scenes, names),
        "figure": _drawing(svg, "Shares of pairs correct and not", policies),
    }


def _survival(
    groups: Sequence[Group], folder: Path, policies: Sequence[str], names: Mapping[str, str]
) -> list[dict[str, Any]]:
    drawn = []
    for (scene, profile), those in grouped(groups, "key.scene", "key.profile").items():
        if has_survival(those):
            svg = save(survival_figure(those), folder / f"survival-{scene}-{profile}")
            title = f"{names[scene]}, {profile}: theory says it {those[0].expectation}"
            drawn.append({"title": title, **_drawing(svg, f"Survival by level of {title}", policies)})
    return drawn


def _speed(scores: Sequence[EngineScores], folder: Path, policies: Sequence[str]) -> dict[str, Any] | None:
    figure = speed_figure(scores)
    if figure is None:
        return None
    return _drawing(save(figure, folder / "speed"), "Share of stacks correct against frame time", policies)


def _drawing(svg: str, label: str, policies: Sequence[str]) -> dict[str, Any]:
    width = re.search(r'width="([\d.]+)pt"', svg)
    points = float(width[1]) if width else 480.0
    return {"svg": for_page(svg, label, policies), "width": round(points * 4 / 3 * 1.15 / _REM, 1)}


def _machine(folder: Path) -> dict[str, str]:
    """Return the environment as texts by name, without the parts that other sections of the page show."""
    kept = ResultsFolder(folder).environment
    plain = {key: value for key, value in kept.items() if key not in ("engines", "sessions", "settings")}
    return {key: _flat(value) for key, value in plain.items()}


def _flat(value: Any) -> str:
    return ", ".join(f"{key} {item}" for key, item in value.items()) if isinstance(value, dict) else str(value)
