"""The ground as a box whose top is z = 0, for most engines."""

from __future__ import annotations

import math
from collections.abc import Iterable

from scenarios.model import Brick
from scenarios.solids import reach_of

MIN_HALF_EDGES = (2.0, 2.0, 0.5)
"""Smallest half edges [m] of the ground, so that any scene of planks fits on it, and no brick falls through it."""
ROOM_TO_FALL = 2.0
"""Ratio of the ground's half length and half width to the greatest distance of an expected brick's corner from the
ground's centre, so that falling bricks land on the ground."""


def ground_box(bricks: Iterable[Brick], scale: float, middle: float = 0.0) -> Brick:
    """Return a ground for ``bricks``, with half edges of at least ``MIN_HALF_EDGES`` times ``scale``.

    The ground's middle lies at x = ``middle`` [m], the scene's origin. Its length and width grow with the greatest
    distance of a brick's corner from the centre. Its thickness does not grow.
    """
    x, y, z = (scale * edge for edge in MIN_HALF_EDGES)
    reach = ROOM_TO_FALL * max((_reach(brick, middle) for brick in bricks), default=0.0)
    return Brick((2 * max(x, reach), 2 * max(y, reach), 2 * z), 1.0, (middle, 0.0, -z))


def _reach(brick: Brick, middle: float) -> float:
    """Return the greatest distance [m] of a brick's corner from the ground's centre, for any rotation of the brick."""
    x, y, _ = brick.position
    return math.hypot(x - middle, y) + reach_of(brick)
