"""A plank that leans against a wall, with its foot on the ground; two, three or four bodies hold the plank.

Theory: the foot is the origin, the upper contact lies at (X, Y), and the centre of mass at x_c. At the limit both
contacts begin to slip. The ground's normal force is n, and the coefficient of friction is mu. The wall pushes with
N = mu n, and carries mu N:

    n (1 + mu^2) = weight                        vertical forces
    x_c (1 + mu^2) = mu Y + mu^2 X               moments about the foot
    tan(theta) = (1 - mu^2) / (2 mu)             limit for a thin plank

At both ends an edge meets a single face. Therefore every engine and every convention agrees on the normals.

The parameter ``held_by`` splits the wall into two halves, and the ground into two tiles. Each half of the wall then
holds a corner of the plank. In theory the split changes nothing. But more than two bodies then hold the plank, and the
paper's rule allows only two bodies.

Look for: the foot slips, and the plank slides down the wall. A plank that stays at rest with less friction than the
limit is a false stand.
"""

from __future__ import annotations

import math
from typing import Annotated

from scenarios.margins import by_margin
from scenarios.model import Brick, World
from scenarios.parameters import Gap, Margin, Real, Whole
from scenarios.planks import LENGTH, MASS, THICKNESS, box, lean, one_a_second
from scenarios.scenario import Plan, scenario

WALL = (0.08, 0.08, 0.16)
"""Edges of the wall [m]; each half has half this depth, less half the gap between the halves."""
TILE = (0.06, 0.08, THICKNESS)
"""Edges of the ground's two tiles together [m]."""
HEAVY = 100 * MASS
"""Mass [kg] of the wall, and of the tiles, so large that wall and tiles do not move."""


@scenario
def wall_plank(
    *,
    held_by: Annotated[int, Whole(2, 4)] = 2,
    theta: Annotated[float, Real(50, 80, "deg")] = 65.0,
    margin: Margin = 0.15,
    gap: Gap = 2.0,
) -> Plan:
    """Build a plank that leans against a wall.

    Args:
        held_by: number of bodies that hold the plank: 2 for ground and wall, 3 for the ground and two halves of the
            wall, 4 for two halves of the ground and two halves of the wall.
        theta: angle [deg] between plank and ground.
        margin: share by which the friction exceeds its limit; negative if the friction is smaller.
        gap: distance between the halves of the wall, and of the ground [mm]; at 0 the halves touch.
    """
    limit = least_friction(math.radians(theta))
    return Plan(
        world=World(friction=(1 + margin) * limit),
        actions=one_a_second([_group(held_by, math.radians(theta), gap * 1e-3)]),
        expectation=by_margin(margin, f"mu = {limit:.3f}, at which foot and top slip together", falls_at=1),
        look_for="the foot slips, the plank slides down the wall; a plank that stays below the limit is a false stand",
        partner={"margin": abs(margin)},
        planar=held_by == 2,
    )


def least_friction(theta: float) -> float:
    """Return the least Coulomb coefficient at which a plank that leans at ``theta`` [rad] can rest."""
    x, y = LENGTH * math.cos(theta), LENGTH * math.sin(theta)
    center = (x - THICKNESS * math.sin(theta)) / 2
    return (math.sqrt(y * y + 4 * center * (x - center)) - y) / (2 * (x - center))


def _group(held_by: int, theta: float, gap: float) -> list[Brick]:
    """Return the plank and its supports as the bricks of one placement, because noise would separate two placements."""
    floor = TILE[2] if held_by == 4 else 0.0
    plank = lean(0.0, theta=theta, toward=1, level=1, bottom=floor)
    wall = _in_halves(WALL, LENGTH * math.cos(theta) + WALL[0] / 2, gap if held_by >= 3 else None)
    return [*(_in_halves(TILE, 0.0, gap) if held_by == 4 else []), *wall, plank]


def _in_halves(size: tuple[float, float, float], x: float, gap: float | None) -> list[Brick]:
    """Return a heavy box in two halves, ``gap`` [m] apart along y, or in one piece if ``gap`` is None."""
    if gap is None:
        return [box(size, x, level=1, mass=HEAVY)]
    depth = (size[1] - gap) / 2
    half = (size[0], depth, size[2])
    return [box(half, x, side * (depth + gap) / 2, level=1, mass=HEAVY / 2) for side in (-1, 1)]
