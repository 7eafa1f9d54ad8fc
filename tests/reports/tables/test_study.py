"""The tables of hand-made records, against a page that was read and found right."""

import csv
import io
from pathlib import Path

import pytest
from rich.console import Console

from reports.records.results import write_trials_csv
from reports.records.trial import TrialRecord
from reports.statistics.groups import groups_of
from reports.tables.comparison import comparison_rows, comparison_table
from reports.tables.outcomes import ADOPTED_NOTE, outcome
from reports.tables.study import study_tables
from reports.tables.table import Table, render, to_markdown
from scenarios.model import Expectation

GOLDEN = Path(__file__).parents[1] / "golden" / "tables.md"
STANDS = Expectation("stand", "always in equilibrium")
FALLS = Expectation("fall", "n d > L first at n = 9", 9)
TIMES = {"frame_ms_p50": 1.5, "frame_ms_p99": 2.5, "engine_ms": 1.25}
CORE_TIMES = {"readback_ms": 0.1, "core_ms": 0.2, "port_ms": 0.001}


def record(**fields) -> TrialRecord:
    engine, scene, policy = (
        fields.get("engine", "bullet"),
        fields.get("scene", "four_stack"),
        fields.get("policy", "none"),
    )
    return TrialRecord(
        **{
            "trial": f"{engine}.{scene}.{policy}.{fields.get('seed', 0)}",
            "engine": engine,
            "engine_version": "1",
            "profile": "game",
            "scenario": scene,
            "scene": scene,
            "parameters": {},
            "policy": policy,
            "seed": 0,
            "repeat": 0,
            "status": "completed",
            "expectation": STANDS,
            "verdict": "right",
            "environment": "abc",
            "levels_planned": 30,
            "height_levels": 30,
            **fields,
        }
    )


FALLEN = {"status": "collapsed", "collapse_kind": "topple"}
RECORDS = [
    record(**FALLEN, verdict="false_collapse", height_levels=7, collapse_level=7, **TIMES, height_m=0.054),
    record(policy="at_rest", **TIMES, **CORE_TIMES, wakes=0, refreezes=0, longest_live_s=0.3, creep_m_s=0.0),
    record(
        policy="paper",
        **TIMES,
        **CORE_TIMES,
        height_m=0.234,
        sink_m=0.00044,
        drift_m=0.0,
        creep_m_s=0.0,
        frame_ratio=0.07,
        frame_ratio_level=25,
        wakes=3,
        refreezes=1,
        longest_live_s=1.2,
    ),
    record(engine="dart", status="timeout", verdict="undecided", height_levels=17, **TIMES),
    record(engine="dart", policy="paper", status="crashed", verdict="failed", height_levels=0),
    record(engine="pymunk", status="unsupported", verdict="none", height_levels=0),
    record(engine="mujoco", **TIMES, creep_m_s=2.5e-6),
    record(
        scene="tower",
        **FALLEN | {"collapse_kind": "sink"},
        collapse_level=5,
        verdict="false_collapse",
        expectation=FALLS,
    ),
    record(scene="tower", policy="at_rest", verdict="false_stand", expectation=FALLS),
    record(scene="tower", policy="paper", **FALLEN, collapse_level=9, expectation=FALLS),
]


def with_ratio(ratio: float, **fields) -> TrialRecord:
    return record(policy="paper", **TIMES, **CORE_TIMES, frame_ratio=ratio, frame_ratio_level=25, **fields)


def test_the_tables_are_those_that_were_read_and_found_right() -> None:
    assert to_markdown(study_tables(RECORDS)) == GOLDEN.read_text(encoding="utf-8")


def test_they_can_be_read_at_a_hundred_columns() -> None:
    page = io.StringIO()
    for table in study_tables([*RECORDS, *(with_ratio(0.07 + 0.01 * n, repeat=n) for n in range(1, 5))]):
        render(table, Console(width=100, file=page))
    lines = page.getvalue().splitlines()
    assert max(map(len, lines)) <= 100
    assert any("falls at 7 ✗" in line and "30/30 ✓" in line for line in lines)
    assert any(line.rstrip().endswith("0.090 [0.070, 0.110] at 25") for line in lines)


def test_a_table_that_is_too_wide_is_shown_in_parts_with_its_keys() -> None:
    header = ("scene", "theory", "engine", *(f"figure{number}" for number in range(8)))
    table = Table("Wide", header, (("card_house", "stands", "bullet", *["1234.5"] * 8),), ("a note",))
    page = io.StringIO()
    render(table, Console(width=60, file=page))
    lines = [line.rstrip() for line in page.getvalue().splitlines()]
    assert max(map(len, lines)) <= 60
    assert [line for line in lines if line.startswith("Wide")] == ["Wide", *["Wide, continued"] * 2]
    assert [line.split() for line in lines if "figure" in line] == [
        ["scene", "engine", "theory", "figure0", "figure1", "figure2"],
        ["scene", "engine", "figure3", "figure4", "figure5", "figure6"],
        ["scene", "engine", "figure7"],
    ]
    assert lines.count("a note") == 1
    assert sum(line.startswith("card_house  bullet") for line in lines) == 3


