"""Measure whether a stack stands, and how well: pure functions of planned and actual poses.

A brick is in place while it lies within a plank's thickness sideways of its release position and within 15 degrees of
tilt, and its level has not sunk by half a thickness into the level below. There are four kinds of collapse:

- topple: a brick turned by more than 15 degrees;
- slide: a brick moved sideways by more than its thickness;
- drop: a brick fell straight down through free space, because the plan no longer holds its support or because it
  lies more than its thickness lower than planned on the level below and overlaps nothing by much;
- sink: a level moved by more than half a thickness into what still lies below it.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from reports.records.trial import CollapseKind
from scenarios.geometry import Boxes, height_above_ground, vertical_clearance
from scenarios.model import Brick
from scenarios.statics import falling

FloatArray = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]

EARLY_S = 1e-9
"""Time [s] by which an action may lie ahead and still be due, because frame times are rounded sums."""
TILT_LIMIT = falling.TILT_LIMIT
"""Angle [rad] from the plan beyond which a brick has toppled."""
SLIDE_LIMIT = falling.SLIDE_LIMIT
"""Horizontal distance from the plan beyond which a brick has slid, in thicknesses."""
SINK_LIMIT = 0.5
"""Relative sink between neighbouring levels, in thicknesses of a brick."""
DROP_LIMIT = 1.0
"""Relative sink beyond which a brick that overlaps nothing has dropped, in thicknesses: a level that sank so far would
overlap the level below by as much."""


@dataclass(frozen=True, slots=True)
class Plan:
    """Planned poses of a set of bricks; row i of every array belongs to brick i."""

    position: FloatArray
    """Planned centres [m], shape (n, 3)."""
    quaternion: FloatArray
    """Planned orientations (w, x, y, z), shape (n, 4)."""
    size: FloatArray
    """Edge lengths [m], shape (n, 3)."""
    level: npt.NDArray[np.int64]
    """Levels from 1, shape (n,)."""
    drop_below: FloatArray
    """Height [m] of the centre below which a brick has dropped, shape (n,); minus infinity while its support is there.
    ``bench.trial.support`` sets it."""

    @classmethod
    def of(cls, bricks: Sequence[Brick]) -> Plan:
        """Return the plan of a scene's bricks."""
        return cls(
            np.array([brick.position for brick in bricks], np.float64).reshape(-1, 3),
            np.array([brick.quaternion for brick in bricks], np.float64).reshape(-1, 4),
            np.array([brick.size for brick in bricks], np.float64).reshape(-1, 3),
            np.array([brick.level for brick in bricks], np.int64),
            np.full(len(bricks), -np.inf),
        )

    @property
    def thickness(self) -> FloatArray:
        """Least edge of each brick [m], shape (n,)."""
        thickness: FloatArray = self.size.min(axis=1)
        return thickness


@dataclass(frozen=True, slots=True)
class Faults:
    """Bricks out of place, by kind; masks of shape (n,)."""

    topple: BoolArray
    slide: BoolArray
    drop: BoolArray
    sink: BoolArray

    @property
    def any(self) -> BoolArray:
        """Mask of the bricks out of place in any way."""
        return self.topple | self.slide | self.drop | self.sink

    @property
    def kind(self) -> CollapseKind | None:
        """The gravest kind of displacement; None if all bricks are in place."""
        if self.topple.any():
            return "topple"
        if self.slide.any():
            return "slide"
        if self.drop.any():
            return "drop"
        return "sink" if self.sink.any() else None


def sideways(plan: Plan, position: FloatArray) -> FloatArray:
    """Return the horizontal distance [m] of each brick from its release position, shape (n,)."""
    offset = position[:, :2] - plan.position[:, :2]
    distance: FloatArray = np.hypot(offset[:, 0], offset[:, 1])
    return distance


