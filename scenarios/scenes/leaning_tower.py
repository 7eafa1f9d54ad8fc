"""The paper's leaning tower: flat planks, each with the same offset d along x from the plank below.

Theory, for n planks of length L: the centre of mass of the n - 1 upper planks lies n d / 2 from the middle of the
lowest plank. The edge of the lowest plank lies L / 2 from this middle. Therefore the tower falls if n d > L. Upper
parts are safer, because they have fewer planks. At exactly n d = L the tower balances on the edge. Within 5 % of this
limit the scene has no known answer, because the energy of placing a plank decides. The default ratio L / d = 8.5 lies
half-way between two limits. With eight planks the centre of mass lies 3.4 mm inside the edge, and with nine planks 3.4
mm beyond the edge.

Look for: a real tower turns about the edge of its lowest plank and stays whole until it strikes the ground. A tower
that stands at ten levels is a false stand. A tower that falls early has slid or sunk.
"""

from __future__ import annotations

import math
from typing import Annotated

from scenarios.model import Expectation, World
from scenarios.parameters import Real, Scale, Whole
from scenarios.planks import MU, box, one_a_second, plank_of
from scenarios.scenario import Plan, scenario

MIN_MARGIN = 0.05
"""Least distance from the limit, as a share of half a plank's length, at which the answer holds under placement
noise."""


@scenario
def leaning_tower(
    *, ratio: Annotated[float, Real(1.1, 1000)] = 8.5, levels: Annotated[int, Whole(1, 500)] = 13, scale: Scale = 1.0
) -> Plan:
    """Build a tower of flat planks, each with the same offset along x from the plank below.

    Args:
        ratio: a plank's length over the offset; below 2 a plank falls off the plank below.
        levels: number of planks.
        scale: factor on all lengths, relative to the standard plank.
    """
    length, width, thickness, mass = plank_of(scale)
    planks = [
        box((length, width, thickness), above * length / ratio, level=above + 1, bottom=above * thickness, mass=mass)
        for above in range(levels)
    ]
    return Plan(
        world=World(friction=MU),
        actions=one_a_second([plank] for plank in planks),
        expectation=expected(ratio, levels),
        look_for="the tower turns about its lowest plank's edge in one piece; longer standing is a false stand",
        partner={"levels": 13},
        planar=True,
    )


def expected(ratio: float, levels: int) -> Expectation:
    """Return the expectation for ``levels`` planks, each with an offset of its length over ``ratio``."""
    fall = math.floor(ratio) + 1  # the first n with n d > L
    last = min(fall - 1, levels)  # the highest tower that must stand
    room_before, overhang = 1 - last / ratio, fall / ratio - 1
    if room_before < MIN_MARGIN or (fall <= levels and overhang < MIN_MARGIN):
        return Expectation("study", f"n d = L within {MIN_MARGIN:.0%}: placement errors decide")
    if fall > levels:
        return Expectation(
            "stand", f"n d < L for all n up to {levels}: the centre of mass stays inside the lowest edge"
        )
    return Expectation("fall", f"n d > L first at n = {fall}: the centre of mass passes the lowest edge", fall)
