"""Bricks poured into a heap one by one, each turned at random, as in Hsu and Keyser, "Piles of Objects", 2010.

Theory: none that tells where a brick comes to rest; dynamics decide. What is measured: how long until the heap is at
rest, how far it then sinks and creeps, what a frame costs and how many bricks it moves, how high the heap grows and how
steep. Its slope is at least what friction alone holds, atan(mu), for bricks also interlock; a heap that flows flat
slips.

Planned heights are those of a heap in which each brick stays where it first touches.

What to look for: does it come to rest at all, and does a brick that lands wake what it moves, and only that?
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
"""From one brick to the next [s]: time to fall and tumble, too little to let the heap sleep in between."""
SPREAD = LENGTH / 4
"""Standard deviation [m] of where bricks are let go, in x and in y: about as wide as a brick is long."""
WATCH_S = 10.0
"""How long the heap is watched after the last brick [s]."""


@dynamic_scenario
def poured_pile(
    *,
    bricks: Annotated[int, Whole(2, 1000)] = 80,
    height: Annotated[float, Real(0.5, 1000)] = 30.0,
    friction: Friction = MU,
    draw: Annotated[int, Whole(0, 10**9)] = 1,
) -> Plan:
    """Bricks that are poured into a heap, one by one, each turned at random.

    Args:
        bricks: how many.
        height: from how high [mm] above the heap each is let go.
        friction: Coulomb coefficient of every pair.
        draw: which pile: all poses follow from this number alone.
    """
    poured = _poured(bricks, random.Random(draw))
    return Plan(
        world=World(friction=friction),
        actions=tuple(
            Place(PACE_S * number, (brick,), CLEARANCE + height * 1e-3) for number, brick in enumerate(poured)
        ),
        expectation=Expectation("study", "where a poured brick comes to rest, dynamics decide"),
        look_for="does the heap come to rest, and does a brick that lands wake what it moves, and only that?",
        watch_s=WATCH_S,
        poured=True,
    )


def _poured(count: int, generator: random.Random) -> list[Brick]:
    """Bricks in random poses around the z axis, each as high as it first touches those before it."""
    bricks: list[Brick] = []
    for level in range(1, count + 1):
        x, y = generator.gauss(0.0, SPREAD), generator.gauss(0.0, SPREAD)
        brick = Brick(SIZE, math.prod(SIZE) * DENSITY, (x, y, 0.0), _random_turn(generator), level)
        z = resting_shift(Boxes.of([brick]), Boxes.of(bricks)) - CLEARANCE
        bricks.append(replace(brick, position=(x, y, z)))
    return bricks


def _random_turn(generator: random.Random) -> Quaternion:
    """A rotation, all equally likely (Shoemake, "Uniform Random Rotations", Graphics Gems III, 1992)."""
    share, first, second = generator.random(), *(2 * math.pi * generator.random() for _ in range(2))
    low, high = math.sqrt(1 - share), math.sqrt(share)
    return (high * math.cos(second), low * math.sin(first), low * math.cos(first), high * math.sin(second))
