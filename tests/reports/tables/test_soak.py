"""Tables of a soak."""

import pytest

from reports.statistics.soak import creeps_at_all, time_of_a_thickness
from reports.tables.soak import duration, soak_tables
from tests.reports.studies import FALLS, failed, fallen, record

SOAK = {"watch_s": 600.0, "creep_thickness_m": 7.8e-3}


def soaked(**fields):
    return record(
        **{**SOAK, "creep_m_s": 2e-6, "creep_error_m_s": 1e-7, "sliding_m_s": 2e-6, "sinking_m_s": 0.0, **fields}
    )


def test_what_was_not_watched_for_a_minute_is_no_soak():
    assert soak_tables([soaked(watch_s=5.0), record(), soaked(expectation=FALLS)]) == []


def test_a_stack_creeps_if_the_interval_of_its_creep_excludes_zero():
    assert creeps_at_all(soaked())
    assert not creeps_at_all(soaked(creep_error_m_s=2.1e-6))
    assert not creeps_at_all(soaked(creep_m_s=0.0, creep_error_m_s=0.0))


def test_a_plank_that_creeps_by_two_micrometres_a_second_moves_by_its_thickness_in_65_minutes():
    assert time_of_a_thickness(soaked()) == pytest.approx(3900.0)
    assert time_of_a_thickness(soaked(creep_error_m_s=3e-6)) is None


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(None, "-"), (12.3, "12.3 s"), (3900.0, "1.08 h"), (2 * 86400.0, "2 days"), (4e9, ">100 years"), (0.2, "0.2 s")],
)
def test_a_duration_is_in_the_unit_that_suits_it(seconds, text):
    assert duration(seconds) == text


def test_a_row_a_set_up_and_a_row_a_stack():
    records = [
        soaked(),
        soaked(scene="tower", creep_m_s=0.0, creep_error_m_s=0.0, sliding_m_s=0.0),
        fallen(3, scene="house", collapse_s=400.0, **SOAK),
        failed("timeout", scene="wall", **SOAK),
        soaked(policy="paper", creep_m_s=1e-6, creep_error_m_s=2e-6),
    ]
    summary, stacks = soak_tables(records)
    assert summary.rows == (
        ("bullet", "game", "none", "4", "1", "1", "1", "1", "1.08 h"),
        ("bullet", "game", "paper", "1", "0", "0", "0", "1", "-"),
    )
    assert [row[4:] for row in stacks.rows] == [
        ("2", "0.1", "2", "0", "1.08 h"),
        ("1", "2", "2", "0", "never"),
        ("0", "0", "0", "0", "never"),
        ("fell", "-", "-", "-", "6.67 min"),
        ("timeout", "-", "-", "-", "-"),
    ], "scene by scene"
