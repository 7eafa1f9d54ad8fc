"""The table of what separates engines."""

from types import SimpleNamespace

from reports.tables.separation import STUDIES, separation_table
from tests.reports.studies import FALLS, fallen, record

SOAKED = {"watch_s": 600.0, "creep_thickness_m": 7.8e-3, "creep_m_s": 2e-6, "creep_error_m_s": 1e-7}


def folder(*records, study=None):
    return SimpleNamespace(records=list(records), study=study or {})


def test_a_row_a_method_with_a_figure_from_each_study():
    """The row of the engine alone shows what its own sleeping rule does; other profiles do not count."""
    studies = {
        "thresholds": folder(),
        "tilt": folder(),
        "soak": folder(
            record(**SOAKED), record(scene="wall", **{**SOAKED, "creep_m_s": 4e-6}), fallen(3, watch_s=600.0)
        ),
        "heavy": folder(record(), fallen(3), record(policy="equilibrium"), record(profile="tuned")),
        "issues": folder(record(expectation=FALLS, verdict="false_stand"), record(policy="equilibrium")),
        "sleep": folder(
            record(policy="native", asleep_s=5.0),
            record(policy="equilibrium", asleep_s=0.0),
            record(policy="none", asleep_s=0.2),
        ),
    }
    assert set(studies) == set(STUDIES)
    table = separation_table(studies)
    assert table.rows == (
        ("bullet", "none", "-", "-", "-", "3 (1 of 3 lost)", "1/2", "0/1", "5.00"),
        ("bullet", "equilibrium", "-", "-", "-", "-", "1/1", "1/1", "0.00"),
    )