def tilt(plan: Plan, quaternion: FloatArray) -> FloatArray:
    """Return the angle [rad] of each brick's vertical to its plan, shape (n,); yaw is no tilt."""
    w, x, y, z = quaternion.T
    pw, px, py, pz = plan.quaternion.T
    # vector part of q * conj(planned): only its horizontal components turn the vertical
    rx = -w * px + x * pw - y * pz + z * py
    ry = -w * py + x * pz + y * pw - z * px
    angle: FloatArray = 2 * np.arcsin(np.clip(np.hypot(rx, ry), 0, 1))
    return angle


def relative_sink(plan: Plan, position: FloatArray) -> FloatArray:
    """Return how far [m] each brick's level has sunk into the level below, shape (n,); the ground does not sink.

    The mean of a level is compared, because a tower that leans as one lowers one side of a level and lifts the other,
    which is no sink.
    """
    if not len(position):
        return np.empty(0)
    rise = position[:, 2] - plan.position[:, 2]
    count = np.bincount(plan.level)
    total = np.bincount(plan.level, rise)
    sunk, below = np.zeros(len(count)), 0.0
    for level in range(1, len(count)):
        if count[level]:
            here = total[level] / count[level]
            sunk[level], below = below - here, here
    return sunk[plan.level]


def faults(plan: Plan, position: FloatArray, quaternion: FloatArray) -> Faults:
    """Return the bricks out of place, by kind."""
    thickness = plan.thickness
    sunk = relative_sink(plan, position)
    return Faults(
        topple=tilt(plan, quaternion) > TILT_LIMIT,
        slide=sideways(plan, position) > SLIDE_LIMIT * thickness,
        drop=(position[:, 2] < plan.drop_below) | _fell_freely(plan, position, quaternion, sunk),
        sink=sunk > SINK_LIMIT * thickness,
    )


def _fell_freely(plan: Plan, position: FloatArray, quaternion: FloatArray, sunk: FloatArray) -> BoolArray:
    """Return the bricks that lie more than a thickness too low and overlap nothing, shape (n,).

    A brick that passed through the level below, or through the ground, counts as overlapping it.
    """
    fallen = sunk > DROP_LIMIT * plan.thickness
    if not fallen.any():
        return fallen
    boxes = Boxes.at(plan.size, position, quaternion)
    here = Boxes(boxes.center[fallen], boxes.half_axes[fallen])
    is_lower = plan.level[None, :] < plan.level[fallen, None]
    clearance = np.where(is_lower, vertical_clearance(here, boxes), np.inf).min(axis=1)
    overlap = -np.minimum(clearance, height_above_ground(here))
    fallen[fallen] = overlap < SINK_LIMIT * plan.thickness[fallen]
    return fallen


def intact(plan: Plan, position: FloatArray, quaternion: FloatArray) -> bool:
    """Return True while every brick is in place."""
    return not faults(plan, position, quaternion).any.any()


def levels_standing(plan: Plan, out_of_place: BoolArray, landed: Collection[int]) -> int:
    """Return the highest of the ``landed`` levels that is in place together with every level below it; 0 if none."""
    broken = plan.level[out_of_place]
    reach = int(broken.min()) - 1 if len(broken) else math.inf
    return max((level for level in landed if level <= reach), default=0)


def top(plan: Plan, position: FloatArray, quaternion: FloatArray, level: int) -> float:
    """Return the height [m] of the highest corner of a level's bricks."""
    of_level = plan.level == level
    w, x, y, z = quaternion[of_level].T
    third_row = np.abs(np.stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], axis=1))
    half_height = 0.5 * (third_row * plan.size[of_level]).sum(axis=1)
    return float((position[of_level, 2] + half_height).max())


def sink(plan: Plan, position: FloatArray, level: int) -> float:
    """Return how far [m] a level's bricks lie below their ideal height, on average."""
    of_level = plan.level == level
    return float((plan.position[of_level, 2] - position[of_level, 2]).mean())


def fastest(before: FloatArray, after: FloatArray, seconds: float) -> float:
    """Return the mean speed [m/s] of the brick that moved farthest between two sets of positions (n, 3)."""
    return float(np.linalg.norm(after - before, axis=1).max() / seconds)
