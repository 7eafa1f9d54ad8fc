"""The onset on tilting ground: when something has moved, at which slope; and an error of the slope that is found."""

import math

import pytest

from adapters._bullet import BulletSimulation
from bench.studies.plan import Trial
from bench.studies.schema import Limits
from bench.trial import run_trial as trials
from bench.trial.gravity import TurningGravity
from bench.trial.onset_monitor import slope_deg
from bench.trial.playback import Playback
from reports.tables.tilt import NEAR_DEG, onsets_of, slope_at, tilt_tables
from scenarios.model import Expectation, Place, Scene, Tilt, Vector, World
from scenarios.planks import THICKNESS, lay
from scenarios.registry import build

FIRST, SECOND = Tilt(0.5, (0.0, 1.0), 10.0, 1.0), Tilt(1.5, (0.0, 1.0), 1.0, 2.0)
SCENE = Scene(
    "test",
    "test",
    {},
    World(),
    (Place(0.0, (lay(0.0, level=1), lay(0.0, level=2)), 0.0), FIRST, SECOND),
    Expectation("study", ""),
    "",
    watch_s=0.5,
)


def onset(simulation) -> float | None:
    run = Playback(SCENE, simulation, None, math.inf, lambda _: None)
    run.run()
    assert run.onset is not None
    return run.onset.onset_deg


@pytest.mark.parametrize(("share", "is_onset"), [(0.009, False), (0.011, True)])
def test_a_hundredth_of_a_thickness_is_an_onset(fake_engine, share: float, is_onset: bool) -> None:
    def move(simulation, step: int) -> None:
        if step == 120:  # at 2 s: after ten degrees fast, and half a degree slowly
            simulation.move(1, (share * THICKNESS, 0.0, 1.5 * THICKNESS), (1.0, 0.0, 0.0, 0.0))

    found = onset(fake_engine(move))
    assert found == (pytest.approx(10.5, abs=0.02) if is_onset else None)


@pytest.mark.parametrize(("degrees", "is_onset"), [(0.49, False), (0.51, True)])
def test_half_a_degree_is_an_onset_about_any_axis(fake_engine, degrees: float, is_onset: bool) -> None:
    half = math.radians(degrees) / 2

    def turn(simulation, step: int) -> None:
        if step == 120:
            simulation.move(0, (0.0, 0.0, THICKNESS / 2), (-math.cos(half), 0.0, 0.0, -math.sin(half)))

    assert (onset(fake_engine(turn)) is not None) == is_onset


def test_what_moved_before_the_tilt_counts_from_where_it_rests(fake_engine) -> None:
    def settle(simulation, step: int) -> None:
        if step == 20:
            simulation.move(1, (0.0, 0.0, 1.45 * THICKNESS), (1.0, 0.0, 0.0, 0.0))

    assert onset(fake_engine(settle)) is None


def test_a_tilt_goes_on_where_the_one_before_ended(fake_engine) -> None:
    simulation = fake_engine()
    turning = TurningGravity(simulation, lambda _: None)
    for time, tilt in ((0.5, FIRST), (1.5, SECOND)):
        turning.begin(tilt)
        turning.turn_on(time)
    assert slope_deg(simulation.world.gravity) == pytest.approx(10.0)
    turning.turn_on(3.5)
    assert slope_deg(simulation.world.gravity) == pytest.approx(12.0) == pytest.approx(slope_at(SCENE, 3.5))


class HalfADegreeOff(BulletSimulation):
    """A mutant: gravity points half a degree off about the axis of the tilt."""

    def _set_gravity(self, gravity: Vector) -> None:
        x, y, z = gravity
        error = math.radians(0.5)
        super()._set_gravity((x, y * math.cos(error) - z * math.sin(error), y * math.sin(error) + z * math.cos(error)))


@pytest.mark.parametrize("mutant", [pytest.param(None, marks=pytest.mark.slow), HalfADegreeOff])
def test_half_a_degree_of_slope_is_found(monkeypatch, mutant: type[BulletSimulation] | None) -> None:
    """Bullet lets a V tip within 0.05 deg of the exact angle."""
    if mutant is not None:

        def opened(*_, world, sleeping, expected):
            return mutant(mutant.profiles["tuned"], world, sleeping, expected)

        monkeypatch.setattr(trials, "open_engine", opened)
    parameters = {"stack": "v", "heading": "across"}
    trial = Trial("bullet", "tuned", "tilt_test", build("tilt_test", **parameters).variant, parameters, "none", 0, 0)
    record = trials.run_trial(trial, Limits(trial_wall_s=600), "abc", lambda _: None).record
    (found,) = onsets_of([record])
    assert found.off_deg is not None
    assert found.is_near == (mutant is None)
    assert abs(abs(found.off_deg) - (0.0 if mutant is None else 0.5)) < 0.1 < NEAR_DEG
    assert found.own_deg == pytest.approx(found.exact_deg, abs=0.05)
    (table,) = tilt_tables([record])
    assert ("✓" in table.rows[0][-1]) == (mutant is None)
    assert table.rows[0][7] == "face", "Bullet reports a plank's face at a ridge"
