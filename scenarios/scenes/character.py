"""A plank on a pedestal and a prop, with a moving character; the scene removes the prop, then the character.

Theory: moments about the pedestal's edge decide. Without the prop, the plank stands because the character's weight acts
on the plank's inner end. Without the character, the plank stands if its own centre of mass is above the pedestal, and
tips if the centre is beyond the edge. The margin is the distance of the centre from the edge, inward, over half the
plank's length.

The character is a block that moves again and again, like a player's figure in a game. The scene pushes the block eight
times a second, alternately to the left and to the right. Each push gives the block a speed v of 0.05 m/s. Friction with
the coefficient mu stops the block after v^2 / (2 mu g) = 0.28 mm.

Look for: a stability extension must judge the stack again when the character leaves.
"""

from __future__ import annotations

from scenarios.margins import by_margin
from scenarios.model import Action, Place, Push, Remove, World
from scenarios.parameters import Margin, Scale
from scenarios.planks import MU, box, plank_of
from scenarios.scenario import Plan, dynamic_scenario

PEDESTAL = 6.0
"""Height of pedestal and prop in thicknesses of a plank, which leaves room to tip."""
PROP = 0.1
"""Length of the prop, in lengths of the plank."""
CHARACTER, FIGURE = 2.0, 0.15
"""Ratios of the character to the plank:

- CHARACTER: its mass over the plank's mass, which is 0.19 kg for the character at twice the standard size;
- FIGURE: its edges over the plank's length.
"""
STEP_S, SPEED = 0.125, 0.05
"""Movements of the character:

- STEP_S: time between two movements [s];
- SPEED: initial speed of each movement [m/s].
"""
ALONE_S, WITHOUT_PROP_S = 3.0, 3.0
"""Times [s] of the removals:

- ALONE_S: from the start of the movements to the removal of the prop;
- WITHOUT_PROP_S: from the removal of the prop to the removal of the character.
"""


@dynamic_scenario
def character(*, margin: Margin = 0.3, scale: Scale = 2.0) -> Plan:
    """Build a plank on a pedestal and a prop, with a moving character; remove the prop, then the character.

    Args:
        margin: distance of the plank's middle inside the pedestal's edge, over half the plank's length; negative if the
            middle is outside.
        scale: factor on all lengths, relative to the standard plank.
    """
    length, width, thickness, mass = plank_of(scale)
    top, x, edge = PEDESTAL * thickness, -margin * length / 2, FIGURE * length
    pedestal = box((1.2 * length, width, top), -0.6 * length, level=1)
    prop = box((PROP * length, width, top), x + (1 - PROP) * length / 2, level=1)
    plank = box((length, width, thickness), x, level=2, bottom=top)
    figure = box((edge, edge, edge), x - (length - edge) / 2, level=3, bottom=top + thickness, mass=CHARACTER * mass)
    prop_goes = 2.0 + ALONE_S
    leaves = prop_goes + WITHOUT_PROP_S
    actions: list[Action] = [Place(0.0, (pedestal, prop)), Place(1.0, (plank,)), Place(2.0, (figure,))]
    actions += [Remove(prop_goes, 1), Remove(leaves, 3)]
    actions += _movements(3, CHARACTER * mass * SPEED, 3.0, leaves)
    return Plan(
        world=World(friction=MU),
        actions=tuple(sorted(actions, key=lambda action: action.time)),
        expectation=by_margin(
            margin, "the pedestal's edge, in half lengths of the plank", falls_at=3, not_before_s=leaves
        ),
        look_for="a stack that stood with the character's help must be judged again when the character leaves",
        partner={"margin": abs(margin)},
        planar=True,
    )


def _movements(brick: int, impulse: float, start: float, end: float) -> list[Push]:
    """Return pushes of a brick along x by ``impulse`` [N s], alternating in sign, between ``start`` and ``end`` [s]."""
    count = round((end - start) / STEP_S) // 2 * 2  # an even number: as many to the left as to the right
    return [
        Push(start + number * STEP_S, brick, (impulse if number % 2 else -impulse, 0.0, 0.0)) for number in range(count)
    ]
