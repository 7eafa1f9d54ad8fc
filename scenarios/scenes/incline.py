"""A tile on a ramp, held by friction.

Theory: on a ramp at the angle theta the tile slides if tan(theta) exceeds the coefficient of friction mu, at any mass.

- The ramp is a heavy slab that stands on its lower edge and leans on a heavy block's edge. The slab itself needs less
  than two thirds of the tile's friction (exact statics). The reason is that the ground and the block's edge carry most
  of the slab's weight.
- On the lower half of the ramp, the tile's centre is lower than the ramp's centre, although the tile lies on the ramp.
- Neither the heading of the ramp nor a turn of the tile changes the limit, because Coulomb's law has no preferred
  direction.
- A solver that bounds friction separately along two tangents (a box in place of the cone) allows up to sqrt(2) times
  the friction along the diagonal. A heading of 45 deg reveals tangents that follow the world, and a turn of 45 deg
  reveals tangents that follow the tile.

Look for: a tile that creeps down at mu just above tan(theta) shows a solver's soft friction. If a tile sticks at mu
just below tan(theta), a rule may have frozen the tile on landing.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Annotated

from scenarios.margins import by_margin
from scenarios.model import Brick, Vector, World
from scenarios.parameters import Choice, Margin, Real
from scenarios.planks import LENGTH, MASS, THICKNESS, WIDTH, one_a_second
from scenarios.scenario import Plan, scenario
from scenarios.scenes.shared.transforms import transformed

RAMP = (0.30, 0.10, 0.02)
"""Edges of the slab [m]."""
BLOCK = (0.08, 0.10)
"""Edges of the block in x and y [m]; its height follows from the angle."""
HEAVY = 100 * MASS
"""Mass [kg] of slab and block."""
TILE = (0.3 * LENGTH, WIDTH, THICKNESS)
"""Edges of the tile [m]."""
LEANS_AT = 0.27
"""Distance from the slab's foot, along the slab, at which the slab leans on the block's edge [m]."""
LIES_AT = {"upper": 0.20, "lower": 0.06}
"""Distance of the tile's middle from the slab's foot, along the slab [m], for each half of the ramp."""


@scenario
def incline(
    *,
    theta: Annotated[float, Real(5, 30, "deg")] = 20.0,
    margin: Margin = 0.15,
    half: Annotated[str, Choice(*LIES_AT)] = "upper",
    heading: Annotated[float, Real(0, 90, "deg")] = 0.0,
    turn: Annotated[float, Real(0, 90, "deg")] = 0.0,
) -> Plan:
    """Build a tile on a ramp.

    Args:
        theta: angle [deg] between ramp and ground.
        margin: share by which the friction exceeds its limit; negative if the friction is smaller.
        half: half of the ramp on which the tile lies: "upper" or "lower".
        heading: turn [deg] of the whole scene about the vertical.
        turn: turn [deg] of the tile on the ramp, about the ramp's normal.
    """
    angle = math.radians(theta)
    limit = math.tan(angle)
    tilt = (math.cos(angle / 2), 0.0, -math.sin(angle / 2), 0.0)
    turn_cos, turn_sin = math.cos(math.radians(turn) / 2), math.sin(math.radians(turn) / 2)

    def on_slab(size: Vector, along: float, above: float, level: int, mass: float) -> Brick:
        """Return a box parallel to the slab.

        ``above`` [m] is the height of the box's lower face over the slab's lower face.
        """
        across = above + size[2] / 2
        x = along * math.cos(angle) - across * math.sin(angle)
        z = along * math.sin(angle) + across * math.cos(angle)
        return Brick(size, mass, (x, 0.0, z), tilt, level)

    height = LEANS_AT * math.sin(angle)
    block = Brick((*BLOCK, height), HEAVY, (LEANS_AT * math.cos(angle) + BLOCK[0] / 2, 0.0, height / 2), level=1)
    slab = on_slab(RAMP, RAMP[0] / 2, 0.0, 1, HEAVY)
    tile = on_slab(TILE, LIES_AT[half], RAMP[2], 2, MASS * 0.3)
    w, _, j, _ = tilt
    tile = replace(tile, quaternion=(w * turn_cos, j * turn_sin, j * turn_cos, w * turn_sin))  # turn, then tilt
    groups = [[transformed(brick, 1.0, 1.0, heading) for brick in group] for group in ([block, slab], [tile])]
    return Plan(
        world=World(friction=(1 + margin) * limit),
        actions=one_a_second(groups),
        expectation=by_margin(margin, f"mu = tan(theta) = {limit:.3f}", falls_at=2),
        look_for="a tile that creeps where it must hold, or sticks where it must slide",
        partner={"margin": abs(margin)},
        planar=heading == 0.0 and turn == 0.0,
    )
