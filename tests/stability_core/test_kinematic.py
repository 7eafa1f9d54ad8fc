"""Bodies of infinite mass, which the host moves: ground while they keep their place."""

from __future__ import annotations

import math

import numpy as np
import pytest

from stability_core import StabilityExtension, solve_equilibrium
from tests.stability_core.dwell import CALM_FRAMES, REST_FRAMES
from tests.stability_core.test_extension import DEEP, DT, FALL, SETTINGS, SIZE, WIDE, run, settle

LIFT = 50
STILL_FRAMES = round(SETTINGS.still_s / DT)
POLICIES = ["paper", "at_rest", "equilibrium"]


def lift_with_column(port, n: int = 2) -> None:
    """A lift of 4 x 4 m whose floor is at 0, with a column of planks near its edge."""
    port.add(LIFT, (-1.9, 0.0, -0.1), mass=math.inf)
    for body in range(n):
        z = body * 0.01
        port.add(body, (0.0, 0.0, z + 0.005))
        port.lay(body, body - 1 if body else LIFT, WIDE, DEEP, z)


def move(port, bodies, shift) -> None:
    """Move bodies with their contacts."""
    for body in bodies:
        port.center[body] = tuple(np.add(port.center[body], shift))
    for touch in port.touches:
        if touch.upper in bodies:
            touch.points = [tuple(np.add(point, shift)) for point in touch.points]


def list_contacts_with_frozen(port) -> None:
    """Let the port list contacts of kinematic bodies with frozen ones, as an adapter does of those that move."""
    listed_by_engine = port.contacts

    def contacts():
        frozen, port.frozen = port.frozen, set()
        listed = listed_by_engine()
        port.frozen = frozen
        return listed

    port.contacts = contacts


@pytest.mark.parametrize("policy", POLICIES)
def test_a_column_freezes_on_a_lift_that_keeps_its_place(port, policy):
    lift_with_column(port)
    extension = StabilityExtension(port, policy)
    changes = run(extension, 2 * REST_FRAMES + 2)
    assert [body for change in changes for body in change.frozen] == [0, 1], "as on the ground"
    run(extension, 200)
    assert port.frozen == {0, 1}, "the lift never freezes"
    assert extension.why(LIFT) == "moved by the host: the body keeps its place, and counts as ground"


def test_a_pile_may_lie_on_a_lift(port):
    lift_with_column(port, 1)
    run(StabilityExtension(port, "pile"), REST_FRAMES + 1)
    assert port.frozen == {0}


def test_a_column_on_a_lift_is_adopted(port):
    lift_with_column(port)
    assert StabilityExtension(port, "equilibrium").adopt().frozen == (0, 1)


@pytest.mark.parametrize("policy", POLICIES)
def test_what_rests_on_a_lift_wakes_when_it_moves_and_freezes_when_it_stands_still(port, policy):
    lift_with_column(port)
    port.add(9, (9.0, 0.0, 0.005))
    port.lay(9, -1, (8.95, 9.05), DEEP, 0.0)
    extension = StabilityExtension(port, policy)
    settle(extension)
    move(port, [LIFT], (0.0, 0.0, 2e-3))
    change = extension.update(DT)
    assert change.woken == (0, 1)
    assert change.reasons == {0: "moved by the host", 1: "rested on what was moved by the host"}
    assert extension.why(LIFT).startswith("moved by the host: no body freezes on this body until it has kept its place")
    for _ in range(100):  # slower than any limit of rest, for bodies and lift alike
        move(port, [LIFT, 0, 1], (0.0, 0.0, 0.5 * SETTINGS.rest_speed * FALL * DT))
        assert not extension.update(DT).frozen
    changes = run(extension, STILL_FRAMES + 2 * (CALM_FRAMES + REST_FRAMES))
    assert port.frozen == {0, 1, 9}
    assert not any(change.woken for change in changes)


def test_slow_movement_adds_up(port):
    """A twentieth of the tolerance in each frame; the size of the plank counts, not that of the lift."""
    lift_with_column(port)
    extension = StabilityExtension(port)
    settle(extension)
    step = 0.05 * SETTINGS.steady_shift * SIZE
    frames = 0
    while port.frozen:
        move(port, [LIFT], (step, 0.0, 0.0))
        extension.update(DT)
        frames += 1
    assert 20 <= frames <= 22


@pytest.mark.parametrize("policy", POLICIES)
def test_a_belt_shows_its_movement_at_the_contacts(port, policy):
    """Its centre keeps its place; the engine lists its contacts with frozen bodies, as both are moved by nothing."""
    lift_with_column(port, 1)
    extension = StabilityExtension(port, policy)
    settle(extension)
    list_contacts_with_frozen(port)
    assert not any(change.woken for change in run(extension, 20))
    port.touches[0].velocity = (-0.02, 0.0, 0.0)
    assert extension.update(DT).woken == (0,)
    run(extension, 100)
    assert not port.frozen


