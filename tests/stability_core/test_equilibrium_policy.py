"""The policy `equilibrium` on a scripted world: what freezes, what wakes, and by which proof."""

from __future__ import annotations

import numpy as np
import pytest

from stability_core import GROUND, Settings, StabilityExtension
from tests.stability_core.dwell import CALM_FRAMES, LOAD_FRAMES, REST_FRAMES

DT = 1 / 60
SETTINGS = Settings()
WIDE = (-0.05, 0.05)
DEEP = (-0.01, 0.01)
THICKNESS = 0.01


def plank(port, body: int, x: float, below: dict[int, float], level: int, **more: object) -> None:
    """A plank of 100 x 20 x 10 mm at ``x`` on planks at the given places."""
    port.add(body, (x, 0.0, (level + 0.5) * THICKNESS), **more)
    for lower, at in below.items():
        low, high = max(x, at) - 0.05, min(x, at) + 0.05
        port.lay(body, lower, (x - 0.05, x + 0.05) if lower == GROUND else (low, high), DEEP, level * THICKNESS)


def frames(extension, n: int) -> list:
    return [extension.update(DT) for _ in range(n)]


def settle(extension) -> dict[int, str]:
    """Until nothing has happened for as long as any rule waits; returns the reasons."""
    reasons, quiet = {}, 0
    while quiet <= CALM_FRAMES + REST_FRAMES:
        change = extension.update(DT)
        reasons.update(change.reasons)
        quiet = 0 if change.reasons else quiet + 1
    return reasons


@pytest.fixture
def extension(port) -> StabilityExtension:
    return StabilityExtension(port, "equilibrium")


def test_a_straight_column_lies_in_safe_regions_all_the_way(port, extension):
    for body in range(30):
        plank(port, body, 0.0, {body - 1: 0.0}, body)
        reasons = settle(extension) if body == 29 else frames(extension, REST_FRAMES + 1)[-1].reasons
    assert port.frozen == set(range(30))
    assert set(reasons.values()) == {"safe region"}
    assert all(kind == "sleep" for kind, _ in port.batches)


def test_what_topples_alone_is_never_frozen(port, extension):
    port.add(0, (0.06, 0.0, 0.005))
    port.lay(0, GROUND, WIDE, DEEP, 0.0)
    frames(extension, 100)
    assert not port.frozen


@pytest.mark.parametrize(("offset", "levels"), [(0.1 / 8.5, 9), (0.1 / 4.5, 5)])
def test_a_leaning_tower_pivots_on_its_lowest_plank(port, extension, offset, levels):
    """The first n with n d > L wakes all but the plank on which the rest turns."""
    for body in range(levels):
        plank(port, body, body * offset, {body - 1: (body - 1) * offset}, body)
        frames(extension, 2 * REST_FRAMES)
        if body < levels - 1:
            assert port.frozen == set(range(body + 1)), f"{body + 1} levels stand"
    assert port.frozen == {0}
    assert [kind for kind, _ in port.batches].count("wake") == 1


def test_a_counterweight_holds_until_it_goes(port, extension):
    """Moments about the edge at 50 mm, in kg mm: plank 3 pulls with 35; plank 1 holds 5 and the weight 150."""
    plank(port, 0, 0.0, {GROUND: 0.0}, 0)
    plank(port, 1, 0.045, {0: 0.0}, 1)
    port.add(2, (0.0, 0.0, 0.025), mass=3.0)
    port.lay(2, 1, (-0.005, 0.005), DEEP, 2 * THICKNESS)
    settle(extension)
    plank(port, 3, 0.085, {1: 0.045}, 2)
    assert settle(extension) == {3: "equilibrium"}
    assert port.frozen == {0, 1, 2, 3}
    port.remove(2)
    assert extension.update(DT).woken == (1, 3)


def leaning_pair(port, theta: float, friction: float, foot: tuple[int, float] = (GROUND, 0.0)) -> None:
    """Planks 0 and 1, which stand on a body whose top is at a height."""
    lower, bottom = foot
    half, height = 0.1 * np.cos(np.radians(theta)), 0.1 * np.sin(np.radians(theta))
    for body, side in ((0, -1.0), (1, 1.0)):
        port.add(body, (side * half / 2, 0.0, bottom + height / 2))
        port.touch(body, lower, [(side * half, y, bottom) for y in DEEP], friction=friction)
    port.touch(1, 0, [(0.0, y, bottom + height) for y in DEEP], normal=(1.0, 0.0, 0.0), friction=friction)


