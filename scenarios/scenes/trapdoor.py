"""Planks across a table and a trapdoor. Then the door drops away below the planks.

Theory: the door drops faster than in free fall, so that it neither pulls nor pushes the planks. Then only the table
carries the planks. The planks stand if their centre of mass is above the table.

Look for: a frozen stack on a door must react when the door opens. A stack that does not need the door must stay.
"""

from __future__ import annotations

from typing import Annotated

from scenarios.model import Action, Brick, Drive, Expectation, Place, World
from scenarios.parameters import Real, Whole
from scenarios.planks import LENGTH, MU, THICKNESS, WIDTH, lay
from scenarios.scenario import Plan, dynamic_scenario

TOP = 0.15
"""Height [m] of the table and of the closed door."""
DOOR = (0.1, 3 * WIDTH, 0.01)
"""Edges of the door [m]."""
SLIT = 2e-3
"""Gap between table and door [m]."""
DROP_M_S, DROP_S = 2.0, 0.06
"""Motion of the dropping door:

- DROP_M_S: speed [m/s];
- DROP_S: duration [s].
"""
PAUSE_S = 2.0
"""Time from the last plank to the drop [s]."""
MIN_DISTANCE = 4.0
"""Least distance [mm] of the planks' centres from the table's edge at which the answer is known, because a dropped
plank, or an edge that yields, may shift by tenths of a millimetre."""


@dynamic_scenario
def trapdoor(
    *, beyond: Annotated[float, Real(-40.0, 40.0, "mm")] = 10.0, levels: Annotated[int, Whole(1, 10)] = 3
) -> Plan:
    """Build planks across a table and a trapdoor, then drop the door.

    Args:
        beyond: distance [mm] of the planks' centres beyond the table's edge; negative if the centres are above the
            table.
        levels: number of planks.
    """
    table = Brick((2 * LENGTH, 3 * WIDTH, TOP), 1.0, (-LENGTH, 0.0, TOP / 2))
    length, _, thickness = DOOR
    door = Brick(DOOR, 1.0, (SLIT + length / 2, 0.0, TOP - thickness / 2), moved=True)
    actions: list[Action] = [Place(0.0, (door,), height=TOP - thickness)]
    for index in range(levels):
        plank = lay(beyond * 1e-3, level=index + 2, bottom=TOP + index * THICKNESS)
        actions.append(Place(1.0 + index, (plank,)))
    time = actions[-1].time + PAUSE_S
    actions += [Drive(time, 0, (0.0, 0.0, -DROP_M_S)), Drive(time + DROP_S, 0, (0.0, 0.0, 0.0))]
    return Plan(
        world=World(friction=MU, fixed=(table,)),
        actions=tuple(actions),
        expectation=_expected(beyond, levels, time),
        look_for="when the door drops, planks whose centre is beyond the table tip, and other planks stay",
        partner={"beyond": abs(beyond)},
        planar=True,
    )


def _expected(beyond: float, levels: int, time: float) -> Expectation:
    """Return the expectation for planks ``beyond`` [mm] the table's edge, and a door that drops at ``time`` [s]."""
    theory = f"without the door the centres lie {abs(beyond):g} mm"
    if beyond <= -MIN_DISTANCE:
        return Expectation("stand", f"{theory} inside the table's edge")
    if beyond >= MIN_DISTANCE:
        return Expectation("fall", f"{theory} beyond the table's edge", levels + 1, not_before_s=time)
    return Expectation("study", f"{theory} from the table's edge")
