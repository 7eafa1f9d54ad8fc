"""Determine which bricks lost their support because a brick was removed, and how far each can fall.

A brick that sinks moves into the brick below; a brick whose support was removed moves down through free space. Plans
decide, not an engine's poses, so the same bricks lose their support on every engine.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bench.trial.measure import SINK_LIMIT, FloatArray, Plan
from scenarios.geometry import Boxes, height_above_ground, vertical_clearance
from scenarios.model import Brick


def drop_heights(plan: Plan, position: FloatArray, taken: Brick, left: Sequence[Brick] = ()) -> FloatArray:
    """Return the heights [m] of the centres below which bricks without their support have dropped, shape (n,).

    A brick has dropped when it has fallen by half its thickness, or by half of the room below it where that is less.
    Minus infinity for a brick that kept its support: its plan has no more room below it than before, or only so little
    (less than half the thickness of the removed brick) as placement noise leaves.

    Args:
        plan: plan of the remaining bricks.
        position: their actual centres [m], shape (n, 3).
        taken: the removed brick, at its last pose.
        left: the same brick at its present pose, while it is pulled; empty once it is gone.
    """
    boxes = Boxes.at(plan.size, plan.position, plan.quaternion)
    before = _room(boxes, Boxes.of([taken]))
    room = np.zeros(len(boxes))
    above = np.flatnonzero(np.isfinite(before))
    if len(above):
        candidates = Boxes(boxes.center[above], boxes.half_axes[above])
        rest = np.minimum(height_above_ground(candidates), _room(candidates, boxes))
        now = np.minimum(rest, _room(candidates, Boxes.of(left)))
        room[above] = now - np.minimum(rest, before[above])
    fall = SINK_LIMIT * np.minimum(room, plan.thickness)
    return np.where(room > SINK_LIMIT * min(taken.size), position[:, 2] - fall, -np.inf)


def _room(upper: Boxes, lower: Boxes) -> FloatArray:
    """Return how far [m] each box can move straight down until it meets a box below it, shape (m,).

    The box that must be raised less to come free lies above. Infinite if none lies below.
    """
    down, up = vertical_clearance(upper, lower), vertical_clearance(lower, upper).T
    room: FloatArray = np.where(down > up, down, np.inf).min(axis=1, initial=np.inf)
    return room
