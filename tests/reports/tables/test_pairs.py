"""Pairs of scenes and the ways of missing them, against cases worked by hand."""

import csv
import io
from dataclasses import replace

import pytest
from scipy import stats

from reports.page.summary import verdicts
from reports.records.trial import TrialRecord
from reports.statistics.groups import groups_of
from reports.statistics.pairs import ALL, PairRow, are_opposed, pair_rows, paired_scenes
from reports.statistics.scores import engine_scores
from reports.tables.pairs import pair_tables, paired_scenes_table, pairs_csv
from reports.tables.table import Table, to_markdown
from scenarios.model import Expectation
from tests.reports.studies import FALLS, STANDS, record


def side(pair: str, outcome: str, verdict: str, seed: int = 0, **fields) -> TrialRecord:
    """One side of a pair: ``FAMILY-...-stand`` or ``FAMILY-...-fall``."""
    theory = STANDS if outcome == "stand" else FALLS
    return record(
        **{
            "scene": f"{pair}-{outcome}",
            "pair": pair,
            "expectation": theory,
            "verdict": verdict,
            "seed": seed,
            **fields,
        }
    )


def both(pair: str, stand: str, fall: str, seed: int = 0, **fields) -> list[TrialRecord]:
    return [side(pair, "stand", stand, seed, **fields), side(pair, "fall", fall, seed, **fields)]


def row(records: list[TrialRecord], family: str = ALL) -> PairRow:
    [found] = [one for one in pair_rows(groups_of(records)) if one.family == family]
    return found


def tables(records: list[TrialRecord]) -> list[Table]:
    groups = groups_of(records)
    return pair_tables(pair_rows(groups), paired_scenes(groups))


def across_engines() -> list[TrialRecord]:
    """Both sides of a pair, each on another engine, which are no pair."""
    return [side("a", "stand", "right"), side("a", "fall", "right", engine="mujoco")]


def values(one: PairRow) -> list[float]:
    assert one.success_rates is not None
    return [
        one.success_rates.right.value,
        one.success_rates.false_stand.value,
        one.success_rates.false_collapse.value,
        one.success_rates.failed.value,
    ]


def test_each_way_of_missing_a_pair_is_distinguished() -> None:
    records = [
        *both("table-1", "right", "right"),
        *both("table-2", "right", "false_stand"),
        *both("table-3", "false_collapse", "right"),
        *both("ramp-1", "false_collapse", "false_stand"),  # the wrong way round
        *both("ramp-2", "failed", "false_collapse"),  # one crashed, the other fell too early
    ]
    assert values(row(records)) == [1 / 5, 2 / 5, 3 / 5, 1 / 5]
    assert values(row(records, "table")) == [1 / 3, 1 / 3, 1 / 3, 0]
    assert values(row(records, "ramp")) == [0, 1 / 2, 1, 1 / 2]


def test_glue_and_jelly_get_half_of_the_trials_and_no_pair() -> None:
    for sides in (("right", "false_stand"), ("false_collapse", "right")):
        [verdict] = verdicts(engine_scores(groups_of([one for n in range(4) for one in both(f"table-{n}", *sides)])))
        [score] = verdict.scores
        assert score.trials is not None
        assert score.trials.right.value == 0.5
        assert score.headline is score.pairs
        assert score.headline is not None
        assert score.headline.right.value == 0
        assert "0 % of the pairs right" in verdict.headline


def test_a_pair_of_which_a_side_is_not_judged_counts_nowhere() -> None:
    records = [
        *both("a", "right", "right"),
        side("b", "stand", "undecided", status="timeout"),  # slow, which is not wrong
        side("b", "fall", "false_stand"),
        side("c", "stand", "none"),  # built too near its limit
        side("c", "fall", "right"),
    ]
    found = row(records)
    assert values(found) == [1, 0, 0, 0]
    assert (found.success_rates.n if found.success_rates else None, found.undecided) == (1, 2)


def test_what_lacks_its_partner_is_no_pair() -> None:
    alone = [side("a", "stand", "right"), record(), side("b", "stand", "right"), side("b", "fall", "right", seed=1)]
    [found] = [one for one in pair_rows(groups_of(alone)) if one.family == ALL]
    assert found.success_rates is None, "of the pair b no seed has both sides"
    assert pair_rows(groups_of([record()])) == []
    assert tables([record()]) == []
    assert paired_scenes(groups_of(across_engines())) == [], "sides on two engines"


def test_policies_and_engines_have_pairs_of_their_own() -> None:
    records = [*both("a", "right", "right"), *both("a", "right", "false_stand", policy="at_rest")]
    found = [(one.set_up.policy, values(one)[0]) for one in pair_rows(groups_of(records)) if one.family == ALL]
    assert found == [("none", 1), ("at_rest", 0)]
    assert pair_rows(groups_of(across_engines())) == []


