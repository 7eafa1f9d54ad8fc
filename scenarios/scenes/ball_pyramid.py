"""A sphere on three spheres that touch each other, on the ground.

Theory: the upper sphere's contacts lie at a = asin(1 / sqrt(3)) = 35.26 deg to the vertical. A lower sphere has three
forces: its weight and the ground's force pass through its contact with the ground, so the upper sphere's force does
too. This force leans by a / 2 to the vertical and to the contact's normal. So the pyramid stands if mu > tan(a / 2) =
0.318 between the spheres; on the ground mu > 0.080 suffices.

Look for: spheres that roll apart below the limit. Above it nothing rolls: an engine without enough friction in point
contacts lets the pyramid open.
"""

from __future__ import annotations

import math

from scenarios.margins import by_margin
from scenarios.model import Place, World
from scenarios.parameters import Margin, Scale
from scenarios.planks import DENSITY
from scenarios.scenario import Plan, scenario
from scenarios.solids import sphere

RADIUS = 0.02
"""Radius of a sphere [m], at scale 1."""
LIMIT = math.tan(math.asin(1 / math.sqrt(3)) / 2)
"""Coefficient of friction between the spheres below which the pyramid opens."""


@scenario
def ball_pyramid(*, margin: Margin = 0.4, scale: Scale = 1.0) -> Plan:
    """Build a pyramid of four spheres.

    Args:
        margin: share by which the friction exceeds its limit.
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
        for angle in (0.0, 2 * math.pi / 3, 4 * math.pi / 3)
    ]
    rise = radius * (1 + 2 * math.sqrt(2 / 3))
    top = sphere(radius, position=(0.0, 0.0, rise), density=DENSITY, level=2)
    return Plan(
        world=World(friction=(1 + margin) * LIMIT),
        actions=(Place(0.0, (*low, top), 0.0),),
        expectation=by_margin(
            margin, f"mu = {LIMIT:.3f} = tan(35.26 deg / 2), by three forces on a sphere", falls_at=2
        ),
        look_for="lower spheres that roll apart",
        partner={"margin": abs(margin)},
    )
