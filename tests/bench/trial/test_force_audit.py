"""The force audit of a trial: a stack that stands is carried, and a planted lie is seen."""

from dataclasses import replace

import pytest

from adapters._bullet import BulletSimulation
from bench.studies.plan import Trial
from bench.studies.schema import Limits
from bench.trial import run_trial as trials
from reports.records.trial import TrialRecord
from reports.tables.forces import force_tables
from scenarios.registry import build
from stability_core.port import Contacts


class CarriesTooLittle(BulletSimulation):
    """A mutant: reports 95 % of each force."""

    def _contacts(self) -> Contacts:
        contacts = super()._contacts()
        return replace(contacts, force=None if contacts.force is None else 0.95 * contacts.force)


def audited(*, forces: bool = True) -> TrialRecord:
    parameters = {"theta": 20.0, "friction": 0.45}
    trial = Trial("bullet", "tuned", "slope", build("slope", **parameters).variant, parameters, "none", 0, 0)
    limits = Limits(trial_wall_s=600, forces=forces, ratio=False)
    return trials.run_trial(trial, limits, "abc", lambda _: None).record


def test_a_block_on_a_slope_is_carried_and_five_percent_less_are_seen(monkeypatch) -> None:
    honest = audited()
    assert honest.carried_share == pytest.approx(1.0, abs=1e-3)
    assert honest.cone_excess is not None
    assert honest.cone_excess < 0.02
    assert honest.complementarity is not None
    assert honest.complementarity < 0.02

    def opened(*_, world, sleeping, expected):
        return CarriesTooLittle(CarriesTooLittle.profiles["tuned"], world, sleeping, expected)

    monkeypatch.setattr(trials, "open_engine", opened)
    liar = audited()
    assert liar.carried_share == pytest.approx(0.95, abs=1e-3)
    (table,) = force_tables([honest, liar])
    assert [row[:4] for row in table.rows] == [("slope-friction0.45", "bullet", "tuned", "none")]


def test_forces_are_read_only_where_a_study_asks() -> None:
    record = audited(forces=False)
    assert (record.carried_share, record.cone_excess, record.complementarity) == (None, None, None)
    assert force_tables([record]) == []
