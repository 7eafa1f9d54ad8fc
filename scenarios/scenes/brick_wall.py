"""A wall in running bond: planks along x bridge the gaps of the course below; every other course ends in half planks.

Theory: divide every joint (the contact area of two courses) into pieces of half a plank. Let one force act in the
middle of each piece. A half plank has one support straight below its load. A whole plank has two supports at equal
arms, and moments about its middle give both forces. All these forces are pressures, nearly equal along a course.
Therefore the wall is in equilibrium at any height, without forces between the neighbours of a course.

Look for: most planks have two supports and two loads. An engine that distributes the loads badly opens the joints at
the ends, where a half plank stands on one side of a whole plank.
"""

from __future__ import annotations

from typing import Annotated

from scenarios.model import Brick, Expectation, World
from scenarios.parameters import Gap, Whole
from scenarios.planks import LENGTH, MU, lay, one_a_second
from scenarios.scenario import Plan, scenario


@scenario
def brick_wall(
    *, courses: Annotated[int, Whole(1, 200)] = 8, width: Annotated[int, Whole(2, 50)] = 3, gap: Gap = 2.0
) -> Plan:
    """Build a wall of planks along x in running bond, each course a level.

    Args:
        courses: number of courses.
        width: number of whole planks in odd courses. Even courses have one whole plank less, and a half plank at each
            end.
        gap: distance between neighbours of a course [mm]; at 0 their faces touch.
    """
    planks = [plank for level in range(1, courses + 1) for plank in _course(level, width, gap * 1e-3)]
    return Plan(
        world=World(friction=MU),
        actions=one_a_second([plank] for plank in planks),
        expectation=Expectation("stand", "pressure through the middles of the half-plank joints balances every plank"),
        look_for="joints that open at the ends, where a half plank loads one side of a whole plank",
        planar=True,
    )


def _course(level: int, width: int, gap: float) -> list[Brick]:
    """Return the planks of a course, left to right, with gaps of ``gap`` [m].

    Two half planks and a gap are as long as a whole plank.
    """
    pitch, half = LENGTH + gap, (LENGTH - gap) / 2
    wholes = width - (level + 1) % 2
    row = [lay((index - (wholes - 1) / 2) * pitch, level=level) for index in range(wholes)]
    if wholes == width:
        return row
    end = (wholes * pitch + gap + half) / 2
    return [lay(-end, level=level, length=half), *row, lay(end, level=level, length=half)]
