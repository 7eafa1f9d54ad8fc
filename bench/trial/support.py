"""Determine the bricks that lost their support by a removal or a pull, and their drop heights.

A brick that sinks moves into the brick below. A brick that lost its support moves down through free space. This module
compares planned poses instead of actual poses, so that the same bricks lose their support on every engine.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bench.trial.measure import SINK_LIMIT, FloatArray, Plan
from scenarios.geometry import Boxes, height_above_ground, vertical_clearance
from scenarios.model import Brick


def drop_heights(plan: Plan, position: FloatArray, taken: Brick, left: Sequence[Brick] = ()) -> FloatArray:
    """Return the heights of the centres below which bricks without their support have dropped [m], shape (n,).

    The rise of a brick is the increase of the free height below the brick. The height depends on the rise:

    - A brick kept its support if its rise is at most half the thickness of the removed brick, because placement noise
      causes small rises. The height is minus infinity.
    - Any other brick lost its support. The height lies below the present centre by half the rise, but by at most half
      the brick's thickness.

    Args:
        plan: plan of the n remaining bricks.
        position: actual centres of the bricks [m], shape (n, 3), world frame.
        taken: the removed or pulled brick at its last planned pose.
        left: the same brick at its present pose during the pull; empty after its removal.
    """
    boxes = plan.boxes_at(plan.position, plan.quaternion)
    before = _room(boxes, Boxes.of([taken]))
    room = np.zeros(len(boxes))
    above = np.flatnonzero(np.isfinite(before))
    if len(above):
        candidates = boxes.chosen(above)
        rest = np.minimum(height_above_ground(candidates), _room(candidates, boxes))
        now = np.minimum(rest, _room(candidates, Boxes.of(left)))
        room[above] = now - np.minimum(rest, before[above])
    fall = SINK_LIMIT * np.minimum(room, plan.thickness)
    return np.where(room > SINK_LIMIT * min(taken.size), position[:, 2] - fall, -np.inf)


def _room(upper: Boxes, lower: Boxes) -> FloatArray:
    """Return the distance by which each of m upper boxes can move down to the first lower box [m], shape (m,).

    The distance is infinite for an upper box above no lower box. Of two overlapping boxes, the upper box is the box
    that needs the smaller upward motion to end the overlap.
    """
    down, up = vertical_clearance(upper, lower), vertical_clearance(lower, upper).T
    room: FloatArray = np.where(down > up, down, np.inf).min(axis=1, initial=np.inf)
    return room
