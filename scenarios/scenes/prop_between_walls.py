"""A block on a prop, between two fixed walls that touch the block. Then the scene removes the prop.

Theory: friction at the walls carries no weight, because the walls touch the block without pressure. Without its prop
the block falls freely, at any coefficient of friction. In the partner scene the block then stands on two ledges, one at
each wall, below the block's ends.

Forces that hold the block do exist, because rigid walls may squeeze the block with any force. But nothing causes these
forces.

Look for: if a block stays between the walls, an engine or a rule assumes prestress that nothing supplies.
"""

from __future__ import annotations

from typing import Annotated

from scenarios.model import Action, Expectation, Place, Remove, Vector, World
from scenarios.parameters import Choice, Friction, Gap
from scenarios.planks import box
from scenarios.scenario import Plan, scenario

BLOCK: Vector = (0.12, 0.05, 0.04)
"""Edges of the block [m]."""
PROP: Vector = (0.08, 0.05, 0.12)
"""Edges of the prop [m]: wide enough to carry the block alone, with room to fall by three heights of the block."""
WALL: Vector = (0.04, 0.10, 0.20)
"""Edges of a wall [m]."""
LEDGE = 0.015
"""Length of a ledge along x [m], so that it ends 5 mm beside the prop."""
PAUSE_S = 2.0
"""Time from the block to the removal [s], in which the stack settles."""


@scenario
def prop_between_walls(
    *, carried: Annotated[str, Choice("ledges", "nothing")] = "ledges", friction: Friction = 0.2, gap: Gap = 0.0
) -> Plan:
    """Build a block on a prop, between two fixed walls that touch the block, then remove the prop.

    Args:
        carried: support of the block after the removal, "nothing" or "ledges".
        friction: Coulomb coefficient of every pair.
        gap: distance between the block and either wall [mm]; at 0 the walls touch the block.
    """
    inner = BLOCK[0] / 2 + gap * 1e-3
    fixed = [box(WALL, side * (inner + WALL[0] / 2), level=1) for side in (-1, 1)]
    if carried == "ledges":
        fixed += [box((LEDGE, BLOCK[1], PROP[2]), side * (inner - LEDGE / 2), level=1) for side in (-1, 1)]
    time = 1.0 + PAUSE_S
    actions: tuple[Action, ...] = (
        Place(0.0, (box(PROP, 0.0, level=1),)),
        Place(1.0, (box(BLOCK, 0.0, level=2, bottom=PROP[2]),)),
        Remove(time, 0),
    )
    if carried == "ledges":
        expectation = Expectation("stand", "both ends of the block lie on a ledge")
    else:
        expectation = Expectation("fall", "walls that touch the block without pressure hold nothing", 2, time)
    return Plan(
        world=World(friction=friction, fixed=tuple(fixed)),
        actions=actions,
        expectation=expectation,
        look_for="a block that stays between the walls is held by prestress that nothing supplies",
        partner={"carried": "ledges"},
        planar=True,
    )
