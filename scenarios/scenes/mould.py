"""Bricks poured between four walls. Then the scene removes the walls.

The scene follows S.-W. Hsu, J. Keyser, "Automated constraint placement to maintain pile shape", ACM Transactions on
Graphics 31(6), 2012. In this paper a user gives a pile an arbitrary shape, and constraints between the objects keep the
shape. Without constraints the pile collapses.

Theory gives no outcome. The walls hold a block of loose bricks. The block's sides are steeper than a pile can be.
Without the walls, friction with the coefficient mu holds only a slope of atan(mu), and interlocked bricks hold a
somewhat steeper slope. Therefore most of the block flows apart. With ``strike``, the scene strikes a brick inside the
block sideways. A method that keeps the shape must also let this brick go.

Look for: the part of the block that remains without the walls, and the part that moves with the struck brick.
"""

from __future__ import annotations

import math
import random
from typing import Annotated

from scenarios.model import CLEARANCE, Action, Brick, Expectation, Place, Push, Remove, World
from scenarios.parameters import Friction, Real, Whole
from scenarios.planks import DENSITY, MU, box
from scenarios.scenario import Plan, dynamic_scenario
from scenarios.scenes.shared.pouring import PACE_S, SIZE, poured_bricks

INSIDE = 3.0
"""Inner side of the mould, as a multiple of a brick's longest edge."""
WALL = 0.03
"""Thickness of a wall [m]."""
PACKING = 0.5
"""Share of the mould's volume that loose bricks fill; random packings of bricks fill more, so that all fit."""
ROOM = 0.08
"""Height of the walls above the bricks [m], so that no brick leaves the mould."""
RELEASE = 10e-3
"""Release height [m] above the bricks in the mould."""
SETTLE_S = 5.0
"""Time from the last brick to the removal of the walls, and from the removal to the strike [s]."""
WATCH_S = 5.0
"""Duration of the trial after the last action [s]."""


@dynamic_scenario
def mould(
    *,
    bricks: Annotated[int, Whole(2, 500)] = 60,
    strike: Annotated[float, Real(0, 10, "m/s")] = 0.0,
    friction: Friction = MU,
    draw: Annotated[int, Whole(0, 10**9)] = 1,
) -> Plan:
    """Pour bricks between four walls, remove the walls, and optionally strike a brick.

    Args:
        bricks: number of bricks.
        strike: speed [m/s] that a strike gives to a brick in the middle of the block; 0 for no strike.
        friction: Coulomb coefficient of every pair.
        draw: number from which all random poses follow; each number gives another pile.
    """
    side = INSIDE * max(SIZE)
    height = bricks * math.prod(SIZE) / (PACKING * side**2) + ROOM
    walls = _walls(side, height)
    reach = side / 2 - math.hypot(*SIZE) / 2
    poured = poured_bricks(
        bricks, random.Random(draw), lambda draws: (draws.uniform(-reach, reach), draws.uniform(-reach, reach)), walls
    )
    pours = [Place(1.0 + PACE_S * number, (brick,), CLEARANCE + RELEASE) for number, brick in enumerate(poured)]
    removed_s = pours[-1].time + SETTLE_S
    actions: list[Action] = [Place(0.0, tuple(walls)), *pours, *(Remove(removed_s, wall) for wall in range(len(walls)))]
    if strike:
        struck = len(walls) + bricks // 2
        actions.append(Push(removed_s + SETTLE_S, struck, (strike * poured[0].mass, 0.0, 0.0)))
    return Plan(
        world=World(friction=friction),
        actions=tuple(actions),
        expectation=Expectation("study", "dynamics decide how much of a poured block remains without its walls"),
        look_for="how much of the block remains without its walls, and how much of it a strike takes along",
        watch_s=WATCH_S,
        poured=True,
    )


def _walls(side: float, height: float) -> list[Brick]:
    """Return four walls around a square of ``side`` [m], each beside the end of the next wall, without contact."""
    middle, length = (side + WALL) / 2, side + WALL - 2e-3
    size = (length, WALL, height)
    mass = math.prod(size) * DENSITY
    walls = []
    for quarter in range(4):
        yaw = quarter * math.pi / 2
        along, across = -WALL / 2, -middle
        x, y = along * math.cos(yaw) - across * math.sin(yaw), along * math.sin(yaw) + across * math.cos(yaw)
        walls.append(box(size, x, y, level=1, yaw=yaw, mass=mass))
    return walls
