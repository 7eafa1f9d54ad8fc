"""Oriented boxes: the height of a box above another box, and the shift that lowers a rigid group onto its support.

Bodies of other shapes count with their exact shape (see ``scenarios.descent``). For boxes:

A point a of the upper box lies straight above a point b of the lower box if a - b = (0, 0, h). The upper box can sink
by the smallest h of all pairs of points. All differences a - b fill a zonotope (a convex polyhedron). A point of the
zonotope is the difference of the centres plus the six half axes of both boxes, each times a factor from -1 to 1. The
normals of the zonotope's facets are the cross products of two half axes (a face on a corner, or an edge on an edge).
The smallest h is the height at which the z axis enters the zonotope from below. The axis enters at the highest of its
intersections with the planes of the fifteen lower facets.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from scenarios.descent import Placed, lowest_difference
from scenarios.model import CLEARANCE, Brick, Quaternion
from scenarios.shapes import Shape, are_boxes, half_extents

FloatArray: TypeAlias = npt.NDArray[np.float64]
IntArray: TypeAlias = npt.NDArray[np.int64]
BoolArray: TypeAlias = npt.NDArray[np.bool_]

_FIRST, _SECOND = np.triu_indices(6, 1)
_SIGNS = np.array([[i, j, k] for i in (-1.0, 1.0) for j in (-1.0, 1.0) for k in (-1.0, 1.0)])
_PARALLEL = 1e-9
"""Sine of the angle below which two directions count as parallel, because rounding leaves about 1e-16."""
_GRAZE = 1e-9
"""Overlap [m] below which two boxes count as flush, not overlapping, because flush planks do not carry each other."""


@dataclass(frozen=True, slots=True)
class Boxes:
    """Oriented boxes, a row for each box."""

    center: FloatArray
    """Centres [m], shape (n, 3)."""
    half_axes: FloatArray
    """Vectors [m] from the centre to the middles of the faces +x, +y and +z, shape (n, 3, 3), one row an axis.
    A body of another shape has the box, centred on its centre of mass, that holds it."""
    placed: tuple[Placed, ...] | None = None
    """The bodies with their shapes; None if all are boxes."""

    @classmethod
    def at(
        cls,
        sizes: npt.ArrayLike,
        positions: npt.ArrayLike,
        quaternions: npt.ArrayLike,
        shapes: Sequence[Shape] | None = None,
    ) -> Boxes:
        """Return boxes from edge lengths (n, 3) [m], centres (n, 3) [m] and unit quaternions (n, 4) as (w, x, y, z).

        ``shapes`` contains the shapes of the n bodies; None if all bodies are boxes.
        """
        edges = np.asarray(sizes, np.float64).reshape(-1, 3)
        center = np.asarray(positions, np.float64).reshape(-1, 3)
        axes = np.swapaxes(rotation(np.asarray(quaternions, np.float64).reshape(-1, 4)), 1, 2)
        if shapes is None or are_boxes(shapes):
            return cls(center, axes * (edges / 2)[:, :, None])
        bodies = [(shape, (x, y, z)) for shape, (x, y, z) in zip(shapes, edges.tolist(), strict=True)]
        half = np.array([half_extents(shape, size) for shape, size in bodies])
        placed = tuple(Placed(shape, size, center[row], axes[row].T) for row, (shape, size) in enumerate(bodies))
        return cls(center, axes * half[:, :, None], placed)

    @classmethod
    def of(cls, bricks: Sequence[Brick]) -> Boxes:
        """Return the boxes of bricks in their planned poses."""
        return cls.at(
            [brick.size for brick in bricks],
            [brick.position for brick in bricks],
            [brick.quaternion for brick in bricks],
            [brick.shape for brick in bricks],
        )

    def chosen(self, rows: IntArray | BoolArray) -> Boxes:
        """Return the boxes of ``rows``, indices (k,) or a mask (n,)."""
        placed = self.placed
        if placed is not None:
            placed = tuple(placed[row] for row in np.arange(len(self))[rows].tolist())
        return Boxes(self.center[rows], self.half_axes[rows], placed)

    def __len__(self) -> int:
        return len(self.center)

    @property
    def corners(self) -> FloatArray:
        """Return all corners [m] in the world's frame, shape (n, 8, 3)."""
        from_center: FloatArray = np.einsum("ck,nkd->ncd", _SIGNS, self.half_axes)
        return self.center[:, None, :] + from_center

    @property
    def gyration(self) -> FloatArray:
        """Return the inertia over the mass [m2] of homogeneous boxes about their centres, shape (n, 3, 3).

        The components are along the world's axes.
        """
        moments = np.einsum("nki,nkj->nij", self.half_axes, self.half_axes) / 3
        gyration: FloatArray = np.einsum("nkk->n", moments)[:, None, None] * np.eye(3) - moments
        return gyration

    @property
    def reach(self) -> FloatArray:
        """Return half the edge lengths [m] of the axis-aligned bounding boxes, shape (n, 3)."""
        reach: FloatArray = np.abs(self.half_axes).sum(axis=1)
        return reach


