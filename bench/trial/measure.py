"""Measure whether a stack stands, and how well: pure functions of planned and actual poses.

A brick is in place unless one of four kinds of collapse has displaced the brick:

- topple: the brick has tilted by more than 15 degrees from its planned orientation;
- slide: the brick has moved horizontally by more than its thickness from its release position;
- drop: the brick has fallen through free space, in one of two cases:

  - The brick has lost its support, and lies below its drop height (see ``Plan.drop_below``).
  - The level of the brick has sunk by more than the brick's thickness relative to the level below. The brick overlaps
    lower bricks and the ground by less than half its thickness.

- sink: the level of the brick has sunk by more than half the brick's thickness relative to the level below.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from reports.records.trial import CollapseKind
from scenarios.geometry import Boxes, height_above_ground, height_of_top, vertical_clearance
from scenarios.model import Brick
from scenarios.shapes import Shape, are_boxes, symmetry
from scenarios.statics import falling

FloatArray = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]

EARLY_S = 1e-9
"""Greatest time by which an action may start before it is due [s], because the starts of frames are rounded."""
TILT_LIMIT = falling.TILT_LIMIT
"""Tilt from the planned orientation beyond which a brick has toppled [rad]."""
SLIDE_LIMIT = falling.SLIDE_LIMIT
"""Horizontal distance from the planned position beyond which a brick has slid [thicknesses of the brick]."""
SINK_LIMIT = 0.5
"""Sink of a level relative to the level below, beyond which a brick of that level has sunk [thicknesses of the
brick]."""
DROP_LIMIT = 1.0
"""Sink of a level relative to the level below [thicknesses of the brick]. Beyond this sink, a brick of that level has
dropped if it overlaps lower bricks and the ground by less than ``SINK_LIMIT``. A brick that sank so far without falling
would overlap the level below by the same distance."""


@dataclass(frozen=True, slots=True)
class Plan:
    """Planned poses of n bricks; row i of every array belongs to brick i."""

    position: FloatArray
    """Planned centres [m], shape (n, 3), world frame."""
    quaternion: FloatArray
    """Planned orientations (w, x, y, z), shape (n, 4), world frame."""
    size: FloatArray
    """Edge lengths [m], shape (n, 3)."""
    level: npt.NDArray[np.int64]
    """Level of each brick, counted from 1, shape (n,)."""
    shapes: tuple[Shape, ...] | None
    """Shapes of the bricks; None if all are boxes."""
    drop_below: FloatArray
    """Height of the centre below which a brick has dropped [m], shape (n,); minus infinity for a brick that kept its
    support. The heights come from ``bench.trial.support``."""

    @classmethod
    def of(cls, bricks: Sequence[Brick]) -> Plan:
        """Return the plan of bricks that all have their support."""
        return cls(
            np.array([brick.position for brick in bricks], np.float64).reshape(-1, 3),
            np.array([brick.quaternion for brick in bricks], np.float64).reshape(-1, 4),
            np.array([brick.size for brick in bricks], np.float64).reshape(-1, 3),
            np.array([brick.level for brick in bricks], np.int64),
            None if are_boxes([brick.shape for brick in bricks]) else tuple(brick.shape for brick in bricks),
            np.full(len(bricks), -np.inf),
        )

    @property
    def thickness(self) -> FloatArray:
        """Thickness (least edge) of each brick [m], shape (n,)."""
        thickness: FloatArray = self.size.min(axis=1)
        return thickness

    def boxes_at(self, position: FloatArray, quaternion: FloatArray, rows: BoolArray | slice = slice(None)) -> Boxes:
        """Return the bricks of ``rows`` at the given poses.

        The poses are of all n bricks: ``position`` [m], shape (n, 3), and ``quaternion`` (w, x, y, z), shape (n, 4).
        """
        shapes = None
        if self.shapes is not None:
            shapes = [self.shapes[row] for row in np.arange(len(self.size))[rows].tolist()]
        return Boxes.at(self.size[rows], position[rows], quaternion[rows], shapes)


@dataclass(frozen=True, slots=True)
class Faults:
    """Bricks out of place; each field is the mask of one kind of collapse, shape (n,)."""

    topple: BoolArray
    slide: BoolArray
    drop: BoolArray
    sink: BoolArray

    @property
    def any(self) -> BoolArray:
        """Mask of the bricks out of place in any way, shape (n,)."""
        return self.topple | self.slide | self.drop | self.sink

    @property
    def kind(self) -> CollapseKind | None:
        """Kind of the collapse: the first of topple, slide, drop and sink that occurs; None without a collapse."""
        if self.topple.any():
            return "topple"
        if self.slide.any():
            return "slide"
        if self.drop.any():
            return "drop"
        return "sink" if self.sink.any() else None


def sideways(plan: Plan, position: FloatArray) -> FloatArray:
    """Return the horizontal distance of each brick from its release position [m], shape (n,)."""
    offset = position[:, :2] - plan.position[:, :2]
    distance: FloatArray = np.hypot(offset[:, 0], offset[:, 1])
    return distance


def tilt(plan: Plan, quaternion: FloatArray) -> FloatArray:
    """Return the tilt of each brick from its planned orientation [rad], shape (n,).

    The tilt is the angle between the vertical and the same direction after the rotation of the brick from its planned
    orientation. A rotation about the vertical is therefore no tilt. A rotation of a round brick about its own axis is
    no tilt either. The tilt of a cylinder or capsule is the change of the angle between its axis and the vertical. The
    tilt of a sphere is zero.
    """
    w, x, y, z = quaternion.T
    pw, px, py, pz = plan.quaternion.T
    # vector part of q * conj(planned): only its horizontal components turn the vertical
    rx = -w * px + x * pw - y * pz + z * py
    ry = -w * py + x * pz + y * pw - z * px
    angle: FloatArray = 2 * np.arcsin(np.clip(np.hypot(rx, ry), 0, 1))
    for row, shape in enumerate(plan.shapes or ()):
        if symmetry(shape) == "axis":
            angle[row] = abs(_lean_of_axis(quaternion[row]) - _lean_of_axis(plan.quaternion[row]))
        elif symmetry(shape) == "point":
            angle[row] = 0.0
    return angle


def _lean_of_axis(quaternion: FloatArray) -> float:
    """Return the angle [rad] between a brick's own z axis and the vertical."""
    _, x, y, _ = quaternion
    return 2 * math.asin(min(1.0, math.hypot(x, y)))


