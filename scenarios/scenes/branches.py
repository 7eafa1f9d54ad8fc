"""A trunk that splits: a plate on a trunk carries two, three or four columns, and a load lies on one column.

Theory: the trunk has the half width a. Plate and columns together have the mass M, and their centre of mass lies above
the trunk's middle. A load of mass p on the column at x = r tips the whole stack about the trunk's edge if p
(r - a) > M a.

The scene places the columns together, so that nothing tips before the scene places the load.

Look for: each column alone stands on the plate, with any load. Only the moments of all columns about the trunk's edge
show that the stack tips.
"""

from __future__ import annotations

import math
from typing import Annotated

from scenarios.margins import by_margin
from scenarios.model import World
from scenarios.parameters import Margin, Scale, Whole
from scenarios.planks import MU, box, one_a_second, plank_of
from scenarios.scenario import Plan, scenario

TRUNK = 6.0
"""Height of the trunk in thicknesses of a plank, which leaves room to tip."""
HALF_TRUNK, RADIUS, COLUMN, HALF_PLATE = 0.14, 0.34, 0.12, 0.45
"""Lengths over the length of a plank:

- HALF_TRUNK: half the trunk's edge;
- RADIUS: distance of the columns' centres from the trunk's axis;
- COLUMN: edge of a column;
- HALF_PLATE: half the plate's edge.
"""


@scenario
def branches(*, columns: Annotated[int, Whole(2, 4)] = 4, margin: Margin = 0.3, scale: Scale = 4.0) -> Plan:
    """Build a plate with columns on a trunk, then load one column.

    Args:
        columns: number of columns, 2, 3 or 4; two columns stand on a plank, more columns on a square plate.
        margin: share by which the load is lighter than the limit; negative if the load is heavier.
        scale: factor on all lengths, relative to the standard plank.
    """
    length, width, thickness, _ = plank_of(scale)
    edge, plate_edge, trunk_edge = COLUMN * length, 2 * HALF_PLATE * length, 2 * HALF_TRUNK * length
    is_planar = columns == 2
    trunk = box((trunk_edge, width if is_planar else trunk_edge, TRUNK * thickness), 0.0, level=1)
    plate = box((plate_edge, width if is_planar else plate_edge, thickness), 0.0, level=2, bottom=TRUNK * thickness)
    floor = (TRUNK + 1) * thickness
    turns = [2 * math.pi * index / columns for index in range(columns)]
    standing = [
        box(
            (edge, edge, edge),
            RADIUS * length * math.cos(turn),
            0.0 if is_planar else RADIUS * length * math.sin(turn),
            level=3,
            bottom=floor,
        )
        for turn in turns
    ]
    borne = plate.mass + sum(column.mass for column in standing)
    limit = borne * HALF_TRUNK / (RADIUS - HALF_TRUNK)
    load = box((edge, edge, thickness), RADIUS * length, level=4, bottom=floor + edge, mass=(1 - margin) * limit)
    return Plan(
        world=World(friction=MU),
        actions=one_a_second([[trunk], [plate], standing, [load]]),
        expectation=by_margin(
            margin, f"a load of {limit / borne:.2f} times the mass on the trunk, by moments about its edge", falls_at=4
        ),
        look_for="each column alone stands on the plate; all columns together tip about the trunk's edge",
        partner={"margin": abs(margin)},
        planar=is_planar,
    )