def test_a_platform_that_turns_about_its_centre_wakes_what_rests_on_it(port):
    """Its surface goes a twentieth of the tolerance in each frame; the engine lists its contacts with frozen bodies."""
    lift_with_column(port)
    extension = StabilityExtension(port)
    settle(extension)
    list_contacts_with_frozen(port)
    run(extension, 30)
    assert port.frozen == {0, 1}
    port.touches[0].velocity = (0.0, 0.0, 0.05 * SETTINGS.steady_shift * SIZE / DT)
    frames = 0
    while port.frozen:
        extension.update(DT)
        frames += 1
    assert 19 <= frames <= 22


@pytest.mark.parametrize("policy", POLICIES)
def test_nothing_freezes_on_a_platform_that_turns_however_still_its_centre_is(port, policy):
    """0.1 rad/s about the centre of the plank on it: nothing slides and no centre moves."""
    lift_with_column(port, 1)
    extension = StabilityExtension(port, policy)
    for frame in range(60):
        angle = 0.1 * frame * DT
        port.touches[0].normal = (math.sin(angle), 0.0, math.cos(angle))
        assert not extension.update(DT).frozen
    run(extension, 2 * REST_FRAMES)
    assert port.frozen == {0}, "it has stopped, tilted by 6 deg"


def test_a_belt_that_shows_nothing_is_named_by_the_host(port):
    lift_with_column(port)
    extension = StabilityExtension(port)
    settle(extension)
    assert extension.wake([LIFT]).woken == (0, 1)


@pytest.mark.parametrize("policy", POLICIES)
def test_a_lift_that_is_let_go_is_a_body_like_others(port, policy):
    lift_with_column(port)
    port.add(LIFT, (0.0, 0.0, -0.1), mass=math.inf)
    port.lay(LIFT, -1, (-2.0, 2.0), (-2.0, 2.0), -0.2)
    extension = StabilityExtension(port, policy)
    settle(extension)
    port.mass[LIFT] = 5.0
    assert extension.update(DT).woken == (0, 1)
    run(extension, 100)
    assert port.frozen == {0, 1, LIFT}
    port.mass[LIFT], port.show_frozen = math.inf, True
    assert extension.update(DT).woken == (0, 1, LIFT), "and is taken again while it is frozen"


def test_a_lift_above_a_brick_carries_nothing(port):
    """It was lowered on a brick at the edge, which it presses down: so does a ceiling."""
    port.add(0, (0.06, 0.0, 0.005))
    port.lay(0, -1, WIDE, DEEP, 0.0)
    port.add(LIFT, (0.0, 0.0, 0.1), mass=math.inf)
    port.touch(0, LIFT, [(x, y, 0.01) for x in WIDE for y in DEEP], normal=(0.0, 0.0, -1.0))
    extension = StabilityExtension(port)
    run(extension, 100)
    assert not port.frozen


def test_the_removal_of_a_lift_wakes_what_rested_on_it(port):
    lift_with_column(port)
    extension = StabilityExtension(port)
    settle(extension)
    port.remove(LIFT)
    assert extension.update(DT).woken == (0, 1)


def test_a_snapshot_has_no_kinematic_bodies(port):
    lift_with_column(port)
    with pytest.raises(
        ValueError, match=r"body 50 must have a finite mass, got inf: remove the row, and replace .* by the id -1"
    ):
        solve_equilibrium(port.contacts(), port.masses())


# -- frozen bodies that the port lists all the same --------------------------------------------------------------------


@pytest.mark.parametrize("policy", POLICIES)
def test_a_frozen_body_that_was_moved_is_live_and_its_load_wakes(port, policy):
    lift_with_column(port, 3)
    extension = StabilityExtension(port, policy)
    settle(extension)
    port.show_frozen = True
    assert extension.update(DT).woken == ()
    port.center[1] = (0.0, 0.5, 0.015)
    assert extension.update(DT).woken == (1, 2)


@pytest.mark.parametrize(("policy", "woken"), [("paper", (1, 2)), ("equilibrium", (1, 2)), ("at_rest", ())])
def test_a_frozen_body_that_grows_heavier_is_judged_again(port, policy, woken):
    """A cantilever bears a bucket at its end until that is filled; ``at_rest`` never asks for balance."""
    lift_with_column(port, 1)
    port.mass[0] = 20.0
    port.add(1, (0.04, 0.0, 0.015))
    port.lay(1, 0, (-0.01, 0.05), DEEP, 0.01)
    port.add(2, (0.08, 0.0, 0.025), mass=0.1)
    port.lay(2, 1, (0.07, 0.09), DEEP, 0.02)
    extension = StabilityExtension(port, policy)
    settle(extension)
    assert port.frozen == {0, 1, 2}
    port.show_frozen = True
    port.mass[2] = 5.0
    assert extension.update(DT).woken == woken


@pytest.mark.parametrize("policy", ["paper", "equilibrium"])
def test_a_column_slides_off_a_fixed_lift_as_off_the_ground(port, policy):
    """Gravity turns: arctan(0.45) = 24.23 deg."""
    lift_with_column(port)
    extension = StabilityExtension(port, policy)
    settle(extension)
    for degrees, woken in ((24.2, ()), (24.26, (0, 1))):
        angle = math.radians(degrees)
        extension.gravity = (9.81 * math.sin(angle), 0.0, -9.81 * math.cos(angle))
        assert extension.update(DT).woken == woken
