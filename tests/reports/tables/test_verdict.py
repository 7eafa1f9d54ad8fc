"""The verdict in one sentence, and the reason for each place."""

import pytest

from reports.statistics.groups import groups_of
from reports.statistics.ranking import rank
from reports.tables.policies import POLICY_SENTENCES
from reports.tables.table import first_rows, with_short_notes
from reports.tables.verdict import milliseconds, ranking_table, reasons, sentence
from scenarios.model import Expectation
from tests.reports.studies import FALLS, fallen, record


def said(*trials, unfinished: int = 0) -> str:
    return sentence(rank(groups_of(trials)), unfinished)


def tower(**fields):
    """A scene that must fall, and did."""
    return fallen(9, **{"scene": "leaning_tower", "expectation": FALLS, "verdict": "right", **fields})


def test_the_cheapest_set_up_that_is_right_in_all_is_named_with_its_cost_and_creep() -> None:
    creep = {"creep_m_s": 6e-7, "creep_limit_m_s": 1.3e-6}
    trials = [
        record(frame_ms_p50=2.0),
        tower(frame_ms_p50=2.0),
        record(engine="rapier", policy="paper", frame_ms_p50=0.4, **creep),
        tower(engine="rapier", policy="paper", frame_ms_p50=0.4),
    ]
    assert said(*trials) == (
        "Cheapest set-up that is right in both scenes: rapier game with paper, 0.40 ms a frame, creeps 0.6 µm/s."
    )
    assert said(*trials, unfinished=1).endswith("(1 planned trial has no record yet).")
    assert said(*trials, unfinished=3).endswith("0.6 µm/s (3 planned trials have no record yet).")


def test_pairs_and_other_scenes_are_counted_apart_and_builds_of_several_seeds_named() -> None:
    sides = [record(scene="t-2", pair="t", seed=seed) for seed in range(2)]
    sides += [tower(scene="t-3", pair="t", seed=seed) for seed in range(2)]
    assert "right in the only pair (2 builds): bullet game alone" in said(*sides)
    walls = [record(scene=f"wall-{number}", seed=seed) for number in range(2) for seed in range(2)]
    assert "right in both scenes (4 builds), though every scene must stand: bullet" in said(*walls)
    assert "right in the only pair and both other scenes (6 builds):" in said(*sides, *walls)
    more = [side(scene=f"{name}-{side.__name__}", pair=name) for name in "abc" for side in (record, tower)]
    singles = [record(scene=f"wall-{number}") for number in range(3)]
    assert "right in all 3 pairs and 3 other scenes: bullet" in said(*more, *singles)


def test_a_reference_engine_stands_below_the_places_and_never_wins() -> None:
    ours = [record(engine="staggered", frame_ms_p50=0.1), tower(engine="staggered")]
    trials = [record(verdict="creeps"), tower(), *ours]
    ranking = rank(groups_of(trials), {"staggered"})
    table = ranking_table(ranking, trials)
    assert [row[:2] + row[4:5] for row in table.rows] == [("1", "bullet", "1/2"), ("ref.", "staggered", "2/2")]
    assert table.rows[1][-1] == "right in all"
    assert "a reference engine, written after a published method" in table.notes[1]
    assert sentence(ranking).startswith("No set-up is right in both scenes; the nearest is bullet game alone")
    alone = rank(groups_of(ours), {"staggered"})
    assert sentence(alone) == "Reference engines only, which have no place in a ranking of products."
    assert not alone.all_right


def test_it_says_when_no_set_up_is_right_in_all_and_which_is_nearest() -> None:
    trials = [record(verdict="creeps"), tower(), fallen(3, engine="dart"), tower(engine="dart", verdict="failed")]
    assert said(*trials) == (
        "No set-up is right in both scenes; the nearest is bullet game alone: 1 right, 1 creeping, 1.0 ms a frame, "
        "creep not measured."
    )


def test_a_study_of_one_outcome_is_called_so_and_one_without_an_answer_too() -> None:
    assert "right in the only scene, which must stand: bullet game alone" in said(record())
    unknown = record(expectation=Expectation("study", "nobody knows"), verdict="none")
    assert said(unknown) == "No scene of this study is judged right or wrong; its tables hold the results."
    assert not ranking_table(rank(groups_of([unknown])), [unknown]).rows


