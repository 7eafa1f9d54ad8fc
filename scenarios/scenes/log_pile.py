"""Cylinders that lie in a pyramid, between two heavy stops or without stops.

Theory, for rows of r, r - 1, ... 1 equal cylinders of weight W that touch each other:

- Between stops normal forces alone hold the pile. Each row's load passes down at 30 deg to the vertical. The stops take
  the horizontal part, at most tan(30 deg) / 2 of the weight of all cylinders. A stop is three times as heavy as all
  cylinders together. Therefore friction below the stop balances this force if the coefficient mu exceeds 0.096.
- Two rows without stops: the upper cylinder's force on a lower cylinder must pass through the lower cylinder's line of
  contact with the ground. This force leans by 15 deg to the contact's normal. Therefore the pile opens if
  mu < tan(15 deg) = 0.268. Above this limit friction balances the pile on level ground. But one motion meets no
  resistance: the lower cylinders roll forward, and the upper cylinder turns backward like a gear. On the least slope
  the pile rolls away. Therefore the scene is a study.
- Three rows and more without stops open below tan(15 deg) too, because the upper rows only add load. Above this limit
  the scene is a study, because the answer depends on the stiffness of the contacts.

Look for: contacts along lines. Cylinders that touch in one point only can turn about the vertical.
"""

from __future__ import annotations

import math
from typing import Annotated

from scenarios.model import Brick, Expectation, Place, World
from scenarios.parameters import Choice, Friction, Scale, Whole
from scenarios.planks import DENSITY, box
from scenarios.scenario import Plan, scenario
from scenarios.solids import cylinder

RADIUS = 0.02
"""Radius of a cylinder [m], at scale 1."""
LENGTH = 0.12
"""Length of a cylinder [m], at scale 1."""
STOP = 3.0
"""Ratio of a stop's weight to the weight of all cylinders."""
OPENS = math.tan(math.radians(15))
"""Coefficient of friction below which a pile without stops opens."""
STOPS_SLIDE = math.tan(math.radians(30)) / 2 / STOP
"""Coefficient of friction below which the stops may slide."""
CLEAR = 0.25
"""Least distance from ``OPENS`` and from ``STOPS_SLIDE`` at which the scene has a known answer, as a share of the
limit, because engines differ in the friction of line contacts."""
_ALONG_Y = (math.sqrt(0.5), -math.sqrt(0.5), 0.0, 0.0)


@scenario
def log_pile(
    *,
    rows: Annotated[int, Whole(2, 8)] = 3,
    stops: Annotated[str, Choice("both", "none")] = "both",
    friction: Friction = 0.15,
    scale: Scale = 1.0,
) -> Plan:
    """Build a pyramid of lying cylinders, between stops or without.

    Args:
        rows: number of rows, and of cylinders in the lowest row.
        stops: "both" for a heavy block on each side, "none" for no blocks.
        friction: Coulomb coefficient of every pair.
        scale: factor on all lengths.
    """
    radius = RADIUS * scale
    logs = [
        cylinder(
            radius,
            LENGTH * scale,
            position=((2 * index - (rows - row)) * radius, 0.0, radius * (1 + (row - 1) * math.sqrt(3))),
            quaternion=_ALONG_Y,
            density=DENSITY,
            level=row,
        )
        for row in range(1, rows + 1)
        for index in range(rows - row + 1)
    ]
    blocks = _stops(rows * radius, sum(log.mass for log in logs), scale) if stops == "both" else []
    return Plan(
        world=World(friction=friction),
        actions=(Place(0.0, (*blocks, *logs), 0.0),),
        expectation=_expectation(rows, stops, friction),
        look_for="cylinders that roll apart, or turn about the vertical",
        partner={"stops": "both"},
    )


def _expectation(rows: int, stops: str, friction: float) -> Expectation:
    if stops == "both":
        if friction < (1 + CLEAR) * STOPS_SLIDE:
            return Expectation("study", f"the stops may slide near mu = {STOPS_SLIDE:.3f}")
        return Expectation("stand", "pressure alone holds the cylinders between stops that do not slide")
    if friction <= (1 - CLEAR) * OPENS:
        return Expectation("fall", f"below mu = tan(15 deg) = {OPENS:.3f} the lowest row rolls apart", rows)
    if rows == 2:
        return Expectation("study", "friction may hold it, but on the least slope all cylinders roll away together")
    return Expectation("study", f"near or above mu = tan(15 deg) = {OPENS:.3f} other stiffness decides")


def _stops(reach: float, load: float, scale: float) -> list[Brick]:
    """Return two stops that touch the lowest row on both sides, at the distance ``reach`` [m] from the middle."""
    edge = 3 * RADIUS * scale
    size = (edge, LENGTH * scale, edge)
    return [box(size, side * (reach + edge / 2), level=1, mass=STOP * load) for side in (-1, 1)]
