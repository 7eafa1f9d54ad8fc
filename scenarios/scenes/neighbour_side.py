"""A brick that overhangs its pedestal and touches a heavy neighbour. Then the scene removes the brick's counterweight.

Theory: alone, the brick stands if its centre of mass is above the pedestal. The brick tips about the pedestal's edge if
the centre is beyond the edge. The margin is the distance of the centre from the edge, inward, over half the brick's
length.

The neighbour touches the brick's inner end, but cannot hold the brick. Take the edge as origin. The brick begins to
turn about the edge, by a small angle w. A point (-a, z) of its inner end moves by (w z, w a): up, and away from the
neighbour. Therefore the neighbour does not press on the brick, and without pressure there is no friction.

Coulomb forces that would hold the brick do exist: the brick and the pedestal could squeeze the neighbour. Friction at
the sides would then balance an overhang of up to mu^2 L / 2 (margin -0.2), with the coefficient of friction mu and the
brick's length L. These forces need prestress, and nothing supplies this prestress.

Look for: if a brick stays in the air without its counterweight, friction at an unloaded contact holds the brick.
"""

from __future__ import annotations

from typing import Annotated

from scenarios.margins import by_margin
from scenarios.model import Action, Place, Remove, World
from scenarios.parameters import Gap, Real, Scale
from scenarios.planks import MU, box, plank_of
from scenarios.scenario import Plan, scenario

PEDESTAL = 6.0
"""Height of the pedestal in thicknesses of a plank, which leaves room to tip."""
NEIGHBOUR, COUNTERWEIGHT = 10.0, 2.0
"""Masses of the neighbour and of the counterweight, over the mass of the brick."""
PIECE, INWARD = 0.3, 0.3
"""Lengths over the length of a plank:

- PIECE: length of the counterweight;
- INWARD: distance of the counterweight's middle from the brick's middle, inward.
"""
PAUSE_S = 2.0
"""Time from the last brick to the removal [s], in which the stack settles."""


@scenario
def neighbour_side(*, margin: Annotated[float, Real(-0.25, 0.25)] = 0.15, gap: Gap = 0.0, scale: Scale = 2.0) -> Plan:
    """Build a brick that overhangs its pedestal beside a heavy neighbour, then remove its counterweight.

    Args:
        margin: distance of the brick's middle inside the pedestal's edge, over half the brick's length; negative if the
            middle is outside.
        gap: distance between the brick and its neighbour [mm]; at 0 both touch.
        scale: factor on all lengths, relative to the standard plank.
    """
    length, width, thickness, mass = plank_of(scale)
    top, x = PEDESTAL * thickness, -margin * length / 2
    pedestal = box((2.2 * length, width, top), -1.1 * length, level=1)
    neighbour = box((length, width, thickness), x - length - gap * 1e-3, level=2, bottom=top, mass=NEIGHBOUR * mass)
    brick = box((length, width, thickness), x, level=2, bottom=top)
    counterweight = box(
        (PIECE * length, width, thickness),
        x - INWARD * length,
        level=3,
        bottom=top + thickness,
        mass=COUNTERWEIGHT * mass,
    )
    time = 2.0 + PAUSE_S
    actions: tuple[Action, ...] = (
        Place(0.0, (pedestal,)),
        Place(1.0, (neighbour,)),
        Place(2.0, (brick, counterweight)),
        Remove(time, 3),
    )
    limit = "the pedestal's edge, in half lengths of the brick; the neighbour does not help"
    return Plan(
        world=World(friction=MU),
        actions=actions,
        expectation=by_margin(margin, limit, falls_at=3, not_before_s=time),
        look_for="a brick that stays in the air is held by friction at an unloaded contact",
        partner={"margin": abs(margin)},
        planar=True,
    )