def test_the_ranking_has_the_slowest_scene_and_the_creep_with_its_limit() -> None:
    """The median over scenes of p99 is 3 ms, and no frame of 20 ms is within it."""
    scenes = [
        record(scene=scene, frame_ms_p50=1.0, frame_ms_p99=p99) for scene, p99 in {"a": 2, "b": 3, "c": 20}.items()
    ]
    creep = {"creep_m_s": 6e-7, "creep_limit_m_s": 1.28e-6}
    crept = [record(engine="dart", scene="a", **creep), record(engine="dart", scene="b", frame_ms_p99=5.0)]
    doubtful = record(engine="rapier", scene="a", creep_m_s=2e-6, creep_limit_m_s=1.28e-6)
    certain = record(engine="physx", scene="a", creep_m_s=3e-6, creep_limit_m_s=1.28e-6, verdict="creeps")
    trials = [*scenes, *crept, doubtful, certain]
    table = ranking_table(rank(groups_of(trials)), trials)
    costs = {row[1]: row[5:8] for row in table.rows}
    assert table.header[5:8] == ("p50 [ms], median scene", "p99 [ms], slowest scene", "creep [µm/s] of limit")
    assert costs["bullet"] == ("1.0", "20", "-")
    assert costs["dart"] == ("1.0", "5.0", "0.60 of 1.28")
    assert costs["rapier"] == ("1.0", "2.0", "2.00 of 1.28 ?"), "above the limit, but it counts as still"
    assert costs["physx"][2] == "3.00 of 1.28"
    shaking, drifting = (
        rank(groups_of([doubtful.model_copy(update={"creep_error_m_s": error})])) for error in (3e-6, 1e-6)
    )
    assert ranking_table(shaking, []).rows[0][7] == "2.00 [0.00, 5.00] of 1.28 trembles", (
        "its interval has no direction"
    )
    assert ranking_table(drifting, []).rows[0][7] == "2.00 [1.00, 3.00] of 1.28 ?"
    assert said(doubtful).endswith("creeps 2.0 µm/s (not certainly more than its limit of 1.3).")


def test_times_of_several_machines_name_no_cheapest() -> None:
    hosts = [record(seed=seed, host=host) for seed, host in enumerate(("a", "b"))]
    assert said(*hosts).endswith("bullet game alone; no comparable frame times.")


def test_every_place_has_its_reason() -> None:
    times = {"bullet": 1.0, "dart": 3.0, "mujoco": None}
    trials = [record(engine=engine, frame_ms_p50=time) for engine, time in times.items()]
    trials += [fallen(2, engine="pymunk")]
    ranking = rank(groups_of(trials))
    assert reasons(ranking) == [
        "right in all; cheapest of 3 with these counts",
        "right in all; 3.0 times the p50 of place 1",
        "right in all; no comparable frame time",
        "1 false collapse",
    ]
    table = ranking_table(ranking, trials)
    assert [row[0] for row in table.rows] == ["1", "2", "3", "4"]
    assert first_rows(table, 2).rows == table.rows[:2]
    assert first_rows(table, 2).notes[0] == "2 more rows: report/tables/ranking.csv."
    (short, *_) = with_short_notes(table, 90).notes
    assert len(short) <= 90
    assert short.startswith("Order: most right of 1 with a known answer")
    assert short.endswith("... (the rest: report/tables.md)")
    assert with_short_notes(table, 1000) == table


def test_an_unsteady_machine_is_named_under_the_ranking() -> None:
    trials = [record(seed=seed, calibration_ms=time) for seed, time in enumerate((0.1, 0.2))]
    notes = ranking_table(rank(groups_of(trials)), trials).notes
    assert "varied by a factor of 1.9 between trials" in notes[-1]


@pytest.mark.parametrize(
    ("time_ms", "text"), [(None, "-"), (0.0, "0.000"), (0.0224, "0.022"), (0.1, "0.10"), (1.04, "1.0"), (66.7, "67")]
)
def test_times_have_two_significant_digits(time_ms, text) -> None:
    assert milliseconds(time_ms) == text


def test_every_policy_is_one_sentence() -> None:
    assert all(text.count(".") == 1 and text.endswith(".") for text in POLICY_SENTENCES.values())
