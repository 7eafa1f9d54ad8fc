"""A trunk that splits: a plate on one trunk carries two, three or four columns, and one of them is loaded.

Theory: plate and columns together (mass M) have their centre of mass above the trunk's middle, whose half width is a.
A load p on the column that stands on the x axis, at r, tips all of it about the trunk's edge once p (r - a) > M a.

What to look for: each branch alone stands on its plate, whatever its load; only all branches together, seen from the
trunk, tell that it tips. The columns come together, so that nothing tips before.
"""

from __future__ import annotations

import math

from scenarios.margins import by_margin, signed_margin
from scenarios.model import Scene, World
from scenarios.parameters import Value, real, variant_of, whole
from scenarios.planks import MU, box, one_a_second, plank_of

TRUNK = 6.0
"""Height of the trunk in thicknesses of a plank: room to tip."""
HALF_TRUNK, RADIUS, COLUMN, HALF_PLATE = 0.14, 0.34, 0.12, 0.45
"""Half the trunk's edge, where the columns stand, their edge, and half the plate's edge, in lengths of a plank."""


def branches(*, columns: int = 4, margin: float = 0.3, scale: float = 4.0) -> Scene:
    """A plate on one trunk with columns around it, one of which is loaded.

    Args:
        columns: 2, 3 or 4; two stand on a plank, more on a square plate.
        margin: share by which the load is lighter than the limit; a negative one is heavier.
        scale: size of everything over that of the standard plank.
    """
    columns = whole("columns", columns, least=2, most=4)
    margin = signed_margin(margin)
    scale = real("scale", scale, least=0.1, most=100)
    parameters: dict[str, Value] = {"columns": columns, "margin": margin, "scale": scale}
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
    return Scene(
        scenario="branches",
        variant=variant_of(branches, parameters),
        parameters=parameters,
        world=World(friction=MU),
        actions=one_a_second([[trunk], [plate], standing, [load]]),
        expectation=by_margin(
            margin, f"a load of {limit / borne:.2f} times all that stands on the trunk, about its edge", falls_at=4
        ),
        look_for="each branch stands by itself; only all of them, seen from the trunk, tip",
        pair=variant_of(branches, parameters | {"margin": abs(margin)}),
        planar=is_planar,
    )