@pytest.mark.parametrize("theta", [50.0, 60.0, 72.0])
def test_an_inverted_v_is_frozen_iff_statics_holds_it(port, extension, theta):
    """Thin planks: mu = cot(theta) / 2. The paper's rule accepts less between 50 and 65 degrees."""
    least = 0.5 / np.tan(np.radians(theta))
    leaning_pair(port, theta, 0.99 * least)
    frames(extension, 30)
    assert not port.frozen
    for touch in port.touches:
        touch.friction = 1.01 * least
    settle(extension)
    assert port.batches == [("sleep", [0, 1])]


@pytest.mark.parametrize(
    ("depth", "heel_gap", "is_edge"),
    [(1.2e-3, 0.3e-3, True), (0.1e-3, 0.3e-3, False), (2.2e-3, -0.6e-3, True), (2.2e-3, -1.9e-3, False)],
)
def test_a_plank_pressed_into_the_ground_still_stands_on_its_edge(port, extension, depth, heel_gap, is_edge):
    """Its other edge comes near the ground, or into it, only because this one is too deep: drawn out, it hovers.

    A V at 78 deg that landed 2.2 mm deep has its heels 0.6 mm in the ground as well. A plank on an edge is frozen while
    it still sinks; one on two edges lies flat and must first come to rest.
    """
    leaning_pair(port, 72.0, 0.45)
    for foot, body, side in zip(list(port.touches), (0, 1), (-1.0, 1.0), strict=False):
        foot.separation, foot.velocity = -depth, (0.0, 0.02, 0.0)  # sliding too fast for rest, slow enough to lean
        heel = [(x + side * 0.007, y, z) for x, y, z in foot.points]
        port.touch(body, GROUND, heel, separation=heel_gap, velocity=foot.velocity)
    port.touches.sort(key=lambda touch: (touch.lower, touch.upper))  # engines list a pair's points together
    frames(extension, 30)
    assert port.frozen == ({0, 1} if is_edge else set())


def test_half_a_v_is_not_frozen(port, extension):
    """The partner is held by the user: the plank that leans on it must wait."""
    leaning_pair(port, 72.0, 0.45)
    extension.update(DT)
    extension.disturb([1])
    frames(extension, 60)
    assert not port.frozen


def test_any_number_of_leaning_contacts(port, extension):
    """A plank on two feet against two walls: the paper's rule gives up above two contacts."""
    x, z = 0.1 * np.cos(np.radians(72.0)), 0.1 * np.sin(np.radians(72.0))
    port.add(0, (x / 2, 0.0, z / 2))
    port.touch(0, GROUND, [(0.0, y, 0.0) for y in DEEP])
    for wall, y in ((1, -0.01), (2, 0.01)):
        port.add(wall, (x + 0.02, y, 0.05), mass=10.0)
        port.lay(wall, GROUND, (x, x + 0.04), (y - 0.009, y + 0.009), 0.0)
        port.touch(0, wall, [(x, y, z)], normal=(-1.0, 0.0, 0.0))
    settle(extension)
    assert port.frozen == {0, 1, 2}


def test_a_live_brick_loads_what_it_lies_on(port, extension):
    """A heavy brick that never comes to rest on a cantilever's end: the cantilever wakes all the same."""
    plank(port, 0, 0.0, {GROUND: 0.0}, 0)
    plank(port, 1, 0.04, {0: 0.0}, 1)
    settle(extension)
    assert port.frozen == {0, 1}
    port.add(2, (0.085, 0.0, 0.025), mass=2.0)
    port.lay(2, 1, (0.08, 0.09), DEEP, 0.02, separation=-4e-4)
    changes = frames(extension, LOAD_FRAMES + 2)
    assert {body for change in changes for body in change.woken} == {1}


def test_a_live_brick_that_tips_off_wakes_nothing(port, extension):
    """It hangs over the edge of a column that could bear far more: it alone falls."""
    for body in range(5):
        plank(port, body, 0.0, {body - 1: 0.0}, body)
    settle(extension)
    port.add(5, (0.06, 0.0, 0.055))
    port.lay(5, 4, (0.01, 0.05), DEEP, 0.05)
    changes = frames(extension, 60)
    assert not any(change.woken for change in changes)
    assert port.frozen == set(range(5))


