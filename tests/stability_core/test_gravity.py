"""Gravity in any direction: what stands depends on it, not on the coordinates, and is judged again when it turns."""

from __future__ import annotations

import math

import numpy as np
import pytest

from stability_core import GROUND, StabilityExtension
from stability_core.policies.paper import Paper
from tests.stability_core.test_extension import DEEP, DT, SETTINGS, WIDE, column, leaning_pair, run, settle

G = 9.81
DOWN = (0.0, 0.0, -G)
POLICIES = ["paper", "at_rest", "equilibrium", "pile"]
JUDGES = ["paper", "equilibrium"]


def tilted(degrees: float, strength: float = G) -> tuple[float, float, float]:
    """Gravity turned from straight down towards x."""
    return strength * math.sin(math.radians(degrees)), 0.0, -strength * math.cos(math.radians(degrees))


def rotation(random: np.random.Generator) -> np.ndarray:
    q, r = np.linalg.qr(random.normal(size=(3, 3)))
    q *= np.sign(np.diag(r))
    return q if np.linalg.det(q) > 0 else -q


def turn_world(port, turn: np.ndarray) -> None:
    port.center = {body: tuple(turn @ center) for body, center in port.center.items()}
    for touch in port.touches:
        touch.points = [tuple(turn @ point) for point in touch.points]
        touch.normal, touch.velocity = tuple(turn @ touch.normal), tuple(turn @ touch.velocity)


@pytest.mark.parametrize("gravity", [(0, 0, 0), (0, 0, np.nan), (0, np.inf, 0), (0, -9.81)])
def test_gravity_is_a_finite_vector(port, gravity):
    with pytest.raises(ValueError, match="three finite numbers"):
        StabilityExtension(port, gravity=gravity)
    extension = StabilityExtension(port)
    with pytest.raises(ValueError, match="three finite numbers"):
        extension.gravity = gravity
    assert extension.gravity == DOWN


@pytest.mark.parametrize("policy", ["paper", "at_rest", "equilibrium"])
@pytest.mark.parametrize("seed", range(3))
def test_a_world_and_its_gravity_may_be_turned_together(port, policy, seed):
    """A column, an inverted V and a brick that topples: the same frames, whatever the coordinates."""
    reference = type(port)()
    turn = rotation(np.random.default_rng(seed))
    for world in (reference, port):
        leaning_pair(world)
        for touch in world.touches:
            touch.points = [(x + 1.0, y, z) for x, y, z in touch.points]
        world.center = {body: (x + 1.0, y, z) for body, (x, y, z) in world.center.items()}
        world.add(7, (-1 + 0.06, 0.0, 0.005))
        world.lay(7, GROUND, (-1.05, -0.95), DEEP, 0.0)
        for body in range(10, 13):
            z = (body - 10) * 0.01
            world.add(body, (0.0, 0.0, z + 0.005))
            world.lay(body, body - 1 if body > 10 else GROUND, WIDE, DEEP, z)
    turn_world(port, turn)
    straight = StabilityExtension(reference, policy)
    extension = StabilityExtension(port, policy, gravity=tuple(turn @ DOWN))
    assert run(extension, 60) == run(straight, 60)
    reference.remove(0)
    port.remove(0)
    assert run(extension, 5) == run(straight, 5)
    assert extension.why(7) == straight.why(7)


@pytest.mark.parametrize("policy", JUDGES)
def test_a_column_slides_at_its_angle_of_friction(port, policy):
    """Gravity turns by 0.1 deg/s, so slowly that each frame is at rest: arctan(0.45) = 24.228 deg."""
    column(port, 10)
    extension = StabilityExtension(port, policy)
    settle(extension)
    assert len(port.frozen) == 10
    for degrees in np.arange(0.0, 24.0, 0.5):
        extension.gravity = tilted(degrees)
        assert not extension.update(DT).woken, f"woken at {degrees} deg"
    for degrees in np.arange(24.0, 24.5, 0.1 * DT):
        extension.gravity = tilted(degrees)
        if extension.update(DT).woken:
            break
    assert degrees == pytest.approx(math.degrees(math.atan(0.45)), abs=0.05)
    assert not port.frozen


@pytest.mark.parametrize("policy", JUDGES)
def test_a_tall_column_topples_before_it_slides(port, policy):
    """Ten planks, 20 mm deep and 100 mm high, tilted about their long side: arctan(10 / 50) = 11.31 deg.

    Exact statics wakes at the angle itself, the paper's rule once the centre lies outside by the wake margin.
    """
    column(port, 10)
    extension = StabilityExtension(port, policy)
    settle(extension)
    expected = math.degrees(math.atan(0.2))
    margin = math.degrees(SETTINGS.wake_margin * 0.0512 / 0.05) if policy == "paper" else 0.0
    for degrees in np.arange(10.0, 14.0, 0.05):
        x, _, z = tilted(degrees)
        extension.gravity = (0.0, x, z)
        if extension.update(DT).woken:
            break
    assert expected <= degrees <= expected + margin + 0.06


