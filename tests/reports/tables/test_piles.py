"""The table of poured piles."""

from reports.tables.piles import pile_tables
from reports.tables.study import study_tables
from scenarios.model import Expectation
from tests.reports.studies import record

STUDY = Expectation("study", "dynamics decide")


def pile(**fields):
    measured = {"rest_s": 1.5, "height_m": 0.1, "repose_deg": 30.0, "sink_m": 1e-5, "creep_m_s": 1e-6}
    return record(**{"scene": "poured_pile", "expectation": STUDY, "verdict": "none", **measured, **fields})


def test_stacks_have_no_such_table():
    assert pile_tables([record()]) == []


def test_a_row_shows_rest_height_slope_and_who_is_awake():
    (table,) = pile_tables([pile(policy="pile", live_mean=12.5, live_last=3)])
    entries = dict(zip(table.header, table.rows[0], strict=True))
    wanted = {"policy": "pile", "rest s": "1.5", "height": "100.0", "repose": "30.0", "awake": "12.5", "last": "3"}
    assert {name: entries[name] for name in wanted} == wanted
    assert (entries["sink"], entries["creep"]) == ("0.010", "1.000")


def test_what_never_rests_and_what_was_cut_off_is_marked():
    (table,) = pile_tables([pile(rest_s=None, status="timeout", height_levels=7)])
    entries = dict(zip(table.header, table.rows[0], strict=True))
    assert (entries["rest s"], entries["bricks"], entries["awake"]) == ("moves", "≥7", "-")


def test_nothing_is_right_or_wrong_where_theory_knows_no_answer():
    assert "Correctness" not in [table.title for table in study_tables([pile()])]
    assert "Correctness" in [table.title for table in study_tables([pile(), record()])]
