"""A column of cubes on a conveyor belt that starts and stops.

Theory: the belt accelerates at a, and carries a column of n cubes with edge b and total mass m. In the belt's frame two
forces act on the column:

- the inertial force m a, backward, at the height n b / 2 of the column's middle;
- the weight m g, at the distance b / 2 from the column's rear edge.

Therefore the column tips if a > g / n. The column does not slide while a < mu g, with the coefficient of friction mu.
At half of g / n the belt carries the column along. At one and a half times g / n the column tips if the acceleration
moves the centre of mass beyond the edge before the acceleration ends.

Look for: a frozen column must travel with the belt, and must tip at the same acceleration as a column that is awake.
"""

from __future__ import annotations

from typing import Annotated

from scenarios.model import Action, Brick, Drive, Expectation, Place, World
from scenarios.parameters import Real, Whole
from scenarios.planks import DENSITY, GRAVITY, MU
from scenarios.scenario import Plan, dynamic_scenario

EDGE = 0.04
"""Edge of a cube [m]."""
BELT = (2.4, 0.2, 0.02)
"""Edges of the belt [m]. The belt is longer than the path of the column."""
BOTTOM = 0.01
"""Height of the belt's lower face [m], above the ground."""
PAUSE_S = 2.0
"""Time from the last cube to the start of the belt [s]."""
START_S = 0.5
"""Time for which the belt accelerates, and then decelerates [s]: three times as long as four cubes take to tip at one
and a half times the limit."""
MIN_FACTOR = 1.4
"""Least ratio of the acceleration to its limit, or of the limit to the acceleration, at which the answer is known."""


@dynamic_scenario
def belt_tower(*, start: Annotated[float, Real(0.1, 3.0)] = 1.5, levels: Annotated[int, Whole(3, 10)] = 4) -> Plan:
    """Build a column of cubes on a conveyor belt that starts and stops.

    Args:
        start: ratio of the belt's acceleration to g / n, the acceleration at which the column tips.
        levels: number of cubes.
    """
    belt = Brick(BELT, 1.0, (0.0, 0.0, BOTTOM + BELT[2] / 2), moved=True)
    top = BOTTOM + BELT[2]
    actions: list[Action] = [Place(0.0, (belt,), height=BOTTOM)]
    mass = DENSITY * EDGE**3
    for index in range(levels):
        cube = Brick((EDGE, EDGE, EDGE), mass, (0.0, 0.0, top + (index + 0.5) * EDGE), level=index + 2)
        actions.append(Place(1.0 + index, (cube,)))
    time = actions[-1].time + PAUSE_S
    acceleration = start * GRAVITY / levels
    actions += [
        Drive(time, 0, (acceleration * START_S, 0.0, 0.0), seconds=START_S, carries=True),
        Drive(time + START_S, 0, (0.0, 0.0, 0.0), seconds=START_S, carries=True),
    ]
    return Plan(
        world=World(friction=MU),
        actions=tuple(actions),
        expectation=_expected(start, levels, time),
        look_for="the column travels with the belt; if the belt starts too fast, the column tips backwards",
        partner={"start": 1.5},
        planar=True,
    )


def _expected(start: float, levels: int, time: float) -> Expectation:
    """Return the expectation for a column whose belt starts at ``time`` [s]."""
    theory = f"the belt starts at {start:g} g / n = {start / levels:.3g} g"
    if start * MIN_FACTOR <= 1.0:
        return Expectation("stand", f"{theory}, too slowly to tip {levels} cubes")
    if start >= MIN_FACTOR and start / levels < MU / 1.1:
        return Expectation("fall", f"{theory}: the column tips", levels + 1, not_before_s=time)
    return Expectation("study", f"{theory}: near the limit, or so fast that the column slides")
