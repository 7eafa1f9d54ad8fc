"""A column that fills the room between the ground and a fixed ceiling. Then the scene removes bricks of the column.

Theory: the ceiling touches the topmost brick and can only push this brick down. Without the bricks below, the topmost
brick falls freely. Without the topmost brick, the lower bricks stand as before, under less load.

The scene places the topmost brick on the column without a gap, because there is no room above the brick.

Look for: a contact above a brick is no support. A brick that stays under the ceiling hangs from the ceiling.
"""

from __future__ import annotations

from typing import Annotated

from scenarios.model import Action, Expectation, Place, Remove, Vector, World
from scenarios.parameters import Choice, Whole
from scenarios.planks import MU, box
from scenarios.scenario import Plan, scenario

BRICK: Vector = (0.06, 0.06, 0.04)
"""Edges of a brick [m]."""
CEILING: Vector = (0.16, 0.16, 0.03)
"""Edges of the ceiling [m]."""
PAUSE_S = 2.0
"""Time from the last brick to the removal [s], in which the stack settles."""


@scenario
def ceiling(
    *, bricks: Annotated[int, Whole(2, 20)] = 3, taken: Annotated[str, Choice("upper", "lower")] = "upper"
) -> Plan:
    """Build a column that fills the room between ground and ceiling, then remove bricks of the column.

    Args:
        bricks: number of bricks of the column.
        taken: bricks that the scene removes: "upper" for the topmost brick, "lower" for all bricks below the topmost
            brick.
    """
    column = [box(BRICK, 0.0, level=level, bottom=(level - 1) * BRICK[2]) for level in range(1, bricks + 1)]
    time = bricks - 1 + PAUSE_S
    actions: list[Action] = [Place(float(second), (brick,)) for second, brick in enumerate(column[:-1])]
    actions.append(Place(bricks - 1.0, (column[-1],), height=0.0))
    actions += [Remove(time, index) for index in ([bricks - 1] if taken == "upper" else range(bricks - 1))]
    if taken == "upper":
        expectation = Expectation("stand", "the remaining bricks stood before, under more load")
    else:
        expectation = Expectation("fall", "a ceiling can only push down", bricks, time)
    return Plan(
        world=World(friction=MU, fixed=(box(CEILING, 0.0, level=1, bottom=bricks * BRICK[2]),)),
        actions=tuple(actions),
        expectation=expectation,
        look_for="a contact above a brick is no support; a brick that stays under the ceiling hangs from it",
        partner={"taken": "upper"},
        planar=True,
    )