def relative_sink(plan: Plan, position: FloatArray) -> FloatArray:
    """Return the sink of each brick's level relative to the level below [m], shape (n,); the ground does not sink.

    The sink compares the means of levels. Therefore a tower that leans as a rigid body does not sink, because one side
    of each level falls and the other side rises.
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
    """Return the masks of the bricks out of place, by kind of collapse."""
    thickness = plan.thickness
    sunk = relative_sink(plan, position)
    return Faults(
        topple=tilt(plan, quaternion) > TILT_LIMIT,
        slide=sideways(plan, position) > SLIDE_LIMIT * thickness,
        drop=(position[:, 2] < plan.drop_below) | _fell_freely(plan, position, quaternion, sunk),
        sink=sunk > SINK_LIMIT * thickness,
    )


def _fell_freely(plan: Plan, position: FloatArray, quaternion: FloatArray, sunk: FloatArray) -> BoolArray:
    """Return the mask of the bricks that fell through free space, shape (n,).

    A brick fell freely if both conditions hold:

    - The level of the brick has sunk by more than ``DROP_LIMIT``.
    - The brick overlaps lower bricks and the ground by less than ``SINK_LIMIT``. A brick that passed through a lower
      brick or the ground counts as overlapping.
    """
    fallen = sunk > DROP_LIMIT * plan.thickness
    if not fallen.any():
        return fallen
    boxes = plan.boxes_at(position, quaternion)
    here = boxes.chosen(fallen)
    is_lower = plan.level[None, :] < plan.level[fallen, None]
    clearance = np.where(is_lower, vertical_clearance(here, boxes), np.inf).min(axis=1)
    overlap = -np.minimum(clearance, height_above_ground(here))
    fallen[fallen] = overlap < SINK_LIMIT * plan.thickness[fallen]
    return fallen


def intact(plan: Plan, position: FloatArray, quaternion: FloatArray) -> bool:
    """Return whether every brick is in place."""
    return not faults(plan, position, quaternion).any.any()


def levels_standing(plan: Plan, out_of_place: BoolArray, landed: Collection[int]) -> int:
    """Return the highest level in ``landed`` up to which all levels are in place; 0 if there is no such level."""
    broken = plan.level[out_of_place]
    reach = int(broken.min()) - 1 if len(broken) else math.inf
    return max((level for level in landed if level <= reach), default=0)


def top(plan: Plan, position: FloatArray, quaternion: FloatArray, level: int) -> float:
    """Return the height above z = 0 of the highest point of the bricks of ``level`` [m]."""
    of_level = plan.level == level
    if plan.shapes is not None:
        return float(height_of_top(plan.boxes_at(position, quaternion, of_level)).max())
    w, x, y, z = quaternion[of_level].T
    third_row = np.abs(np.stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], axis=1))
    half_height = 0.5 * (third_row * plan.size[of_level]).sum(axis=1)
    return float((position[of_level, 2] + half_height).max())


def sink(plan: Plan, position: FloatArray, level: int) -> float:
    """Return the mean depth of the bricks of ``level`` below their planned height [m]."""
    of_level = plan.level == level
    return float((plan.position[of_level, 2] - position[of_level, 2]).mean())


def fastest(before: FloatArray, after: FloatArray, seconds: float) -> float:
    """Return the mean speed of the brick that moved farthest [m/s].

    Args:
        before: centres at the beginning [m], shape (n, 3).
        after: centres at the end [m], shape (n, 3).
        seconds: time from the beginning to the end [s].
    """
    return float(np.linalg.norm(after - before, axis=1).max() / seconds)