@pytest.mark.parametrize("policy", JUDGES)
def test_a_side_becomes_a_support_and_a_support_a_side(port, policy):
    """A brick in a corner of floor and wall, another on its top: gravity turns to the wall."""
    port.add(0, (0.05, 0.0, 0.005))
    port.lay(0, GROUND, (0.0, 0.1), DEEP, 0.0)
    port.touch(0, GROUND, [(0.0, y, z) for y in DEEP for z in (0.0, 0.01)], normal=(1.0, 0.0, 0.0))
    port.add(1, (0.06, 0.0, 0.015))
    port.lay(1, 0, (0.01, 0.1), DEEP, 0.01)
    extension = StabilityExtension(port, policy)
    settle(extension)
    assert port.frozen == {0, 1}
    extension.gravity = (-G, 0.0, 0.0)
    assert extension.update(DT).woken == (1,), "it hangs beside the other, above nothing"
    assert port.frozen == {0}
    extension.gravity = DOWN
    assert extension.update(DT).woken == ()


@pytest.mark.parametrize("policy", JUDGES)
def test_between_floor_and_ceiling_the_lowest_becomes_the_topmost(port, policy):
    """Upside down the column stands on the ceiling: what is taken away there wakes all others."""
    column(port, 3)
    port.touch(2, GROUND, [(x, y, 0.03) for x in WIDE for y in DEEP], normal=(0.0, 0.0, -1.0))
    extension = StabilityExtension(port, policy)
    settle(extension)
    assert port.frozen == {0, 1, 2}
    extension.gravity = (0.0, 0.0, G)
    assert extension.update(DT).woken == ()
    port.remove(0)
    assert extension.update(DT).woken == (), "nothing rests on it any more"
    port.remove(2)
    assert extension.update(DT).woken == (1,)


@pytest.mark.parametrize("policy", POLICIES)
def test_upside_down_everything_falls_off_the_floor(port, policy):
    column(port, 1)
    extension = StabilityExtension(port, policy)
    settle(extension)
    assert port.frozen == {0}
    extension.gravity = (0.0, 0.0, G)
    assert extension.update(DT).woken == (0,)
    run(extension, 100)
    assert not port.frozen


@pytest.mark.parametrize("policy", JUDGES)
def test_a_load_that_is_live_is_turned_with_the_rest(port, policy):
    """It trembles on a cantilever that bears it until both are tilted."""
    column(port, 1)
    port.add(1, (0.02, 0.0, 0.015))
    port.lay(1, 0, (-0.03, 0.05), DEEP, 0.01)
    extension = StabilityExtension(port, policy)
    settle(extension)
    port.add(2, (0.045, 0.0, 0.03), mass=1.0)
    port.lay(2, 1, (0.03, 0.06), DEEP, 0.02, separation=-2 * SETTINGS.lean_penetration * 0.05)
    for frame in range(30):
        port.center[2] = (0.045, 0.0, 0.03 + 2e-4 * (frame % 2))
        assert not extension.update(DT).woken
    extension.gravity = tilted(-10.0)
    for _ in range(3):
        assert not extension.update(DT).woken, "the loads move inwards"
    extension.gravity = tilted(60.0)
    assert extension.update(DT).woken == (0, 1)


def test_the_noise_of_an_accelerometer_judges_nothing_again(port):
    settled = []

    class Counted(Paper):
        def settle(self, graph, watch):
            settled.append(1)
            return super().settle(graph, watch)

    column(port, 3)
    extension = StabilityExtension(port, Counted(G, SETTINGS))
    settle(extension)
    settled.clear()
    random = np.random.default_rng(1)
    for _ in range(100):
        tilt = random.uniform(-1.0, 1.0) * math.degrees(SETTINGS.gravity_tilt)
        extension.gravity = tilted(tilt, G * (1 + 0.9 * SETTINGS.gravity_change * random.uniform(-1, 1)))
        assert not extension.update(DT).woken
    assert not settled
    for step in range(100):
        extension.gravity = tilted(0.1 * step * math.degrees(SETTINGS.gravity_tilt))
        extension.update(DT)
    assert 8 <= len(settled) <= 10, "small changes add up"


def test_limits_of_speed_follow_the_strength_of_gravity(port):
    """On the moon all falls more slowly, so that the same speed counts for more."""
    column(port, 1)
    extension = StabilityExtension(port, Paper(G, SETTINGS), gravity=(0.0, 0.0, -1.62))
    assert extension.policy.gravity == 1.62
    extension.update(DT)
    port.center[0] = (0.0, 0.0, 0.006)
    extension.update(DT)
    assert extension.why(0).startswith("moves at 60 mm/s, above 1.1 mm/s")
    extension.gravity = DOWN
    port.center[0] = (0.0, 0.0, 0.005)
    extension.update(DT)
    assert extension.why(0).startswith("moves at 60 mm/s, above 2.8 mm/s")


def test_what_was_frozen_in_doubt_wakes_when_gravity_turns(port):
    """Two walls hold a brick: the engine held it under the gravity of before."""
    port.add(0, (0.0, 0.0, 0.5))
    port.touch(0, GROUND, [(-0.05, y, z) for y in DEEP for z in (0.495, 0.505)], normal=(1.0, 0.0, 0.0))
    port.touch(0, GROUND, [(0.05, y, z) for y in DEEP for z in (0.495, 0.505)], normal=(-1.0, 0.0, 0.0))
    extension = StabilityExtension(port, "equilibrium")
    run(extension, round((SETTINGS.doubt_s + SETTINGS.rest_s) / DT) + 2)
    assert extension.why(0) == "frozen: held by the engine"
    extension.gravity = tilted(1.0)
    assert extension.update(DT).woken == (0,)
