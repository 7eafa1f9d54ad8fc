"""The ground, which most engines have as a box: its top is z = 0."""

from __future__ import annotations

import math
from collections.abc import Iterable

from scenarios.model import Brick

MIN_HALF_EDGES = (2.0, 2.0, 0.5)
"""Least half edges [m] of engines' grounds: room for any scene of planks, and too thick to fall through."""
ROOM_TO_FALL = 2.0
"""Reach of the ground over the distance of the farthest brick that is expected."""


def ground_box(bricks: Iterable[Brick], scale: float, middle: float = 0.0) -> Brick:
    """Return a ground for these bricks, with half edges of at least ``MIN_HALF_EDGES`` times ``scale``.

    Its middle lies at x = ``middle`` [m], where the scene's origin is. It is as thick as it must be in any scene; only
    its length and its width grow with the reach of the bricks.
    """
    x, y, z = (scale * edge for edge in MIN_HALF_EDGES)
    reach = ROOM_TO_FALL * max((_reach(brick, middle) for brick in bricks), default=0.0)
    return Brick((2 * max(x, reach), 2 * max(y, reach), 2 * z), 1.0, (middle, 0.0, -z))


def _reach(brick: Brick, middle: float) -> float:
    """Return the greatest distance [m] of a brick's corner from the ground's middle, for any turn of the brick."""
    x, y, _ = brick.position
    return math.hypot(x - middle, y) + math.hypot(*brick.size) / 2
