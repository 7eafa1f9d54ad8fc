"""A heavy cube on light cubes: a column of two, or a pyramid with a heavy cap.

Theory: weight only presses a stack together. In a pyramid every cube passes its load to its two supports in equal
halves, so that nothing turns under a cap of any weight. In a column the upper cube tips if its offset exceeds half an
edge. Then its centre lies beyond the edge of the lower cube.

Look for: an iterative solver passes a load on by one cube in each iteration, in shares of the cubes' own masses.
Therefore light cubes sink, or the load squeezes these cubes out. For an exact solver the ratio of masses makes no
difference.
"""

from __future__ import annotations

from typing import Annotated

from scenarios.margins import by_margin
from scenarios.model import Brick, Expectation, World
from scenarios.parameters import Choice, Real, Whole
from scenarios.planks import MU, box, one_a_second
from scenarios.scenario import Plan, scenario

EDGE = 0.1
"""Edge of every cube [m]."""
MASS = 0.5
"""Mass of a light cube [kg], which has half the density of water."""
PITCH = 1.02 * EDGE
"""Distance between the middles of neighbours in a row of the pyramid [m], so large that neighbours do not touch."""


@scenario
def heavy_top(
    *,
    stack: Annotated[str, Choice("column", "pyramid")] = "column",
    ratio: Annotated[float, Real(1, 1000)] = 100.0,
    aside: Annotated[float, Real(0, 0.9)] = 0.0,
    rows: Annotated[int, Whole(2, 10)] = 10,
) -> Plan:
    """Build a heavy cube on light cubes: a column of two, or a pyramid with a heavy cap.

    Args:
        stack: "column" of two cubes, or "pyramid" of ``rows`` rows.
        ratio: mass of the topmost cube over the mass of every other cube.
        aside: offset of the topmost cube of a column from the middle, as a share of the cube's edge.
        rows: number of rows of the pyramid; 10 rows have 55 cubes.

    Raises:
        ValueError: if ``aside`` is not 0 for a pyramid.
    """
    if stack == "pyramid" and aside:
        raise ValueError(
            f"parameter 'aside' applies only to stack = 'column', got aside = {aside:g} with stack = 'pyramid': leave "
            "out 'aside', or use stack = 'column'"
        )
    cubes = [_cube(0.0, 1), _cube(aside * EDGE, 2)] if stack == "column" else _pyramid(rows)
    cubes[-1] = _cube(cubes[-1].position[0], cubes[-1].level, ratio)
    return Plan(
        world=World(friction=MU),
        actions=one_a_second([cube] for cube in cubes),
        expectation=_expectation(stack, aside),
        look_for="light cubes that sink or are pressed out from under a heavy cube",
        partner={"aside": min(aside, round(1 - aside, 9))} if aside else None,
        planar=True,
    )


def _expectation(stack: str, aside: float) -> Expectation:
    if stack == "column" and aside:
        return by_margin(1 - 2 * aside, "half an edge aside", falls_at=2)
    return Expectation("stand", "every cube passes its load down in equal halves, at any load")


def _pyramid(rows: int) -> list[Brick]:
    return [
        _cube((index - (rows - level) / 2) * PITCH, level)
        for level in range(1, rows + 1)
        for index in range(rows - level + 1)
    ]


def _cube(x: float, level: int, ratio: float = 1.0) -> Brick:
    return box((EDGE, EDGE, EDGE), x, level=level, bottom=(level - 1) * EDGE, mass=MASS * ratio)
