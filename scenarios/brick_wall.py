"""A wall in running bond: planks along x, every joint is bridged, half planks close the ends of every other course.

Theory: cut every joint between courses into pieces of half a plank, and let forces go through the middles of these
pieces. A half plank has its one support straight below its load, a whole one has two at equal arms, and moments about
its middle give both. All come out as pressure, nearly equal along a course: in equilibrium at any height.

What to look for: most planks have two supports and two loads. An engine that shares them badly opens the joints at the
ends, where a half plank stands on one side of a whole one.
"""

from __future__ import annotations

from scenarios.model import Brick, Expectation, Scene, World
from scenarios.parameters import Value, variant_of, whole
from scenarios.planks import GAP, LENGTH, MU, lay, one_a_second

HALF = (LENGTH - GAP) / 2
"""Length [m] of a half plank: two of them and their gap make a whole one."""


def brick_wall(*, courses: int = 8, width: int = 3) -> Scene:
    """A wall of planks along x in running bond, each course a level.

    Args:
        courses: number of courses.
        width: whole planks in odd courses; even ones have one less, and a half plank at each end.
    """
    courses = whole("courses", courses, least=1, most=200)
    width = whole("width", width, least=2, most=50)
    parameters: dict[str, Value] = {"courses": courses, "width": width}
    planks = [plank for level in range(1, courses + 1) for plank in _course(level, width)]
    return Scene(
        scenario="brick_wall",
        variant=variant_of(brick_wall, parameters),
        parameters=parameters,
        world=World(friction=MU),
        actions=one_a_second([plank] for plank in planks),
        expectation=Expectation("stand", "pressure through the middles of the half-plank joints balances every plank"),
        look_for="joints that open at the ends, where a half plank loads one side of a whole one",
        planar=True,
    )


def _course(level: int, width: int) -> list[Brick]:
    """One course, from left to right."""
    pitch = LENGTH + GAP
    wholes = width - (level + 1) % 2
    row = [lay((index - (wholes - 1) / 2) * pitch, level=level) for index in range(wholes)]
    if wholes == width:
        return row
    end = (wholes * pitch + GAP + HALF) / 2
    return [lay(-end, level=level, length=HALF), *row, lay(end, level=level, length=HALF)]