def test_a_terminal_shows_marks_in_colour_and_never_breaks_a_number() -> None:
    page = io.StringIO()
    long_names = tuple(
        (f"heavy_top-ratio{row}-aside0.{row}", "bullet game@offset=100", "10416.630") for row in range(3)
    )
    rows = (("right", "bullet", "30/30 ✓ 3/3"), ("wrong", "bullet", "falls at 7 ✗"), ("some", "bullet", "30/30 ~ 1/2"))
    for shown in (Table("Creep", ("scene", "engine", "creep"), long_names), Table("Outcomes", ("a", "b", "c"), rows)):
        render(shown, Console(width=45, file=page, force_terminal=True, color_system="standard"))
    text = page.getvalue()
    assert text.count("10416.630") == 3
    assert "Creep, continued" not in text, "one column beside its keys cannot be parted"
    assert all(part in text for part in ("\x1b[32m30/30 ✓ 3/3", "\x1b[31mfalls at 7 ✗", "\x1b[33m30/30 ~ 1/2"))


@pytest.mark.parametrize(
    ("levels", "cell"),
    [
        ((30, 30, 30), "30/30 ✓ 3/3"),
        ((8, 30, 12), "12 (8-30)/30 ✓ 3/3"),
    ],
)
def test_several_seeds_are_reported_by_median_and_range(levels, cell) -> None:
    assert outcome([record(seed=seed, height_levels=height) for seed, height in enumerate(levels)]) == cell


@pytest.mark.parametrize(("right", "cell"), [(0, "30/30 ✗ 0/2"), (1, "30/30 ~ 1/2"), (2, "30/30 ✓ 2/2")])
def test_a_mark_shows_whether_all_seeds_were_right_or_some_or_none(right, cell) -> None:
    verdicts = ["right"] * right + ["false_stand"] * (2 - right)
    assert outcome([record(seed=seed, verdict=verdict) for seed, verdict in enumerate(verdicts)]) == cell


def test_a_censored_trial_marks_its_cell_as_a_lower_bound() -> None:
    cut = record(seed=1, status="timeout", verdict="undecided", height_levels=17)
    assert outcome([cut]) == "≥17/30", "too slow to decide, which theory does not contradict"
    assert outcome([record(), cut]) == "≥23.5 (17-30)/30 ✓ 1/1"


def test_seeds_that_have_their_own_truth_are_counted_among_the_judged_only() -> None:
    studied = record(seed=1, verdict="none", height_levels=20)
    assert outcome([record(), studied]) == "25 (20-30)/30 ✓ 1/1"


def test_five_pairs_of_times_give_a_ratio_and_four_give_none() -> None:
    pairs = [with_ratio(0.01 * (5 + repeat), repeat=repeat) for repeat in range(5)]
    several, single = study_tables([*pairs, *(with_ratio(0.07, engine="dart", seed=seed) for seed in range(4))])[2].rows
    assert several[-1] == "0.070 [0.050, 0.090] at 25"
    assert single[-1] == "-"


def test_ratios_of_several_levels_name_them() -> None:
    pairs = [with_ratio(0.07, repeat=repeat) for repeat in range(4)]
    lower = record(policy="paper", repeat=4, **TIMES, frame_ratio=0.07, frame_ratio_level=20)
    assert study_tables([*pairs, lower])[2].rows[0][-1] == "0.070 at 20-25"


def test_times_of_several_machines_stand_in_rows_of_their_own() -> None:
    times = {"frame_ms_p50": 1.0, "engine_ms": 1.0}
    timings = study_tables([record(host="a", **times), record(host="b", seed=1, **times | {"frame_ms_p50": 3.0})])[2]
    assert [(row[3], row[4]) for row in timings.rows] == [("a", "1.000"), ("b", "3.000")]
    assert timings.header[3] == "machine"


def test_no_records_make_empty_tables() -> None:
    assert "Outcomes" in to_markdown(study_tables([]))


def test_the_csv_has_every_field_of_every_trial(tmp_path) -> None:
    write_trials_csv(tmp_path / "trials.csv", RECORDS)
    with (tmp_path / "trials.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == len(RECORDS)
    assert rows[0]["height_levels"] == "7"
    assert rows[0]["frame_ratio"] == ""
    expectation = RECORDS[0].model_dump()["expectation"]
    assert {name: rows[0][f"expectation_{name}"] for name in expectation} == {
        name: "" if value is None else str(value) for name, value in expectation.items()
    }


def test_a_stack_that_was_frozen_before_the_first_step_is_marked_and_explained() -> None:
    adopted, live = record(policy="paper", adopted=30), record(policy="paper", adopted=0, seed=1)
    assert outcome([adopted]) == "30/30† ✓"
    assert outcome([live]) == "30/30 ✓"
    assert outcome([adopted, live]) == "30/30† ✓ 2/2"
    assert ADOPTED_NOTE in study_tables([record(), adopted])[0].notes
    assert ADOPTED_NOTE not in study_tables([record(), live])[0].notes


def test_the_comparison_notes_it_of_the_row() -> None:
    alone, adopted = comparison_rows(groups_of([record(), record(policy="paper", adopted=30)]))
    assert (alone.note, adopted.note) == ("", ADOPTED_NOTE)
    assert adopted.entries[1].text == "30/30†"
    assert comparison_table([alone, adopted], "").notes[-1] == ADOPTED_NOTE
    assert ADOPTED_NOTE not in comparison_table([alone], "").notes
