"""The table of costs: times, memory, solver iterations and instructions side by side."""

from reports.tables.cost import cost_tables
from tests.reports.studies import failed, record

COSTS = {"engine_ms": 0.5, "core_ms": 0.1, "memory_mib": 30.0, "solver_iterations": 50.0, "core_instructions": 1.5e5}


def cells(records, environment=None) -> list[tuple[str, ...]]:
    [table] = cost_tables(records, environment or {})
    assert table.header[4:] == ("p50 ms", "step ms", "core ms", "core kinstr", "iterations", "memory MiB")
    return [*table.rows]


def test_a_row_has_the_medians_of_a_policy() -> None:
    trials = [record(policy="paper", seed=seed, **COSTS | {"memory_mib": 30.0 + seed}) for seed in range(3)]
    assert cells(trials) == [("bullet", "game", "paper", "3", "1.100", "0.500", "0.100", "150", "50.0", "31.0")]


def test_what_an_engine_does_not_report_is_a_dash() -> None:
    rows = cells([record(engine="dart", engine_ms=0.5, memory_mib=11.0), failed("crashed", engine="dart", seed=1)])
    assert rows[0][3:] == ("1", "1.000", "0.500", "-", "-", "-", "11.0"), "a crashed trial has no cost"


def test_times_of_several_machines_have_no_median() -> None:
    rows = cells([record(seed=seed, host=host, **COSTS) for seed, host in enumerate("ab")])
    assert rows[0][4:] == ("-", "-", "-", "150", "50.0", "30.0")


def test_a_study_with_nothing_but_times_has_no_table() -> None:
    assert cost_tables([record()], {}) == []


def test_the_reason_for_missing_instructions_is_a_note() -> None:
    sessions = [{}, {"instructions": "counted"}, {"instructions": "not allowed here"}]
    [table] = cost_tables([record(**COSTS)], {"sessions": sessions})
    assert table.notes[1:] == ("Instructions: not allowed here.",)
    [table] = cost_tables([record(**COSTS)], {"sessions": sessions[:2]})
    assert len(table.notes) == 1
