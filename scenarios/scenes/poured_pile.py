"""Bricks poured into a pile one by one, each turned at random, as in Hsu and Keyser, "Piles of Objects", 2010.

Theory: none, because dynamics decide where a brick comes to rest. Metrics:

- the time until the pile is at rest;
- the sinking and the creep of the pile at rest;
- the time of a frame, and the number of bricks awake;
- the height and the slope of the pile. Friction alone holds a slope of atan(mu), and bricks also interlock, so a
  flatter pile shows that bricks have slipped.

The planned height of each brick assumes that every brick stays where it first touches the pile.

Look for: whether the pile comes to rest, and whether a landing brick wakes only the bricks that it moves.
"""

from __future__ import annotations

import math
import random
from dataclasses import replace
from typing import Annotated

from scenarios.geometry import Boxes, resting_shift
from scenarios.model import CLEARANCE, Brick, Expectation, Place, Quaternion, World
from scenarios.parameters import Friction, Real, Whole
from scenarios.planks import DENSITY, LENGTH, MU, THICKNESS, WIDTH
from scenarios.scenario import Plan, dynamic_scenario

SIZE = (LENGTH / 3, WIDTH, 2 * THICKNESS)
"""Edges of a brick [m], 5 : 3 : 2: a third of a plank, twice as thick."""
PACE_S = 0.25
"""Time between two bricks [s], so that a brick has time to fall and tumble, and the pile has no time to sleep."""
SPREAD = LENGTH / 4
"""Standard deviation [m] of the release position, in x and in y: about as wide as a brick is long."""
WATCH_S = 10.0
"""Duration of the trial after the last brick [s]."""


@dynamic_scenario
def poured_pile(
    *,
    bricks: Annotated[int, Whole(2, 1000)] = 80,
    height: Annotated[float, Real(0.5, 1000)] = 30.0,
    friction: Friction = MU,
    draw: Annotated[int, Whole(0, 10**9)] = 1,
) -> Plan:
    """Pour bricks into a pile, one by one, each turned at random.

    Args:
        bricks: number of bricks.
        height: release height [mm] above the pile.
        friction: Coulomb coefficient of every pair.
        draw: number from which all random poses follow; each number gives another pile.
    """
    poured = _poured(bricks, random.Random(draw))
    return Plan(
        world=World(friction=friction),
        actions=tuple(
            Place(PACE_S * number, (brick,), CLEARANCE + height * 1e-3) for number, brick in enumerate(poured)
        ),
        expectation=Expectation("study", "dynamics decide where a poured brick comes to rest"),
        look_for="whether the pile comes to rest, and whether a landing brick wakes only the bricks that it moves",
        watch_s=WATCH_S,
        poured=True,
    )


def _poured(count: int, generator: random.Random) -> list[Brick]:
    """Return bricks in random poses near the z axis, each at the height of its first contact.

    A brick sinks straight down, without turning, until it touches an earlier brick or the ground.
    """
    bricks: list[Brick] = []
    for level in range(1, count + 1):
        x, y = generator.gauss(0.0, SPREAD), generator.gauss(0.0, SPREAD)
        brick = Brick(SIZE, math.prod(SIZE) * DENSITY, (x, y, 0.0), _random_turn(generator), level)
        z = resting_shift(Boxes.of([brick]), Boxes.of(bricks)) - CLEARANCE
        bricks.append(replace(brick, position=(x, y, z)))
    return bricks


def _random_turn(generator: random.Random) -> Quaternion:
    """Return a random rotation; all rotations are equally likely.

    The method is from Shoemake, "Uniform Random Rotations", Graphics Gems III, 1992.
    """
    share, first, second = generator.random(), *(2 * math.pi * generator.random() for _ in range(2))
    low, high = math.sqrt(1 - share), math.sqrt(share)
    return (high * math.cos(second), low * math.sin(first), low * math.cos(first), high * math.sin(second))
