"""The harmonic overhang: planks at a table's edge, each with the greatest possible overhang beyond the plank below.

Theory: the k-th plank from the top, of length L, may reach L / (2 k) beyond the plank below. For the lowest plank, the
table is the body below. Then, for every k, the centre of mass of the upper k planks lies just above the edge that
carries these planks. If all offsets are smaller by a share s, the centre lies s L / 2 inside every edge. If all offsets
are larger by a share s, the centre lies s L / 2 outside every edge. Before the last placement, the planks are farther
from their limits.

Look for: the planks tip together or not at all, because all joints reach their limit at once. The topmost plank reaches
out by L (1 + 1/2 + 1/3 ...) / 2. A tower that settles by some tenths of a millimetre leans outward, and falls early.
"""

from __future__ import annotations

from typing import Annotated

from scenarios.margins import by_margin
from scenarios.model import World
from scenarios.parameters import Margin, Scale, Whole
from scenarios.planks import MU, box, one_a_second, plank_of
from scenarios.scenario import Plan, scenario

TABLE = 6.0
"""Height of the table in thicknesses of a plank, which leaves room to tip."""


@scenario
def harmonic_overhang(*, bricks: Annotated[int, Whole(2, 50)] = 5, margin: Margin = 0.15, scale: Scale = 1.0) -> Plan:
    """Build a stack of planks at a table's edge, each beyond the plank below by a harmonic offset.

    Args:
        bricks: number of planks, without the table.
        margin: share by which the offsets are smaller than the limit; negative if the offsets are larger.
        scale: factor on all lengths, relative to the standard plank.
    """
    length, width, thickness, _ = plank_of(scale)
    tower = [box((length, width, TABLE * thickness), 0.0, level=1)]
    x = 0.0
    for level in range(2, bricks + 2):
        from_top = bricks + 2 - level
        x += (1 - margin) * length / (2 * from_top)
        tower.append(box((length, width, thickness), x, level=level, bottom=(TABLE + level - 2) * thickness))
    return Plan(
        world=World(friction=MU),
        actions=one_a_second([brick] for brick in tower),
        expectation=by_margin(margin, "offsets of L / (2 k), k planks from the top", falls_at=bricks + 1),
        look_for="all joints give way at once, so the planks tip together; a tower that settles unevenly falls early",
        partner={"margin": abs(margin)},
        planar=True,
    )
