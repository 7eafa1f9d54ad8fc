"""A tower of planks on a platform that lifts the tower and then tilts it.

Theory: a lift that accelerates downward at less than g carries its bricks. On a slope of angle a, a plank holds while
tan a <= mu, the coefficient of friction, under any load. Below the friction angle of 24.2 deg the tower stands, and
above this angle the planks slide. The tower does not tip, because the planks lie along the slope, and the tower is much
longer than high.

Look for: a frozen stack must travel with the platform, and must react to the platform's tilt.
"""

from __future__ import annotations

import math
from typing import Annotated

from scenarios.model import Action, Brick, Drive, Place, World
from scenarios.parameters import Real, Whole
from scenarios.planks import LENGTH, MU, THICKNESS, WIDTH, lay
from scenarios.scenario import Plan, dynamic_scenario
from scenarios.scenes.shared.slopes import TILT_S, on_slope

BOTTOM, PLATE = 0.1, 0.02
"""Lengths [m] of the platform:

- BOTTOM: initial height of its lower face;
- PLATE: its thickness.
"""
PAUSE_S = 2.0
"""Time from the last plank to the lift [s]."""
RISE, RISE_S = 0.1, 2.0
"""Motion of the platform:

- RISE: height of the rise [m];
- RISE_S: duration of the rise [s].
"""


@dynamic_scenario
def lifted_tower(
    *, angle: Annotated[float, Real(0.0, 45.0, "deg")] = 28.0, levels: Annotated[int, Whole(1, 6)] = 3
) -> Plan:
    """Build a tower of planks on a platform that lifts the tower and then tilts it.

    Args:
        angle: final angle of the platform [deg].
        levels: number of planks.
    """
    platform = Brick((3 * LENGTH, 3 * WIDTH, PLATE), 1.0, (0.0, 0.0, BOTTOM + PLATE / 2), moved=True)
    top = BOTTOM + PLATE
    actions: list[Action] = [Place(0.0, (platform,), height=BOTTOM)]
    for index in range(levels):
        plank = lay(0.0, level=index + 2, bottom=top + index * THICKNESS)
        actions.append(Place(1.0 + index, (plank,)))
    time = actions[-1].time + PAUSE_S
    speed = 2 * RISE / RISE_S
    spin = math.radians(angle) / TILT_S
    tilt = time + RISE_S + 1.0
    still = (0.0, 0.0, 0.0)
    actions += [
        Drive(time, 0, (0.0, 0.0, speed), seconds=RISE_S / 2, carries=True),
        Drive(time + RISE_S / 2, 0, still, seconds=RISE_S / 2, carries=True),
        Drive(tilt, 0, still, (0.0, spin, 0.0), carries=True),
        Drive(tilt + TILT_S, 0, still, carries=True),
    ]
    return Plan(
        world=World(friction=MU),
        actions=tuple(actions),
        expectation=on_slope(angle, levels + 1, tilt),
        look_for="the tower rises and tilts with the platform; above the friction angle the planks slide off",
        partner={"angle": 28.0},
        planar=True,
    )