def height_above_ground(boxes: Boxes) -> FloatArray:
    """Return the height [m] of each body's lowest point above z = 0, shape (n,)."""
    return _heights(boxes, -1.0)


def height_of_top(boxes: Boxes) -> FloatArray:
    """Return the height [m] of each body's highest point above z = 0, shape (n,)."""
    return _heights(boxes, 1.0)


def _heights(boxes: Boxes, side: float) -> FloatArray:
    """Return the height [m] of each body's highest point (``side`` 1) or lowest point (``side`` -1), shape (n,)."""
    heights: FloatArray = boxes.center[:, 2] + side * boxes.reach[:, 2]
    for row, body in enumerate(boxes.placed or ()):
        if body.shape != "box":
            heights[row] = body.support(np.array([0.0, 0.0, side]))[2]
    return heights


def vertical_clearance(upper: Boxes, lower: Boxes) -> FloatArray:
    """Return the distance [m] by which each upper box can sink straight down to each lower box, shape (m, n).

    The distance is infinite if the boxes do not overlap in plan (seen from above). The distance is negative if the
    upper box must rise to lie on the lower box.
    """
    clearance = np.full((len(upper), len(lower)), np.inf)
    apart = np.abs(upper.center[:, None, :2] - lower.center[None, :, :2])
    near = (apart < upper.reach[:, None, :2] + lower.reach[None, :, :2]).all(axis=2)
    above, below = np.nonzero(near)
    if len(above):
        between = upper.center[above] - lower.center[below]
        half_axes = np.concatenate([upper.half_axes[above], lower.half_axes[below]], axis=1)
        clearance[above, below] = _lowest_difference(between, half_axes)
    if upper.placed is not None or lower.placed is not None:
        _measure_other_shapes(clearance, upper, lower, above, below)
    return clearance


def _measure_other_shapes(clearance: FloatArray, upper: Boxes, lower: Boxes, above: IntArray, below: IntArray) -> None:
    """Write the clearance [m] of each pair (above, below) of bodies that are not two boxes to ``clearance`` (m, n)."""
    first, second = _placed(upper), _placed(lower)
    for one, other in zip(above.tolist(), below.tolist(), strict=True):
        if not (first[one].shape == second[other].shape == "box"):
            clearance[one, other] = lowest_difference(first[one], second[other])


def _placed(boxes: Boxes) -> tuple[Placed, ...]:
    if boxes.placed is not None:
        return boxes.placed
    edges = np.linalg.norm(boxes.half_axes, axis=2)
    turns = np.swapaxes(boxes.half_axes / edges[:, :, None], 1, 2)
    sizes = (2 * edges).tolist()
    return tuple(Placed("box", (x, y, z), boxes.center[row], turns[row]) for row, (x, y, z) in enumerate(sizes))


def overlap_in_plan(first: Boxes, second: Boxes) -> BoolArray:
    """Return the mask of the pairs of boxes that overlap in plan (seen from above), shape (m, n)."""
    return np.isfinite(vertical_clearance(first, second))


def side_by_side(first: Boxes, second: Boxes) -> BoolArray:
    """Return the mask of the pairs of boxes that are neighbours, shape (m, n).

    Two boxes are neighbours if they are apart or flush in plan, and their heights overlap.
    """
    if first.placed is None and second.placed is None:
        between = np.abs(first.center[:, None, 2] - second.center[None, :, 2])
        shares_height = between < first.reach[:, None, 2] + second.reach[None, :, 2] - _GRAZE
    else:
        is_below_top = height_above_ground(first)[:, None] < height_of_top(second)[None] - _GRAZE
        shares_height = is_below_top & (height_above_ground(second)[None] < height_of_top(first)[:, None] - _GRAZE)
    return shares_height & ~overlap_in_plan(first, second)


