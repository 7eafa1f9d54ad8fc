"""A row of dominoes, and a striker that pushes the first domino beyond the limit of balance, or less far.

Theory, for a domino of height h and thickness b, and a striker on a shelf of height s:

- The striker is higher than a domino, and therefore pushes the domino's upper rear edge.
- A domino that leans forward by the angle p has turned about its lower front edge. Its upper rear edge has moved by
  d(p) = h sin(p) + b (1 - cos(p)).
- The domino's centre passes over the front edge at p = atan(b / h). The domino falls if the striker moves the upper
  rear edge by more than d(atan(b / h)). If the striker stops before this distance, the domino stands up again.
- The domino tips before it slides, because the push that tips the domino is b / (2 s) = 0.14 of the weight, less than
  the friction of 0.45.
- The domino's speed does not matter, because the striker is slow.
- A falling domino topples the whole row, because the gap between neighbours is less than h.

Look for: in a row that falls, each domino must topple the next domino. A rule that freezes a domino while its neighbour
falls stops the row.
"""

from __future__ import annotations

import math
from typing import Annotated

from scenarios.margins import by_margin
from scenarios.model import Action, Place, Pull, World
from scenarios.parameters import Margin, Whole
from scenarios.planks import MU, box
from scenarios.scenario import Plan, dynamic_scenario

SIZE = (0.03, 0.06, 0.12)
"""Edges of a domino [m]: thickness, width and height."""
PITCH = 0.09
"""Distance [m] between the middles of neighbours, which leaves half a height between them."""
STRIKER = (0.16, 0.06, 0.04)
"""Edges of the striker [m]. The striker is so long that friction does not tip it while the manipulator pulls its
centre, and that its centre stays over the shelf."""
SHELF = (0.2, 0.06, 0.11)
"""Edges of the shelf [m]: it ends 1 cm below the top of a domino, so that the striker pushes high."""
CLEAR = 0.01
"""Gap [m] between the shelf and the first domino."""
APART = 0.002
"""Gap [m] between the striker and the first domino."""
SPEED = 0.02
"""Speed of the striker [m/s]: the first domino turns by about 10 deg/s, with 0.1 % of the energy that tips it."""
BEGINS_S = 2.0
"""Start of the push [s]."""


@dynamic_scenario
def dominoes(*, count: Annotated[int, Whole(1, 100)] = 5, margin: Margin = 0.5) -> Plan:
    """Build a row of standing dominoes, and push the first domino.

    Args:
        count: number of dominoes.
        margin: share by which the striker stops before the limit; negative if the striker stops beyond the limit.
    """
    thickness, _, height = SIZE
    lean = math.atan(thickness / height)
    limit = height * math.sin(lean) + thickness * (1 - math.cos(lean))
    row = [box(SIZE, index * PITCH, level=1) for index in range(count)]
    striker = box(STRIKER, -(thickness + STRIKER[0]) / 2 - APART, level=1, bottom=SHELF[2])
    shelf = box(SHELF, -(thickness + SHELF[0]) / 2 - CLEAR, level=1)
    push = Pull(BEGINS_S, count, (SPEED, 0.0), (APART + (1 - margin) * limit) / SPEED)
    actions: tuple[Action, ...] = (Place(0.0, (*row, striker)), push)
    return Plan(
        world=World(friction=MU, fixed=(shelf,)),
        actions=actions,
        expectation=by_margin(
            margin, f"{limit * 1e3:.1f} mm, where a domino's centre is over its edge", falls_at=1, not_before_s=BEGINS_S
        ),
        look_for="a falling domino that does not topple the next one",
        partner={"margin": abs(margin)},
        planar=True,
        watch_s=8.0,
    )
