"""Poured bricks: their size, their random turns and their planned heights."""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Sequence
from dataclasses import replace

from scenarios.geometry import Boxes, resting_shift
from scenarios.model import CLEARANCE, Brick, Quaternion
from scenarios.planks import DENSITY, LENGTH, THICKNESS, WIDTH

SIZE = (LENGTH / 3, WIDTH, 2 * THICKNESS)
"""Edges of a brick [m], 5 : 3 : 2: a third of a plank, twice as thick."""
PACE_S = 0.25
"""Time between two bricks [s], so that a brick has time to fall and tumble, and the pile has no time to sleep."""


def poured_bricks(
    count: int,
    generator: random.Random,
    release: Callable[[random.Random], tuple[float, float]],
    beside: Sequence[Brick] = (),
) -> list[Brick]:
    """Return bricks in random poses, each at the height of its first contact.

    Each brick sinks straight down, without turning, until it touches an earlier brick or the ground. The planned
    heights assume that every brick stays in the pose of its first contact.

    Args:
        count: number of bricks.
        generator: source of all random numbers: for each brick the place, then the turn.
        release: function that draws the place (x, y) [m] of a brick.
        beside: bricks in place before the first poured brick. The level of the first poured brick is one above their
            highest level.
    """
    bricks = list(beside)
    first = max((brick.level for brick in beside), default=0) + 1
    for level in range(first, first + count):
        x, y = release(generator)
        brick = Brick(SIZE, math.prod(SIZE) * DENSITY, (x, y, 0.0), random_turn(generator), level)
        z = resting_shift(Boxes.of([brick]), Boxes.of(bricks)) - CLEARANCE
        bricks.append(replace(brick, position=(x, y, z)))
    return bricks[len(beside) :]


def random_turn(generator: random.Random) -> Quaternion:
    """Return a random rotation as a quaternion (w, x, y, z); all rotations are equally likely.

    The method is from K. Shoemake, "Uniform Random Rotations", Graphics Gems III, 1992.
    """
    share, first, second = generator.random(), *(2 * math.pi * generator.random() for _ in range(2))
    low, high = math.sqrt(1 - share), math.sqrt(share)
    return (high * math.cos(second), low * math.sin(first), low * math.cos(first), high * math.sin(second))
