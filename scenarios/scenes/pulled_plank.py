"""A tower, and a slow or fast pull that draws a plank out along its length.

Theory: the pulled plank drags the plank above (the upper part) with mu times its weight, at any speed (mu: coefficient
of friction).

- Slow pull: the upper part travels along, because it rests on nothing else.
- Fast pull: for a plank of length L and the speed v, the drag lasts only for the time T = L / v. The drag moves the
  upper part by mu g T^2 / 2: by 30 mm at 1 m/s, by 1.2 mm at 5 m/s. Then the upper part drops by a thickness.

The scene is a study, because statics does not decide how the upper part lands.

Look for: in a slow pull the upper part travels with the plank. Above some speed the upper part stays behind and drops.
"""

from __future__ import annotations

from typing import Annotated

from scenarios.model import Action, Expectation, Pull, World
from scenarios.parameters import Real, Whole
from scenarios.planks import LENGTH, MU, lay, one_a_second
from scenarios.scenario import Plan, dynamic_scenario

PAUSE_S = 2.0
"""Time from the last plank to the pull [s]."""
WAY = 1.2 * LENGTH
"""Length of the pull [m], which removes the plank completely."""


@dynamic_scenario
def pulled_plank(
    *, speed: Annotated[float, Real(0.01, 20, "m/s")] = 0.1, levels: Annotated[int, Whole(3, 100)] = 4
) -> Plan:
    """Pull the plank below the topmost plank out of a tower, along its length.

    Args:
        speed: speed of the pull [m/s].
        levels: number of planks.
    """
    actions: tuple[Action, ...] = one_a_second([lay(0.0, level=level)] for level in range(1, levels + 1))
    actions += (Pull(actions[-1].time + PAUSE_S, levels - 2, (speed, 0.0), WAY / speed),)
    return Plan(
        world=World(friction=MU),
        actions=actions,
        expectation=Expectation("study", "dynamics decide how far the plank above travels along, and how it lands"),
        look_for="in a slow pull the plank above travels along; in a fast pull it stays behind and drops",
        planar=True,
    )
