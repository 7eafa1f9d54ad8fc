"""A wall in running bond: planks along x, every joint is bridged, half planks close the ends of every other course.

Theory: cut every joint between courses into pieces of half a plank, and let forces go through the middles of these
pieces. A half plank has its one support straight below its load, a whole one has two at equal arms, and moments about
its middle give both. All come out as pressure, nearly equal along a course: in equilibrium at any height. No force
between neighbours of a course is needed, whether they touch or not.

What to look for: most planks have two supports and two loads. An engine that shares them badly opens the joints at the
ends, where a half plank stands on one side of a whole one.
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
    """A wall of planks along x in running bond, each course a level.

    Args:
        courses: number of courses.
        width: whole planks in odd courses; even ones have one less, and a half plank at each end.
        gap: between neighbours of a course [mm]; with 0 their faces touch.
    """
    planks = [plank for level in range(1, courses + 1) for plank in _course(level, width, gap * 1e-3)]
    return Plan(
        world=World(friction=MU),
        actions=one_a_second([plank] for plank in planks),
        expectation=Expectation("stand", "pressure through the middles of the half-plank joints balances every plank"),
        look_for="joints that open at the ends, where a half plank loads one side of a whole one",
        planar=True,
    )


def _course(level: int, width: int, gap: float) -> list[Brick]:
    """Return one course, left to right, with gaps of ``gap`` [m]: two half planks and their gap make a whole plank."""
    pitch, half = LENGTH + gap, (LENGTH - gap) / 2
    wholes = width - (level + 1) % 2
    row = [lay((index - (wholes - 1) / 2) * pitch, level=level) for index in range(wholes)]
    if wholes == width:
        return row
    end = (wholes * pitch + gap + half) / 2
    return [lay(-end, level=level, length=half), *row, lay(end, level=level, length=half)]