def test_what_topples_off_an_end_that_cannot_bear_it_takes_that_end_along(port, extension):
    """Pressed where the brick turns, at 90 mm, the cantilever turns as well about the edge at 50 mm."""
    plank(port, 0, 0.0, {GROUND: 0.0}, 0)
    plank(port, 1, 0.04, {0: 0.0}, 1)
    settle(extension)
    port.add(2, (0.095, 0.0, 0.025), mass=2.0)
    port.lay(2, 1, (0.05, 0.09), DEEP, 0.02)
    changes = frames(extension, REST_FRAMES + 1)
    assert {body for change in changes for body in change.woken} == {1}


def test_a_v_that_slips_wakes_nothing_of_the_column_below_it(port, extension):
    for body in range(2, 7):
        plank(port, body, 0.0, {body - 1 if body > 2 else GROUND: 0.0}, body - 2)
    settle(extension)
    leaning_pair(port, 72.0, 0.05, foot=(6, 5 * THICKNESS))
    changes = frames(extension, 60)
    assert not any(change.woken for change in changes)
    assert port.frozen == {2, 3, 4, 5, 6}


def test_a_lost_support_is_noticed(port, extension):
    """A beam over three posts, of which first the needless one goes, then one that it needs."""
    for post, x in ((0, -0.04), (1, 0.0), (2, 0.04)):
        port.add(post, (x, 0.0, 0.005))
        port.lay(post, GROUND, (x - 0.005, x + 0.005), DEEP, 0.0)
    port.add(3, (0.0, 0.0, 0.015))
    for post, x in ((0, -0.04), (1, 0.0), (2, 0.04)):
        port.lay(3, post, (x - 0.005, x + 0.005), DEEP, THICKNESS)
    settle(extension)
    assert port.frozen == {0, 1, 2, 3}
    port.remove(1)
    assert not extension.update(DT).woken
    port.remove(2)
    assert extension.update(DT).woken == (3,)


def many_leaning_pairs(port, pairs: int) -> None:
    """Inverted Vs of 63 deg side by side: each pair of planks can only be judged together."""
    for pair in range(pairs):
        for side in (-1, 1):
            body = 2 * pair + (side > 0)
            port.add(body, (pair + side * 0.025, 0.0, 0.05))
            port.touch(body, GROUND, [(pair + side * 0.05, y, 0.0) for y in DEEP])
        port.touch(2 * pair + 1, 2 * pair, [(pair, y, 0.1) for y in DEEP], normal=(1.0, 0.0, 0.0))


def test_freezing_beyond_the_budget_is_deferred_by_a_frame_and_reported(port):
    """A budget of 4 bodies a frame is spent by two pairs."""
    many_leaning_pairs(port, 7)
    extension = StabilityExtension(port, "equilibrium", settings=Settings(budget=4))
    changes = [change for change in frames(extension, 3 * REST_FRAMES) if change.frozen]
    assert [len(change.frozen) for change in changes] == [4, 4, 4, 2]
    assert [len(change.deferred) for change in changes] == [10, 6, 2, 0]
    assert changes[0].deferred == tuple(sorted(set(range(14)) - set(changes[0].frozen)))


def test_what_is_adopted_knows_no_budget(port):
    many_leaning_pairs(port, 7)
    extension = StabilityExtension(port, "equilibrium", settings=Settings(budget=4))
    assert extension.adopt().frozen == tuple(range(14))


def test_a_row_that_leans_on_itself_is_judged_in_batches(port):
    """Forty planks on the ground whose sides touch are one part of the stack: more than are judged together."""
    for body in range(40):
        port.add(body, (0.1 * body, 0.0, 0.005))
        port.lay(body, GROUND, (0.1 * body - 0.05, 0.1 * body + 0.05), DEEP, 0.0)
        if body:
            at = [(0.1 * body - 0.05, y, z) for y in DEEP for z in (0.0, 0.01)]
            port.touch(body, body - 1, at, normal=(1.0, 0.0, 0.0))
    extension = StabilityExtension(port, "equilibrium")
    settle(extension)
    assert port.frozen == set(range(40))
