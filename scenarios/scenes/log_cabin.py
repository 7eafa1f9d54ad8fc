"""A log cabin: two parallel planks a level, each level across the level below.

Theory: each plank rests with both ends on the two planks below, and carries the next two planks at its ends. By
symmetry half of the load above passes down through each plank, through the contact squares at its ends. Therefore the
cabin stands at any height.

Look for: the contact squares form four thin columns that must stay vertical. The cabin rocks if one column has sunk
deeper.
"""

from __future__ import annotations

import math
from typing import Annotated

from scenarios.model import Expectation, World
from scenarios.parameters import Whole
from scenarios.planks import LENGTH, MU, WIDTH, lay, one_a_second
from scenarios.scenario import Plan, scenario

APART = (LENGTH - WIDTH) / 2
"""Distance from the cabin's middle to the middle of a plank [m], so that planks end flush with the sides of others."""


@scenario
def log_cabin(*, levels: Annotated[int, Whole(1, 200)] = 8) -> Plan:
    """Build levels of two parallel planks, each level across the level below.

    Args:
        levels: number of levels, of two planks each.
    """
    planks = [
        lay(0.0, side * APART, level=level) if level % 2 else lay(side * APART, level=level, yaw=math.pi / 2)
        for level in range(1, levels + 1)
        for side in (-1, 1)
    ]
    return Plan(
        world=World(friction=MU),
        actions=one_a_second([plank] for plank in planks),
        expectation=Expectation(
            "stand", "every plank carries two loads and has two supports, symmetric about its middle"
        ),
        look_for="four columns of contact squares that must stay vertical; the cabin rocks if one column sinks deeper",
    )
