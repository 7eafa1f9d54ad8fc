"""The paper's 4-stack: four planks a level in a pinwheel, whose sense of rotation alternates.

Each plank's end meets the next plank's side across a gap. The next level turns in the opposite sense, so that every
plank lies mostly on one plank, and with its end on a second plank.

Theory: on each of the four sides the planks shift along their length, alternately left and right. The shift is half a
gap plus half a width: 12.7 mm. The centre of mass of any upper part of a side lies at most 12.7 mm from the middle
line. The planks of two levels overlap by 45.8 mm on either side of this line. Therefore each side alone is in
equilibrium at any height. Without a gap, the values are 11.7 mm and 46.8 mm.

Look for: every plank has two supports, and its load can pass to either support. If an engine shares loads wrongly
between the two supports, first the stack sinks, and then one side gives way.
"""

from __future__ import annotations

import math
from typing import Annotated

from scenarios.model import Brick, Expectation, World
from scenarios.parameters import Gap, Whole
from scenarios.planks import LENGTH, MU, WIDTH, lay, one_a_second
from scenarios.scenario import Plan, scenario


@scenario
def four_stack(*, levels: Annotated[int, Whole(1, 200)] = 30, gap: Gap = 2.0) -> Plan:
    """Build levels of four planks in a pinwheel that turns the other way at each level.

    Args:
        levels: number of levels, of four planks each.
        gap: distance between a plank's end and the side of the next plank [mm]; at 0 the planks touch.
    """
    planks = [plank for level in range(1, levels + 1) for plank in _pinwheel(level, gap * 1e-3)]
    return Plan(
        world=World(friction=MU),
        actions=one_a_second([plank] for plank in planks),
        expectation=Expectation("stand", "each side alone carries its weight: in equilibrium at any height"),
        look_for="sinking, until one side gives way; an engine may share loads wrongly between the two supports",
    )


def _pinwheel(level: int, gap: float) -> list[Brick]:
    """Return the four planks of a level, around the stack, with gaps of ``gap`` [m]."""
    along = (gap + WIDTH) / 2 * (-1) ** level
    out = (LENGTH + gap) / 2
    quarter_turns = (0.0, math.pi / 2, math.pi, -math.pi / 2)
    return [
        lay(
            along * math.cos(turn) + out * math.sin(turn),
            along * math.sin(turn) - out * math.cos(turn),
            yaw=turn,
            level=level,
        )
        for turn in quarter_turns
    ]
