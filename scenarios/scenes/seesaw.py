"""A tilted plank that lies on two fixed edges, and a heavy block on the plank.

Theory: moments about the lower edge decide. All distances are horizontal. The plank has the mass m, and its middle lies
at the distance p from the lower edge, toward the upper edge. A block of mass M at the distance b on the opposite side
tips the plank if M b > m p. Here the plank tips, because M b = 3.6 m p. A block between the edges presses on both
edges. Then the stack stands, because tan(15 deg) = 0.27 is less than the coefficient of friction, 0.45.

Look for: beyond the lower edge the block's centre is lower than the plank's centre, although the block lies on the
plank. A rule that compares the heights of the centres concludes that the block carries the plank.
"""

from __future__ import annotations

import math
from typing import Annotated

from scenarios.model import Brick, Expectation, Place, Vector, World
from scenarios.parameters import Choice
from scenarios.planks import DENSITY, MU, box
from scenarios.scenario import Plan, scenario

TILT = math.radians(15)
"""Slope [rad] of the plank, which rises toward +x."""
PLANK: Vector = (0.30, 0.05, 0.02)
"""Edges of the plank [m]."""
BLOCK: Vector = (0.05, 0.05, 0.03)
"""Edges of the block [m]."""
MASS = 0.5
"""Mass [kg] of the block: three times the mass of the plank."""
LOWER, UPPER = 0.09, 0.24
"""Distances of the two edges from the plank's lower end, along the plank [m]."""
LIES_AT = {"between": 0.15, "beyond": 0.03}
"""Distance of the block's middle from the plank's lower end, along the plank [m], for each value of ``block``."""
HEIGHT = 0.12
"""Height of the lower edge [m], which leaves room to tip."""
SUPPORT: tuple[float, float] = (0.02, 0.08)
"""Edges of a support in x and y [m]."""


@scenario
def seesaw(*, block: Annotated[str, Choice(*LIES_AT)] = "between") -> Plan:
    """Build a tilted plank that lies on two fixed edges, and a heavy block on the plank.

    Args:
        block: position of the block, "between" the two edges or "beyond" the lower edge.
    """
    plank = _on_slope(PLANK, math.prod(PLANK) * DENSITY, PLANK[0] / 2, 0.0, level=1)
    load = _on_slope(BLOCK, MASS, LIES_AT[block], PLANK[2], level=2)
    if block == "between":
        expectation = Expectation("stand", "block and plank press on both edges")
    else:
        ratio = MASS * -load.position[0] / (plank.mass * plank.position[0])
        expectation = Expectation("fall", f"the block's moment about the edge is {ratio:.1f} times the plank's", 2)
    return Plan(
        world=World(friction=MU, fixed=(_support(LOWER), _support(UPPER))),
        actions=(Place(0.0, (plank,)), Place(1.0, (load,))),
        expectation=expectation,
        look_for="the block lies on the plank, although its centre is lower than the plank's centre",
        partner={"block": "between"},
        planar=True,
    )


def _on_slope(size: Vector, mass: float, along: float, above: float, *, level: int) -> Brick:
    """Return a box parallel to the plank, in coordinates with the lower edge at x = 0.

    Args:
        size: edges [m].
        mass: mass [kg].
        along: distance of the box's middle from the plank's lower end, along the plank [m].
        above: distance of the box's lower face from the plank's lower face [m].
        level: level of the box.
    """
    along, across = along - LOWER, above + size[2] / 2
    x = along * math.cos(TILT) - across * math.sin(TILT)
    z = HEIGHT + along * math.sin(TILT) + across * math.cos(TILT)
    return Brick(size, mass, (x, 0.0, z), (math.cos(TILT / 2), 0.0, -math.sin(TILT / 2), 0.0), level)


def _support(along: float) -> Brick:
    """Return a fixed box that carries the plank's lower face on an upper edge, ``along`` [m] from the lower end."""
    x, height = (along - LOWER) * math.cos(TILT), HEIGHT + (along - LOWER) * math.sin(TILT)
    return box((*SUPPORT, height), x + SUPPORT[0] / 2, level=1)
