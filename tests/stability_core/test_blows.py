"""Blows and pushes: what they move is woken, before it is struck; what they do not move stays where it is."""

from __future__ import annotations

import math

import pytest

from stability_core import StabilityExtension
from tests.stability_core.test_extension import DEEP, DT, FALL, SETTINGS, column, run, settle

STRIKER = 9
MU, G = 0.45, 9.81


def frozen_column(port, levels: int = 4) -> StabilityExtension:
    """Planks of 1 kg on each other, all frozen."""
    column(port, levels)
    extension = StabilityExtension(port, "equilibrium")
    settle(extension)
    assert port.frozen == set(range(levels))
    return extension


def approach(port, target: int, speed: float, gap: float, mass: float = 1.0, **more: object) -> None:
    """A cube of ``mass`` beside a plank, flying at it along x."""
    z = 0.01 * target + 0.005
    port.add(STRIKER, (-0.1 - gap, 0.0, z), mass)
    points = [(-0.05, y, z) for y in DEEP]
    port.touch(target, STRIKER, points, normal=(1.0, 0.0, 0.0), separation=gap, velocity=(-speed, 0.0, 0.0), **more)


def test_what_is_about_to_be_struck_wakes_in_the_frame_before(port):
    """At 2 m/s a gap of 30 mm closes within 1/60 s: the engine's next step plays the impact."""
    extension = frozen_column(port)
    approach(port, 1, 2.0, 0.030)
    change = extension.update(DT)
    assert {1, 2, 3} <= set(change.woken), "the struck one and all above it"
    assert change.reasons[1] == "struck"


def test_what_will_not_be_reached_within_a_frame_sleeps_on(port):
    extension = frozen_column(port)
    approach(port, 1, 2.0, 0.060)
    assert extension.update(DT).woken == ()


def test_what_flies_away_wakes_nothing(port):
    extension = frozen_column(port)
    approach(port, 1, -2.0, 0.010)
    assert extension.update(DT).woken == ()


@pytest.mark.parametrize(("share", "woken"), [(0.9, False), (1.1, True)])
@pytest.mark.parametrize("mass", [0.1, 1.0, 10.0])
def test_a_slow_blow_wakes_what_would_slide_by_more_than_the_limit(port, mass, share, woken):
    """After a plastic impact the plank has v M / (M + m) and slides by its square over 2 mu g."""
    extension = frozen_column(port)
    slide = SETTINGS.slide * math.hypot(0.05, 0.01, 0.005)
    speed = math.sqrt(2 * MU * G * slide * share) * (mass + 1.0) / mass
    approach(port, 1, speed, 0.0, mass)
    assert bool(extension.update(DT).woken) == (woken or speed > SETTINGS.impact_speed * FALL)


def test_many_small_blows_add_up(port):
    """Each would let the plank slide by a tenth of what wakes it."""
    extension = frozen_column(port)
    slide = SETTINGS.slide * math.hypot(0.05, 0.01, 0.005)
    approach(port, 1, 2.0 * math.sqrt(2 * MU * G * slide / 9.9), 0.0)
    woken = [bool(change.woken) for change in run(extension, 12)]
    assert woken.index(True) == 9


def test_a_blow_that_flings_a_plank_away_wakes_its_neighbours_below_too(port):
    """They are dragged along within the same engine step."""
    extension = frozen_column(port, 8)
    approach(port, 5, 8.0, 0.02)
    assert set(extension.update(DT).woken) == {2, 3, 4, 5, 6, 7}


@pytest.mark.parametrize(("share", "woken"), [(0.0, False), (0.9, False), (1.1, True), (10.0, True)])
def test_a_steady_push_wakes_what_friction_does_not_hold(port, share, woken):
    """The joint below the pushed plank bears mu times the weight of three planks, to 2 % of hysteresis."""
    extension = frozen_column(port)
    push = share * MU * G * 3.0
    approach(port, 1, 0.0, 0.0, force=(push / 2, 0.0, 0.0))
    extension.update(DT)
    extension.disturb([STRIKER])
    changes = run(extension, 60)
    assert any(change.woken for change in changes) == woken
    if woken:
        assert all(set(change.woken) <= {1, 2, 3} for change in changes), "the joint above holds as much"


def test_a_bump_is_no_push(port):
    """A body that arrives presses for a frame or two with many times the force that it exerts afterwards."""
    extension = frozen_column(port)
    limit = MU * G * 3.0
    approach(port, 1, 0.0, 0.0, force=(2.0 * limit, 0.0, 0.0))
    assert not any(change.woken for change in run(extension, 2))
    port.touches[-1].force = (0.2 * limit, 0.0, 0.0)
    assert not any(change.woken for change in run(extension, 60))


def test_a_push_that_the_engine_does_not_report_is_not_felt(port):
    extension = frozen_column(port)
    approach(port, 1, 0.0, 0.0)
    extension.update(DT)
    extension.disturb([STRIKER])
    assert not any(change.woken for change in run(extension, 60))


def test_a_push_that_has_ceased_is_forgotten(port):
    extension = frozen_column(port)
    approach(port, 1, 0.0, 0.0, force=(0.4 * MU * G * 3.0, 0.0, 0.0))
    extension.update(DT)
    extension.disturb([STRIKER])
    assert not any(change.woken for change in run(extension, 60))
    port.remove(STRIKER)
    run(extension, 60)
    approach(port, 1, 0.0, 0.0, force=(0.6 * MU * G * 3.0, 0.0, 0.0))
    assert any(change.woken for change in run(extension, 60))


def test_a_striker_that_trembles_against_a_plank_is_left_to_its_force(port):
    """It has touched the plank before, and the engine reports its force, which ``pushes`` judges."""
    extension = frozen_column(port)
    slide = SETTINGS.slide * math.hypot(0.05, 0.01, 0.005)
    approach(port, 1, 0.0, 0.0, force=(0.0, 0.0, 0.0))
    run(extension, 12)
    port.touches[-1].velocity = (-2.0 * math.sqrt(2 * MU * G * slide / 9.9), 0.0, 0.0)
    assert not any(change.woken for change in run(extension, 60))


def test_a_blow_beyond_trembling_counts_although_the_striker_has_touched_before(port):
    extension = frozen_column(port)
    approach(port, 1, 0.0, 0.0, force=(0.0, 0.0, 0.0))
    run(extension, 12)
    port.touches[-1].velocity = (-0.9 * SETTINGS.impact_speed * FALL, 0.0, 0.0)
    assert 1 in extension.update(DT).woken
