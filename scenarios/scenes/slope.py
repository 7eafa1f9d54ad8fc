"""A block at rest on a fixed slope, placed without a gap, which stands, slides, or tips over its lower edge.

Theory: with angle theta, friction mu and a ratio r of height over width

- the block slides if mu < tan(theta);
- the block tips if r > 1 / tan(theta), because its centre of mass then lies beyond the lower edge.

The block does not drop, so that contact and friction alone decide.

Look for: each engine has its own least friction and its own greatest ratio with which the block stands. A bisection
finds these limits (study ``thresholds``).
"""

from __future__ import annotations

import math
from typing import Annotated

from scenarios.margins import by_margin
from scenarios.model import Brick, Place, World
from scenarios.parameters import Friction, Real
from scenarios.planks import DENSITY
from scenarios.scenario import Plan, dynamic_scenario

WIDTH = 0.04
"""Edges [m] of the block along and across the slope."""
RAMP = (0.30, 0.12, 0.02)
"""Edges [m] of the fixed slab."""


@dynamic_scenario
def slope(
    *,
    theta: Annotated[float, Real(1, 40, "deg")] = 20.0,
    friction: Friction = 0.6,
    ratio: Annotated[float, Real(0.1, 10)] = 0.2,
) -> Plan:
    """Build a block at rest on a fixed slope.

    Args:
        theta: angle [deg] between slope and ground.
        friction: Coulomb coefficient of every pair.
        ratio: height of the block over its width.
    """
    angle = math.radians(theta)
    limit = math.tan(angle)
    turn = (math.cos(angle / 2), 0.0, -math.sin(angle / 2), 0.0)

    def parallel(size: tuple[float, float, float], along: float, bottom: float, mass: float) -> Brick:
        """Return a box parallel to the slab, with its lower face ``bottom`` [m] above the slab's lower face."""
        across = bottom + size[2] / 2
        x = along * math.cos(angle) - across * math.sin(angle)
        z = along * math.sin(angle) + across * math.cos(angle)
        return Brick(size, mass, (x, 0.0, z), turn)

    size = (WIDTH, WIDTH, ratio * WIDTH)
    slab = parallel(RAMP, RAMP[0] / 2, 0.0, 1.0)
    block = parallel(size, RAMP[0] / 2, RAMP[2], DENSITY * math.prod(size))
    margin = min(friction / limit - 1, 1 - ratio * limit)
    return Plan(
        world=World(friction=friction, fixed=(slab,)),
        actions=(Place(0.0, (block,), 0.0),),
        expectation=by_margin(margin, f"mu = tan(theta) = {limit:.3f} or height / width = {1 / limit:.3f}", falls_at=1),
        look_for="a block that creeps or tips where it must hold, or holds where it must not",
        planar=True,
    )
