"""A tower, and a steady force on the topmost plank, along the plank's length.

Theory: friction with the coefficient mu holds the plank, of mass m, while the force is below mu m g. Under a larger
force the plank slides off, and drags the tower below with mu m g. Only the pressed plank moves, because the tower's own
friction exceeds this drag.

Look for: only the pressed plank may move. The plank must move as soon as the force exceeds its friction.
"""

from __future__ import annotations

from typing import Annotated

from scenarios.model import Action, Expectation, Press, World
from scenarios.parameters import Real, Whole
from scenarios.planks import GRAVITY, MASS, MU, lay, one_a_second
from scenarios.scenario import Plan, dynamic_scenario

PAUSE_S = 2.0
"""Time from the last plank to the press [s]."""
PRESS_S = 1.0
"""Duration of the press [s], long enough because at 1.5 times the limit a plank slides its thickness in 0.1 s."""
MIN_FACTOR = 1.2
"""Least ratio of the force to its limit, or of the limit to the force, at which the answer is known, because nearer the
limit planks creep in some engines."""


@dynamic_scenario
def pressed_plank(*, force: Annotated[float, Real(0.01, 10)] = 1.5, levels: Annotated[int, Whole(2, 100)] = 4) -> Plan:
    """Press the topmost plank of a tower steadily along its length.

    Args:
        force: ratio of the force to the greatest friction that holds the plank.
        levels: number of planks.
    """
    actions: tuple[Action, ...] = one_a_second([lay(0.0, level=level)] for level in range(1, levels + 1))
    time = actions[-1].time + PAUSE_S
    actions += (Press(time, levels - 1, (force * MU * MASS * GRAVITY, 0.0, 0.0), PRESS_S),)
    return Plan(
        world=World(friction=MU),
        actions=actions,
        expectation=_expected(force, levels, time),
        look_for="only the pressed plank may move, and only if the force exceeds its friction",
        partner={"force": 1.5},
        planar=True,
    )


def _expected(force: float, levels: int, time: float) -> Expectation:
    """Return the expectation for a press that begins at ``time`` [s]."""
    theory = f"the force is {force:g} mu m g"
    if force * MIN_FACTOR <= 1.0:
        return Expectation("stand", f"{theory}: friction holds the plank")
    if force >= MIN_FACTOR:
        return Expectation("fall", f"{theory}: the plank slides off", levels, not_before_s=time)
    return Expectation("study", f"{theory}: near the limit")
