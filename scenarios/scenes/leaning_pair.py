"""Two planks that lean against each other, at rest: an inverted V without a gap.

Theory (see ``card_house``), for planks of length L and thickness t. If the ridge's normal is horizontal (*bisector*),
only the feet need friction: a coefficient of (cot(theta) - t / L) / 2. If an engine reports the normal of a plank's
face at the ridge (*face*), the ridge needs the coefficient cot(theta).

Look for: the least angle at which the pair holds. A bisection of ``theta`` (study ``thresholds``) finds the engine's
own limit. This limit measures the quality of the engine's contacts at the ridge.
"""

from __future__ import annotations

import math
from typing import Annotated

from scenarios.model import Place, World
from scenarios.parameters import Friction, Real
from scenarios.planks import LENGTH, lean
from scenarios.scenario import Plan, dynamic_scenario
from scenarios.scenes.card_house import expected


@dynamic_scenario
def leaning_pair(*, theta: Annotated[float, Real(30, 88, "deg")] = 75.0, friction: Friction = 0.3) -> Plan:
    """Build two planks that lean against each other, at rest.

    Args:
        theta: angle [deg] between a plank and the ground.
        friction: Coulomb coefficient of every pair.
    """
    angle = math.radians(theta)
    foot = LENGTH * math.cos(angle)
    pair = (lean(-foot, theta=angle, toward=1, level=1), lean(foot, theta=angle, toward=-1, level=1))
    return Plan(
        world=World(friction=friction),
        actions=(Place(0.0, pair, 0.0),),
        expectation=expected(angle, friction),
        look_for="feet that slip, and a ridge that drops",
        planar=True,
    )
