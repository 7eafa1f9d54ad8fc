"""A tower of planks on ground that tilts: gravity turns, in the frame of the ground.

Theory: on a slope of angle a, planks hold while tan a <= mu, the coefficient of friction, under any load. Below the
friction angle of 24.2 deg the tower stands, and above this angle the planks slide. The tower does not tip, because the
planks lie along the slope, and the tower is much longer than high.

Look for: a frozen tower must react to the tilt, although no contact changes.
"""

from __future__ import annotations

from typing import Annotated

from scenarios.model import Action, Tilt, World
from scenarios.parameters import Real, Whole
from scenarios.planks import MU, lay, one_a_second
from scenarios.scenario import Plan, dynamic_scenario
from scenarios.scenes.shared.slopes import TILT_S, on_slope

PAUSE_S = 2.0
"""Time from the last plank to the tilt [s]."""


@dynamic_scenario
def tilted_ground(
    *, angle: Annotated[float, Real(0.1, 45.0, "deg")] = 28.0, levels: Annotated[int, Whole(1, 6)] = 4
) -> Plan:
    """Build a tower of planks on ground that tilts: gravity turns.

    Args:
        angle: final angle of the ground [deg].
        levels: number of planks.
    """
    actions: tuple[Action, ...] = one_a_second([lay(0.0, level=level)] for level in range(1, levels + 1))
    time = actions[-1].time + PAUSE_S
    actions += (Tilt(time, (0.0, 1.0), angle / TILT_S, TILT_S),)
    return Plan(
        world=World(friction=MU),
        actions=actions,
        expectation=on_slope(angle, levels, time),
        look_for="above the friction angle the tower slides off, though no contact has changed",
        partner={"angle": 28.0},
        planar=True,
    )
