"""A table: a plate on two, three or four legs, and a load beyond the legs.

Theory: the centre of mass of the plate, of mass m, lies at x = 0. The front legs reach to the line x = a. The load, of
mass p, lies at x = a + q. The table tips about the line x = a if the moment of the load exceeds the moment of the
plate: p q > m a. With two legs the table is a beam in the x-z plane. With three legs, two legs stand on the load's
side.

Look for: the rear legs lift off while the front legs take the whole load. If an engine shares the load wrongly, for
instance a third to each leg, no leg lifts off, and nothing falls.
"""

from __future__ import annotations

from typing import Annotated

from scenarios.margins import by_margin
from scenarios.model import Brick, World
from scenarios.parameters import Margin, Scale, Whole
from scenarios.planks import MU, box, one_a_second, plank_of
from scenarios.scenario import Plan, scenario

HEIGHT = 3.0
"""Height of the legs in thicknesses of a plank, which leaves room to tip, but too little room for a leg to fall
over."""
FOOT = 0.2
"""Edge of a leg's square foot, in lengths of the plate; with two legs, the foot's edge along x."""
REACH = 0.22
"""Distance a along x from the plate's middle to the outer faces of the foremost legs, in lengths of the plate."""
ARM = 0.2
"""Distance q along x from the outer faces of the foremost legs to the load's middle, in lengths of the plate."""
LIMIT = REACH / ARM
"""Ratio of the mass of a load that balances the plate to the plate's mass."""
_FRONT, _BACK, _ASIDE = REACH - FOOT / 2, -0.3, 0.3
LEGS = {
    2: ((_FRONT, 0.0), (_BACK, 0.0)),
    3: ((_FRONT, _ASIDE), (_FRONT, -_ASIDE), (_BACK, 0.0)),
    4: ((_FRONT, _ASIDE), (_FRONT, -_ASIDE), (_BACK, _ASIDE), (_BACK, -_ASIDE)),
}
"""Middles of the legs in x and y, in lengths of the plate, by the number of legs."""


@scenario
def table(*, legs: Annotated[int, Whole(2, 4)] = 4, margin: Margin = 0.3, scale: Scale = 2.5) -> Plan:
    """Build a plate on legs, and a load that lies beyond the legs.

    Args:
        legs: number of legs, 2, 3 or 4. Two legs carry a plank, three and four legs carry a square plate.
        margin: share by which the load is lighter than the limit; negative if the load is heavier.
        scale: factor on all lengths, relative to the standard plank.
    """
    length, width, thickness, _ = plank_of(scale)
    height, foot, depth = HEIGHT * thickness, FOOT * length, width if legs == 2 else length
    standing = [
        box((foot, width if legs == 2 else foot, height), x * length, y * length, level=1) for x, y in LEGS[legs]
    ]
    plate = box((length, depth, thickness), 0.0, level=2, bottom=height)
    load: Brick = box(
        (foot, width, thickness),
        (REACH + ARM) * length,
        level=3,
        bottom=height + thickness,
        mass=(1 - margin) * LIMIT * plate.mass,
    )
    return Plan(
        world=World(friction=MU),
        actions=one_a_second([*([leg] for leg in standing), [plate], [load]]),
        expectation=by_margin(margin, f"a load of {LIMIT:.1f} times the plate beyond its legs", falls_at=3),
        look_for="the rear legs lose all load before the table tips about the front legs",
        partner={"margin": abs(margin)},
        planar=legs == 2,
    )
