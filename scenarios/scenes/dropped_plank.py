"""A plank that drops onto a tower.

Theory: a drop from the height h supplies the energy m g h. The upper k planks, of mass m and thickness t each, need the
energy

    k m g (sqrt(e^2 + z^2) - z),    z = k t / 2,    e: half the width

to tip over a long edge of the plank below. The topmost plank alone needs the least energy. While m g h is less than
half of this least energy, no plank can tip. No plank slides, because the dropped plank strikes the middle. After a drop
from a greater height dynamics decide, and the scene is a study.

Look for: a blow on a frozen brick must unfreeze only the bodies that the blow can move. A stack that withstands every
blow is a false stand.
"""

from __future__ import annotations

import math
from typing import Annotated

from scenarios.model import Expectation, Place, World
from scenarios.parameters import Real, Whole
from scenarios.planks import MU, THICKNESS, WIDTH, lay, one_a_second
from scenarios.scenario import Plan, dynamic_scenario

PAUSE_S = 2.0
"""Time from the last plank to the drop [s]."""
TIPS = math.hypot(WIDTH / 2, THICKNESS / 2) - THICKNESS / 2
"""Ratio of the energy that tips one plank about its long edge to the weight of the plank [m]."""


@dynamic_scenario
def dropped_plank(
    *, height: Annotated[float, Real(0.5, 1000, "mm")] = 3.0, levels: Annotated[int, Whole(2, 100)] = 4
) -> Plan:
    """Drop a plank on a tower.

    Args:
        height: drop height [mm] above the topmost plank.
        levels: number of planks, including the dropped plank.
    """
    tower = one_a_second([lay(0.0, level=level)] for level in range(1, levels))
    dropped = Place(tower[-1].time + PAUSE_S, (lay(0.0, level=levels),), height * 1e-3)
    if height * 1e-3 <= TIPS / 2:
        expectation = Expectation(
            "stand", f"the drop has under half the energy to tip a plank ({TIPS * 1e3:.1f} mm m g)"
        )
    else:
        expectation = Expectation("study", f"the drop has enough energy to tip a plank ({TIPS * 1e3:.1f} mm m g)")
    return Plan(
        world=World(friction=MU),
        actions=(*tower, dropped),
        expectation=expectation,
        look_for="a blow must unfreeze the bodies that it can move, and no other bodies",
        planar=True,
    )
