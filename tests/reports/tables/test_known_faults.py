"""The table of known faults of engines."""

from reports.tables.known_faults import known_fault_tables
from tests.reports.studies import record


def test_a_row_a_fault_with_the_rows_that_show_it() -> None:
    creeping = {"engine": "mujoco", "verdict": "creeps"}
    (table,) = known_fault_tables(
        [record(**creeping, scene=f"tower-{n}") for n in range(5)] + [record(**creeping, policy="paper"), record()]
    )
    [(engine, thread, sentence, rows)] = table.rows
    assert (engine, thread) == ("mujoco", "google-deepmind/mujoco#3328")
    assert "friction never sticks" in sentence
    assert rows == "6: tower-0 game none, tower-1 game none, tower-2 game none and 3 more"
    assert "https://github.com/google-deepmind/mujoco/issues/3328" in table.notes[-1]


def test_a_study_that_shows_no_fault_has_no_table() -> None:
    assert known_fault_tables([record()]) == []