def test_repeats_of_a_seed_are_no_further_pairs() -> None:
    records = [*both("a", "right", "right"), *both("a", "right", "false_stand", repeat=1)]
    assert values(row(records)) == [1, 0, 0, 0]


def test_one_seed_has_no_interval_and_says_so() -> None:
    records = [*both("a", "right", "right"), *both("b", "right", "false_stand")]
    found = row(records)
    assert found.success_rates is not None
    assert (found.success_rates.right.low, found.success_rates.false_stand.high) == (None, None)
    output = to_markdown(tables(records))
    assert "| bullet | game | none | 1/2 | 50 % | 50 % | 0 % | 0 % | - |" in output
    assert "n = 1 build of each: no intervals" in output


def test_the_interval_of_one_pair_is_the_binomials_and_of_several_that_of_drawing_pairs() -> None:
    one = [trial for seed in range(20) for trial in both("a", "right", "right" if seed < 14 else "false_stand", seed)]
    found = row(one).success_rates
    assert found is not None
    low, high = stats.binom(20, 0.7).ppf([0.025, 0.975]) / 20
    assert found.right.low == pytest.approx(low, abs=0.05)  # one of the 20 that can be drawn
    assert found.right.high == pytest.approx(high, abs=0.05)
    assert found.false_stand.low == pytest.approx(1 - high, abs=0.05)

    two = [
        trial
        for seed in range(20)
        for pair, fall in (("a", "right"), ("b", "false_stand"))
        for trial in both(pair, "right", fall, seed)
    ]
    apart = row(two).success_rates
    assert apart is not None
    assert (apart.right.low, apart.right.high) == (0.0, 1.0), "of two pairs drawn, both are the same half of the time"


def test_the_table_by_family_counts_what_was_missed() -> None:
    records = [*both("table-1", "right", "right"), *both("table-2", "failed", "false_stand")]
    [_, families] = tables(records)
    assert families.rows == (("table", "bullet", "game", "1/2 1s 1f"),)


def test_the_tables_name_how_many_scenes_and_which_the_pairs_judge() -> None:
    """One pair of a family of four scenes says nothing of the other two; a family without pairs is named too."""
    pair = both("table-1", "right", "right")
    unpaired = [record(scene="table-2"), record(scene="table-3"), record(scene="wall")]
    headline, families = tables([*pair, *unpaired])
    assert headline.notes[0] == "The only pair judges 2 of 5 scenes; no table of pairs counts the other 3."
    assert families.notes[0] == "Scenes in pairs: table 2 of 4, wall 0 of 1."
    scenes = paired_scenes(groups_of([*pair, *unpaired]))
    names = {scene: scene.upper() for one in scenes for scene in (*one.paired, *one.alone)}
    assert paired_scenes_table(scenes, names).rows == (
        ("table", "1", "TABLE-1-STAND, TABLE-1-FALL", "TABLE-2, TABLE-3"),
        ("wall", "0", "-", "WALL"),
    )
    headline, families = tables([*pair, *both("ramp-1", "right", "right")])
    assert headline.notes[0] == "The 2 pairs judge 4 of 4 scenes."
    assert families.notes[0] == "Pairs judge all scenes of each family."
    headline, families = tables([*pair, record(scene="wall")])
    assert headline.notes[0] == "The only pair judges 2 of 3 scenes; no table of pairs counts the other."
    assert families.notes[0] == "Scenes in pairs: wall 0 of 1; of all other families all."


def test_the_csv_has_every_share_with_its_ends() -> None:
    rows = pair_rows(groups_of([*both("table-1", "right", "right"), *both("table-2", "failed", "right")]))
    lines = list(csv.DictReader(io.StringIO(pairs_csv(rows))))
    assert [line["family"] for line in lines] == [ALL, "table"]
    assert {line["judged"] for line in lines} == {"2"}
    assert (lines[0]["right"], lines[0]["failed"], lines[0]["right_low"]) == ("0.5", "0.5", "")


UNDERMINED = replace(FALLS, not_before_s=3.0)


def test_a_prebuilt_stack_that_stands_for_a_time_and_one_that_falls_at_once_are_a_pair() -> None:
    stands = side("a", "fall", "right", expectation=UNDERMINED, scene="a-8")
    falls = side("a", "fall", "false_stand", expectation=replace(FALLS, within_s=0.4), scene="a-9")
    assert values(row([stands, falls])) == [0, 1, 0, 0]


@pytest.mark.parametrize(
    ("expectations", "opposed"),
    [
        ((STANDS, FALLS), True),
        ((STANDS, UNDERMINED), True),
        ((UNDERMINED, FALLS), True),
        ((UNDERMINED, UNDERMINED, FALLS), True),
        ((STANDS, STANDS), False),
        ((FALLS, FALLS), False),
        ((UNDERMINED, UNDERMINED), False),
        ((STANDS, Expectation("study", "")), False),
    ],
)
def test_a_pair_asks_for_opposite_things(expectations, opposed) -> None:
    assert are_opposed(expectations) == opposed
