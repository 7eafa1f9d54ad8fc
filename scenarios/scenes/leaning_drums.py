"""A column of round or hexagonal drums, each shifted by the same step along x.

Theory: along x, the common part of two drums ends at the lower drum's foremost point, at the radius R from its axis. A
hexagon has a corner there. With n drums and the step d, the centre of mass of the n - 1 upper drums lies n d / 2 beyond
the lowest drum's axis. Upper joints carry fewer drums, and are safer. Therefore the column stands while d < 2 R / n. A
column of n - 1 drums stands while d < 2 R / (n - 1).

Look for: the joint ends in a point, not in an edge. If an engine adds contacts beside this point, a column stands
beyond its limit. If an engine omits this point, a column falls early.
"""

from __future__ import annotations

import math
from typing import Annotated

from scenarios.margins import by_margin
from scenarios.model import Brick, Vector, World
from scenarios.parameters import Choice, Margin, Scale, Whole
from scenarios.planks import DENSITY, MU, one_a_second
from scenarios.scenario import Plan, scenario
from scenarios.solids import cylinder, polyhedron

RADIUS = 0.03
"""Radius [m] of a drum, of a hexagon to its corners, at scale 1."""
HEIGHT = 0.03
"""Height of a drum [m], at scale 1."""


@scenario
def leaning_drums(
    *,
    shape: Annotated[str, Choice("cylinder", "hexagon")] = "cylinder",
    drums: Annotated[int, Whole(2, 20)] = 4,
    margin: Margin = 0.2,
    scale: Scale = 4.0,
) -> Plan:
    """Build a column of drums that leans by the same step at each joint.

    Args:
        shape: section of the drums, "cylinder" or "hexagon".
        drums: number of drums.
        margin: share by which the step is smaller than the limit; negative if the step is larger. At
            -1 / (``drums`` - 1) or below, the column would fall before the placement of its last drum.
        scale: factor on all lengths.

    Raises:
        ValueError: if the column would fall before the placement of its last drum.
    """
    if margin <= -1 / (drums - 1):
        raise ValueError(
            f"margin must be above {-1 / (drums - 1):.6g} with {drums} drums, got {margin:g}, because otherwise the "
            "column falls before the placement of its last drum: use a larger margin, or fewer drums"
        )
    step = (1 - margin) * 2 * RADIUS * scale / drums
    column = [
        _drum(shape, (index * step, 0.0, (index + 0.5) * HEIGHT * scale), scale, index + 1) for index in range(drums)
    ]
    return Plan(
        world=World(friction=MU),
        actions=one_a_second([drum] for drum in column),
        expectation=by_margin(
            margin, f"steps of 2 R / {drums}, by the centre over the joint's foremost point", falls_at=drums
        ),
        look_for="a joint that ends in a point: the column tips about it",
        partner={"margin": abs(margin)},
    )


def _drum(shape: str, center: Vector, scale: float, level: int) -> Brick:
    if shape == "cylinder":
        return cylinder(RADIUS * scale, HEIGHT * scale, position=center, density=DENSITY, level=level)
    corners = [
        (RADIUS * scale * math.cos(angle), RADIUS * scale * math.sin(angle), side * HEIGHT * scale / 2)
        for angle in (math.radians(60 * k) for k in range(6))
        for side in (-1, 1)
    ]
    return polyhedron(corners, position=center, density=DENSITY, level=level)