def resting_shift(
    group: Boxes, below: Boxes, *, neighbours: BoolArray | None = None, fixed: Boxes | None = None
) -> float:
    """Return the shift along z [m] that puts a rigid group ``CLEARANCE`` above its support.

    The first box that meets the support determines the shift.

    Args:
        group: the boxes that the harness releases together, in their planned poses.
        below: the boxes that may carry the group, in their actual poses. Pass boxes of lower levels only, because a
            neighbour of the same level that overlaps a plank slightly would count as the plank's support. The ground is
            always a support.
        neighbours: mask of the pairs (group, below), shape (m, n): True if both boxes are neighbours in the plan.
            Neighbours do not carry each other.
        fixed: boxes that never move. Fixed boxes carry boxes planned above them, but not boxes beside or below them.
    """
    clearance = vertical_clearance(group, below)
    if neighbours is not None:
        clearance[neighbours] = np.inf
    room = min(float(height_above_ground(group).min()), float(clearance.min(initial=np.inf)))
    if fixed is not None:
        room = min(room, room_above_fixed(group, fixed))
    return CLEARANCE - room


def room_above_fixed(group: Boxes, fixed: Boxes) -> float:
    """Return the distance [m] by which a rigid group can sink to the fixed boxes below.

    The distance is infinite without fixed boxes below.

    To leave a fixed box, a box of the group may have to rise. If this rise is at least half the height of the group's
    box, the fixed box counts as a ceiling. A smaller rise does not count, because placement noise on a slope makes
    boxes overlap by up to 1 mm.
    """
    clearance = vertical_clearance(group, fixed)
    is_above = clearance > -group.reach[:, None, 2]
    return float(clearance[is_above].min(initial=np.inf))


def _lowest_difference(center: FloatArray, half_axes: FloatArray) -> FloatArray:
    """Return the height [m] at which the z axis enters each zonotope, shape (p,).

    The height is infinite if the axis misses the zonotope, or only grazes the zonotope.

    Args:
        center: centres [m], shape (p, 3).
        half_axes: half axes [m], shape (p, 6, 3).
    """
    normal = np.cross(half_axes[:, _FIRST], half_axes[:, _SECOND])
    length = np.sqrt((normal * normal).sum(axis=2))
    size = np.sqrt((half_axes * half_axes).sum(axis=2))
    parallel = length <= _PARALLEL * size[:, _FIRST] * size[:, _SECOND]
    # Every direction gives a valid bound, so "up" replaces the normal that parallel axes do not have.
    normal[parallel], length[parallel] = (0.0, 0.0, 1.0), 1.0
    normal[normal[..., 2] < 0] *= -1.0

    middle = (normal @ center[:, :, None])[..., 0]
    reach = np.abs(normal @ np.swapaxes(half_axes, 1, 2)).sum(axis=2)
    rise = normal[..., 2]
    wall = rise < _PARALLEL * length
    slope = np.where(wall, 1.0, rise)
    enter = np.where(wall, -np.inf, (middle - reach) / slope).max(axis=1)
    leave = np.where(wall, np.inf, (middle + reach) / slope).min(axis=1)
    beside = (wall & (np.abs(middle) > reach - _GRAZE * length)).any(axis=1)
    return np.where(beside | (enter > leave - _GRAZE), np.inf, enter)


def rotation(quaternion: FloatArray) -> FloatArray:
    """Return rotation matrices, shape (n, 3, 3), of unit quaternions (w, x, y, z), shape (n, 4)."""
    w, x, y, z = quaternion.T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), 2, 0)


def turned(quaternion: Quaternion, turn: float) -> Quaternion:
    """Return a ``quaternion`` (w, x, y, z) turned about the world's z axis by ``turn`` [rad]."""
    c, s = math.cos(turn / 2), math.sin(turn / 2)
    w, x, y, z = quaternion
    return (c * w - s * z, c * x - s * y, c * y + s * x, c * z + s * w)
