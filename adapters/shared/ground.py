"""Size of the ground, which every engine has as a box: its top is z = 0."""

from __future__ import annotations

import math
from collections.abc import Iterable

from scenarios.model import Brick, Vector

MIN_HALF_EDGES = (2.0, 2.0, 0.5)
"""Half the least edges [m] of engines' grounds: room for any scene of planks, and too thick to fall through."""
ROOM_TO_FALL = 2.0
"""Reach of the ground over the distance of the farthest brick that is expected."""


def ground_half_edges(bricks: Iterable[Brick], scale: float) -> Vector:
    """Return half the edges [m] of a ground for these bricks, at least ``MIN_HALF_EDGES`` times ``scale``."""
    x, y, z = MIN_HALF_EDGES
    reach = ROOM_TO_FALL * max((_reach(brick) for brick in bricks), default=0.0)
    return max(x * scale, reach), max(y * scale, reach), z * scale


def _reach(brick: Brick) -> float:
    """Return how far [m] from the z axis a brick may lie, however it is turned."""
    x, y, _ = brick.position
    return math.hypot(x, y) + math.hypot(*brick.size) / 2
