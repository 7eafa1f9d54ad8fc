"""A sphere on three spheres that touch each other, on the ground: alone, or between three heavy stops.

Theory: the upper sphere's contacts lie at a = asin(1 / sqrt(3)) = 35.26 deg to the vertical.

- Without stops, three forces act on a lower sphere: its weight, the ground's force and the upper sphere's force. All
  three pass through the contact with the ground, because the first two do. Therefore the upper sphere's force leans by
  a / 2 to the vertical and to the contact's normal. The pyramid opens if the coefficient of friction mu between the
  spheres is below tan(a / 2) = 0.318. On the ground mu > 0.080 suffices.
- Above this limit friction balances the pyramid on level ground. But one motion meets no resistance: the lower spheres
  roll forward, and the upper sphere turns backward like a gear. All centres move together, and no contact slides.
  Therefore the pyramid rolls away on the least slope. The scene is a study, because a scene that must stand needs a
  margin.
- Each of three stops touches two lower spheres. Two stops hold each sphere, at 60 deg on either side of the outward
  direction. Pressure alone holds the spheres, and no sphere can move unless another sphere rises. With the weight W of
  a sphere, the force on each stop is 2 W tan(a) / 3. A stop weighs twice as much as all spheres together. Therefore a
  stop does not slide if mu > 0.059.
- With a stop outside each lower sphere instead, the pyramid could turn about its axis, because the spheres roll along
  the stops. This balance is unstable: the pyramid opens after 4 s in Bullet and in MuJoCo.

Look for: spheres that roll apart below the limit, and only without stops.
"""

from __future__ import annotations

import math
from typing import Annotated

from scenarios.margins import by_margin
from scenarios.model import Brick, Expectation, Place, World
from scenarios.parameters import Choice, Margin, Scale
from scenarios.planks import DENSITY, box
from scenarios.scenario import Plan, scenario
from scenarios.solids import sphere

RADIUS = 0.02
"""Radius of a sphere [m], at scale 1."""
LEAN = math.asin(1 / math.sqrt(3))
"""Angle [rad] of the upper sphere's contacts to the vertical."""
LIMIT = math.tan(LEAN / 2)
"""Coefficient of friction between the spheres below which the pyramid opens without stops."""
STOP = 2.0
"""Ratio of a stop's weight to the weight of all spheres."""
STOPS_SLIDE = 2 * math.tan(LEAN) / 3 / (4 * STOP)
"""Coefficient of friction below which the stops may slide."""
CLEAR = 0.25
"""Least distance from ``STOPS_SLIDE`` at which the scene has a known answer, as a share of the limit."""
ANGLES = (0.0, 2 * math.pi / 3, 4 * math.pi / 3)
"""Directions [rad] of the lower spheres from the pyramid's axis; the stops lie between them."""


@scenario
def ball_pyramid(
    *, margin: Margin = 0.4, stops: Annotated[str, Choice("none", "three")] = "none", scale: Scale = 1.0
) -> Plan:
    """Build a pyramid of four spheres, without stops or between three stops.

    Args:
        margin: share by which the friction exceeds its limit without stops.
        stops: "three" for a heavy block beside each pair of lower spheres, "none" for no blocks.
        scale: factor on all lengths.
    """
    radius = RADIUS * scale
    away = 2 * radius / math.sqrt(3)
    low = [
        sphere(
            radius,
            position=(away * math.cos(angle), away * math.sin(angle), radius),
            density=DENSITY,
        )
        for angle in ANGLES
    ]
    rise = radius * (1 + 2 * math.sqrt(2 / 3))
    top = sphere(radius, position=(0.0, 0.0, rise), density=DENSITY, level=2)
    blocks = _stops(away / 2 + radius, 4 * top.mass, scale) if stops == "three" else []
    return Plan(
        world=World(friction=(1 + margin) * LIMIT),
        actions=(Place(0.0, (*blocks, *low, top), 0.0),),
        expectation=_expectation(margin, stops),
        look_for="lower spheres that roll apart without stops, and stay between stops",
        partner={"stops": "three"},
    )


def _expectation(margin: float, stops: str) -> Expectation:
    if stops == "three":
        if (1 + margin) * LIMIT < (1 + CLEAR) * STOPS_SLIDE:
            return Expectation("study", f"the stops may slide near mu = {STOPS_SLIDE:.3f}")
        return Expectation("stand", "pressure alone holds the spheres between stops that do not slide")
    opens = by_margin(margin, f"mu = {LIMIT:.3f} = tan(35.26 deg / 2), by three forces on a sphere", falls_at=2)
    if opens.outcome == "stand":
        return Expectation("study", "friction holds it, but on the least slope all spheres roll away together")
    return opens


def _stops(reach: float, load: float, scale: float) -> list[Brick]:
    """Return the three stops, each with a face at the distance ``reach`` [m] from the axis."""
    edge = 3 * RADIUS * scale
    middle = reach + edge / 2
    size = (edge, edge, edge)
    return [
        box(size, middle * math.cos(angle), middle * math.sin(angle), level=1, yaw=angle, mass=STOP * load)
        for angle in (direction + math.pi / 3 for direction in ANGLES)
    ]
