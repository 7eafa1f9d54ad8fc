"""Bricks poured into a pile one by one, each turned at random, as in Hsu and Keyser, "Piles of Objects", 2010.

Theory gives no outcome, because dynamics decide where a brick comes to rest. Metrics:

- the time until the pile is at rest;
- the sinking and the creep of the pile at rest;
- the time of a frame, and the number of bricks awake;
- the height and the slope of the pile. Friction alone, with the coefficient mu, holds a slope of atan(mu), and
  interlocked bricks hold a steeper slope. Therefore a flatter pile shows that bricks have slipped.

Look for: the pile should come to rest, and a landing brick should wake only the bricks that it moves.
"""

from __future__ import annotations

import random
from typing import Annotated

from scenarios.model import CLEARANCE, Expectation, Place, World
from scenarios.parameters import Friction, Real, Whole
from scenarios.planks import LENGTH, MU
from scenarios.scenario import Plan, dynamic_scenario
from scenarios.scenes.shared.pouring import PACE_S, SIZE, poured_bricks

SPREAD = LENGTH / 4
"""Standard deviation [m] of the release position, in x and in y: about as wide as a brick is long."""
WATCH_S = 10.0
"""Duration of the trial after the last brick [s]."""


@dynamic_scenario
def poured_pile(
    *,
    bricks: Annotated[int, Whole(2, 1000)] = 80,
    height: Annotated[float, Real(0.5, 1000, "mm")] = 30.0,
    friction: Friction = MU,
    draw: Annotated[int, Whole(0, 10**9)] = 1,
    line: Annotated[float, Real(0, 50)] = 0.0,
    pace: Annotated[float, Real(0.5, 30)] = 1 / PACE_S,
) -> Plan:
    """Pour bricks into a pile, one by one, each turned at random.

    The harness measures the angle of repose of a cone. A pile along a line is no cone.

    Args:
        bricks: number of bricks.
        height: release height [mm] above the pile.
        friction: Coulomb coefficient of every pair.
        draw: number from which all random poses follow; each number gives another pile.
        line: length of the line along x over which the scene releases the bricks, over a brick's longest edge; 0 for a
            single place.
        pace: number of bricks that the scene releases each second.
    """
    reach = line * max(SIZE) / 2

    def release(generator: random.Random) -> tuple[float, float]:
        """Draw the place (x, y) [m] of a brick."""
        x, y = generator.gauss(0.0, SPREAD), generator.gauss(0.0, SPREAD)
        return x + generator.uniform(-reach, reach) if line else x, y

    poured = poured_bricks(bricks, random.Random(draw), release)
    return Plan(
        world=World(friction=friction),
        actions=tuple(Place(number / pace, (brick,), CLEARANCE + height * 1e-3) for number, brick in enumerate(poured)),
        expectation=Expectation("study", "dynamics decide where a poured brick comes to rest"),
        look_for="whether the pile comes to rest, and whether a landing brick wakes only the bricks that it moves",
        watch_s=WATCH_S,
        poured=True,
    )
