"""A pyramid of planks in a plane: rows of n, n - 1, ... 1 planks, each plank across the gap between two planks below.

Theory: let every plank pass its load to its two supports in equal halves, through the middles of the overlaps. Moments
balance, because loads and supports are symmetric about the plank's middle. All forces are pressures. Therefore the
pyramid stands at any height, with any gap between neighbours.

Look for: with gaps of half a plank, each plank rests on its ends only. An engine that distributes a row's load unevenly
lets the lowest row creep apart.
"""

from __future__ import annotations

from typing import Annotated

from scenarios.model import Expectation, World
from scenarios.parameters import Real, Whole
from scenarios.planks import LENGTH, MU, lay, one_a_second
from scenarios.scenario import Plan, scenario


@scenario
def pyramid(*, rows: Annotated[int, Whole(1, 30)] = 4, gap: Annotated[float, Real(0, 90, "mm")] = 58.5) -> Plan:
    """Build rows of planks, each row one plank shorter and across the gaps of the row below.

    Args:
        rows: number of rows, and of planks in the lowest row.
        gap: distance between neighbours of a row [mm], by default half a plank; at 0 neighbours touch.
    """
    pitch = LENGTH + gap * 1e-3
    planks = [
        lay((index - (rows - level) / 2) * pitch, level=level)
        for level in range(1, rows + 1)
        for index in range(rows - level + 1)
    ]
    return Plan(
        world=World(friction=MU),
        actions=one_a_second([plank] for plank in planks),
        expectation=Expectation("stand", "every plank shares its load in equal halves between two supports"),
        look_for="a lowest row that creeps apart, because planks rest on their ends only",
        planar=True,
    )
