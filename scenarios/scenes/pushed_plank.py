"""A tower, and a blow on the topmost plank, along the plank's length.

Theory: an impulse J gives a plank of mass m the speed J / m. Friction with the coefficient mu stops the plank after the
distance s = (J / m)^2 / (2 mu g), and drags the tower below with at most mu m g. Only the struck plank moves, because
the tower's own friction exceeds this drag. The plank counts as out of place once it has moved by its thickness:

- s of half a thickness: the stack stands;
- s well above a thickness: the plank has slid;
- s above half the plank's length: the plank falls off.

Look for: only the struck plank may move. A frozen stack must react to the blow, because the host reports the struck
brick to the extension.
"""

from __future__ import annotations

import math
from typing import Annotated

from scenarios.model import Action, Expectation, Push, World
from scenarios.parameters import Real, Whole
from scenarios.planks import GRAVITY, LENGTH, MASS, MU, THICKNESS, lay, one_a_second
from scenarios.scenario import Plan, dynamic_scenario

PAUSE_S = 2.0
"""Time from the last plank to the blow [s]."""
MIN_FACTOR = 1.5
"""Least ratio between the slide and the distance at which the outcome changes (a thickness or half a length) at which
the answer is known, because engines apply friction in steps, and a real plank yaws a little."""


@dynamic_scenario
def pushed_plank(
    *, slide: Annotated[float, Real(0.1, 1000, "mm")] = 4.0, levels: Annotated[int, Whole(2, 100)] = 4
) -> Plan:
    """Strike the topmost plank of a tower along its length.

    Args:
        slide: planned slide [mm].
        levels: number of planks.
    """
    actions: tuple[Action, ...] = one_a_second([lay(0.0, level=level)] for level in range(1, levels + 1))
    time = actions[-1].time + PAUSE_S
    impulse = MASS * math.sqrt(2 * MU * GRAVITY * slide * 1e-3)
    actions += (Push(time, levels - 1, (impulse, 0.0, 0.0)),)
    return Plan(
        world=World(friction=MU),
        actions=actions,
        expectation=_expected(slide * 1e-3, levels, time),
        look_for="only the struck plank may move; a frozen plank must react to the blow",
        partner={"slide": 4.0},
        planar=True,
    )


def _expected(slide: float, levels: int, time: float) -> Expectation:
    """Return the expectation for a plank that slides by ``slide`` [m]."""
    way = f"the plank slides {slide * 1e3:g} mm = (J / m)^2 / (2 mu g)"
    if slide * MIN_FACTOR <= THICKNESS:
        return Expectation("stand", f"{way}, less than its thickness")
    if slide >= MIN_FACTOR * THICKNESS and not LENGTH / 2 / MIN_FACTOR < slide < MIN_FACTOR * LENGTH / 2:
        return Expectation("fall", f"{way}, more than its thickness", levels, not_before_s=time)
    return Expectation("study", f"{way}, near a thickness or near half its length")
