"""The contact patch of two ideal boxes: its corners and its normal. ``solid_patch`` covers other shapes.

Two boxes touch if a direction separates them with a gap of zero. A single separating direction is the contact's normal.
The patch is the common part of both surfaces: a polygon (face on face), a segment (edge on face) or a point (corner on
face, edge across edge).

Two parallel edges meet at the ridge of two planks that lean against each other. There a whole range of directions
separates the boxes, and physics does not determine the normal. A convention gives the normal:

- ``bisector``: the middle of the range, which is horizontal for two planks that lean at the same angle;
- ``face``: the normal of the first box's face that bounds the range, as most physics engines report.

Statics needs only the corners of a patch, because a force at any point of the patch has the same effect as parallel
forces at the corners. If the force obeys Coulomb's law, the forces at the corners obey this law too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Literal, NamedTuple

import numpy as np

from scenarios.geometry import Boxes, FloatArray, height_above_ground
from scenarios.model import Brick
from scenarios.shapes import are_boxes
from scenarios.statics.polygons import clipped

Ridge = Literal["bisector", "face"]

GROUND = -1
"""Id of everything that never moves: the ground, and walls."""

TOUCH = 1e-6
"""Greatest gap or overlap of two boxes that count as touching, as a share of their thinnest edge. The value is far
above rounding and far below the gaps of plans. The value is a share, not a length, so that the verdict is the same at
8 mm and at 8 m."""
RIDGE_GAP = 0.04
"""Greatest gap between two parallel edges that count as meeting at a ridge, as a share of the thinnest edge of both
boxes, because the scenes leave 0.2 mm at ridges (0.026 of a plank's thickness), and 2 mm (0.26) between bricks that
must not touch."""
_PARALLEL = 1e-7
"""Sine of the angle below which two directions count as parallel."""


class Tolerance(NamedTuple):
    """Tolerances of a contact between boxes."""

    touch: float = TOUCH
    parallel: float = _PARALLEL


PLANNED = Tolerance()
"""Tolerance for planned poses, which are exact."""
RECORDED = Tolerance(touch=0.04, parallel=0.02)
"""Tolerance for poses that an engine simulated: 0.3 mm for a plank, because engines leave gaps and overlaps of 0.1 mm
and recordings have steps of 0.01 mm; and an angle of 1.1 deg, because seeds turn planks by up to 0.9 deg."""

_SIGNS = np.array([-1.0, 1.0])


class Patch(NamedTuple):
    """The contact patch of two bodies."""

    first: int
    """Index of the body from which the normal points, or ``GROUND``."""
    second: int
    """Index of the body to which the normal points."""
    points: FloatArray
    """The patch's corners [m], shape (k, 3)."""
    normal: FloatArray
    """Unit normal from the first body to the second, shape (3,)."""
    wall: int | None = None
    """Index of the wall that touches the second body; None for the ground or another body."""
    friction_ratio: float = 1.0
    """Ratio of the pair's coefficient of friction to the pile's."""


@dataclass(frozen=True, slots=True)
class _Box:
    center: FloatArray
    axes: FloatArray
    """Unit vectors of the box's own x, y and z, shape (3, 3), one row an axis."""
    half: FloatArray
    corners: FloatArray

    def faces(self) -> list[tuple[int, FloatArray]]:
        """Return the axis (0, 1 or 2) and the outward normal of each of the six faces."""
        return [(axis, sign * self.axes[axis]) for axis, sign in product(range(3), _SIGNS)]

    def reach_along(self, direction: FloatArray) -> float:
        """Return the greatest coordinate [m] of the box along the unit vector ``direction``."""
        return float((self.corners @ direction).max())


def contact_patches(
    bricks: Sequence[Brick],
    walls: Sequence[Brick] = (),
    *,
    ridge: Ridge = "bisector",
    tolerance: Tolerance = PLANNED,
) -> list[Patch]:
    """Return all contact patches of bricks: with each other, with walls, and with the ground z = 0.

    Args:
        bricks: the movable bricks, of any shape. Patches contain the bricks' indices.
        walls: bodies that never move. Patches contain ``GROUND`` as a wall's index.
        ridge: convention for the normal where two parallel edges meet (see the module docstring).
        tolerance: tolerances of a contact.

    Raises:
        ValueError: if two bricks overlap, or a brick overlaps a wall or the ground.
    """
    if not are_boxes([brick.shape for brick in (*bricks, *walls)]):
        from scenarios.statics.patches_of_solids import patches_of_solids  # here, because it needs this module

        return patches_of_solids(bricks, walls, ridge=ridge, tolerance=tolerance)
    boxes = Boxes.of([*bricks, *walls])
    reach = boxes.reach
    thin = 2 * np.linalg.norm(boxes.half_axes, axis=2).min(axis=1)
    singles = [
        _Box(center, half_axes / np.linalg.norm(half_axes, axis=1)[:, None], np.linalg.norm(half_axes, axis=1), corners)
        for center, half_axes, corners in zip(boxes.center, boxes.half_axes, boxes.corners, strict=True)
    ]
    patches = _on_ground(boxes, thin, len(bricks), tolerance)
    widest = max(RIDGE_GAP, tolerance.touch)
    for b in range(1, len(singles)):
        apart = np.abs(boxes.center[:b] - boxes.center[b]) - reach[:b] - reach[b]
        for a in np.flatnonzero((apart <= widest * thin[:b, None]).all(axis=1)).tolist():
            if a >= len(bricks):
                continue  # two walls
            try:
                found = touch(singles[a], singles[b], min(thin[a], thin[b]), ridge, tolerance)
            except ValueError as error:
                raise ValueError(f"{_name(a, bricks)} and {_name(b, bricks)}: {error}") from None
            if found and b < len(bricks):
                patches.append(Patch(a, b, *found))
            elif found:
                points, normal = found
                patches.append(Patch(GROUND, a, points, -normal, wall=b - len(bricks)))
    return patches


def _name(index: int, bricks: Sequence[Brick]) -> str:
    return f"brick {index}" if index < len(bricks) else f"wall {index - len(bricks)}"


def _on_ground(boxes: Boxes, thin: FloatArray, bricks: int, tolerance: Tolerance) -> list[Patch]:
    patches = []
    for index in np.flatnonzero(height_above_ground(boxes)[:bricks] <= tolerance.touch * thin[:bricks]).tolist():
        heights = boxes.corners[index, :, 2]
        if heights.min() < -tolerance.touch * thin[index]:
            raise ValueError(
                f"brick {index} must lie at or above z = 0, but is {-heights.min():g} m below the ground: raise "
                f"brick {index} by this depth"
            )
        points = boxes.corners[index][heights <= tolerance.touch * thin[index]]
        patches.append(Patch(GROUND, index, points, np.array([0.0, 0.0, 1.0])))
    return patches


def touch(
    first: _Box, second: _Box, thin: float, ridge: Ridge, tolerance: Tolerance = PLANNED
) -> tuple[FloatArray, FloatArray] | None:
    """Return the corners (k, 3) [m] of two boxes' patch, and the normal (3,) from the first box; None if apart.

    Boxes that only graze count as apart: they touch only at the borders of their faces, and have no definite normal.
    Two boxes are apart exactly if one of fifteen directions separates them: six normals of faces, and nine cross
    products of an edge of each box.

    Raises:
        ValueError: if the boxes overlap.
    """
    faces = [(first, axis, outward) for axis, outward in first.faces()]
    faces += [(second, axis, -outward) for axis, outward in second.faces()]
    crossings = _across_edges(first, second, tolerance.parallel)
    gap = tolerance.touch * thin
    normals = np.concatenate([[normal for *_, normal in faces], crossings])
    gaps = (second.corners @ normals.T).min(axis=0) - (first.corners @ normals.T).max(axis=0)
    widest = gaps.max()
    if widest > max(RIDGE_GAP * thin, gap):
        return None
    if widest < -gap:
        raise ValueError(
            f"boxes may touch, but must not overlap, got an overlap of {-widest:g} m: move the boxes apart"
        )
    separating = gaps >= -gap
    if widest <= gap:
        for (box, axis, normal), separates in zip(faces, separating, strict=False):
            if separates:
                other, outward = (second, normal) if box is first else (first, -normal)
                points = _shared_with_face(box, axis, outward, other, gap)
                if len(points):
                    return points, normal
        for normal, separates in zip(crossings, separating[len(faces) :], strict=True):
            if separates:
                point = _crossing_point(first, second, normal, gap)
                if point is not None:
                    return point[None], normal
    separators = [face for face, separates in zip(faces, separating, strict=False) if separates]
    return _at_ridge(first, second, separators, thin, ridge, tolerance)


def _across_edges(first: _Box, second: _Box, parallel: float) -> FloatArray:
    """Return a unit vector for each pair of edges that are not parallel, shape (k, 3).

    Each vector is perpendicular to an edge of each box, and points from the first box to the second box.
    """
    normals = np.cross(first.axes[:, None], second.axes[None]).reshape(9, 3)
    length = np.linalg.norm(normals, axis=1)
    crossed = length > parallel
    normals = normals[crossed] / length[crossed, None]
    away = np.where(normals @ (second.center - first.center) >= 0, 1.0, -1.0)
    oriented: FloatArray = normals * away[:, None]
    return oriented


def _shared_with_face(box: _Box, axis: int, outward: FloatArray, other: _Box, tolerance: float) -> FloatArray:
    """Return the corners (k, 3) [m] of the common part of ``other`` and a separating face of ``box``.

    The result is empty if ``other`` only grazes the face, because ``other`` then touches only the face's border.
    """
    u, v = (axis + 1) % 3, (axis + 2) % 3
    height = (other.corners - box.center) @ outward - box.half[axis]
    feature = other.corners[height <= tolerance] - box.center
    inside = np.column_stack([feature @ box.axes[u], feature @ box.axes[v]])
    if len(inside) == 4:
        inside = inside[[0, 1, 3, 2]]  # around the face, not across it
    for side, half in ((0, box.half[u]), (1, box.half[v])):
        for sign in _SIGNS:
            inside = clipped(inside, sign * inside[:, side] - half)
    if not len(inside):
        return np.empty((0, 3))
    # A feature on the face's border only grazes the face: the normal would be arbitrary.
    room = np.array([box.half[u], box.half[v]]) - np.abs(inside.mean(axis=0))
    if room.min() <= tolerance:
        return np.empty((0, 3))
    flat = inside @ np.array([box.axes[u], box.axes[v]])
    points: FloatArray = box.center + outward * box.half[axis] + flat
    return points


def _crossing_point(first: _Box, second: _Box, normal: FloatArray, tolerance: float) -> FloatArray | None:
    """Return the point (3,) [m] in which edges of both boxes cross; None if no edges cross."""
    start = first.corners[first.corners @ normal >= first.reach_along(normal) - tolerance]
    end = second.corners[-(second.corners @ normal) >= second.reach_along(-normal) - tolerance]
    if len(start) != 2 or len(end) != 2:
        return None
    along = np.array([start[1] - start[0], end[0] - end[1], normal])
    if abs(np.linalg.det(along)) <= _PARALLEL * np.linalg.norm(along[0]) * np.linalg.norm(along[1]):
        return None
    s, t, _ = np.linalg.solve(along.T, end[0] - start[0])
    if not (0 <= s <= 1 and 0 <= t <= 1):
        return None
    middle: FloatArray = (start[0] + s * along[0] + end[0] - t * along[1]) / 2
    return middle


def _at_ridge(
    first: _Box,
    second: _Box,
    faces: Sequence[tuple[_Box, int, FloatArray]],
    thin: float,
    ridge: Ridge,
    tolerance: Tolerance,
) -> tuple[FloatArray, FloatArray] | None:
    """Return the segment (2, 3) [m] in which two parallel edges meet, and the normal (3,); None if no edges meet.

    Args:
        first: the box from which the normal points.
        second: the box to which the normal points.
        faces: faces that separate the boxes, each with its normal from the first box to the second box. These normals
            bound the range of separating directions.
        thin: the shortest edge of both boxes [m].
        ridge: the convention for the normal.
        tolerance: tolerances of a contact.
    """
    cosine = first.axes @ second.axes.T
    shared = np.argwhere(cosine**2 > 1 - tolerance.parallel**2)
    if len(shared) != 1 or not faces:
        return None  # no axes parallel, or all three: flush faces, which ``touch`` has handled
    along = first.axes[shared[0, 0]]
    bisector = np.sum([normal for *_, normal in faces], axis=0)
    bisector /= np.linalg.norm(bisector)
    near = first.corners[first.corners @ bisector >= first.reach_along(bisector) - tolerance.touch * thin]
    far = second.corners[-(second.corners @ bisector) >= second.reach_along(-bisector) - tolerance.touch * thin]
    between = far.mean(axis=0) - near.mean(axis=0)
    apart = float(np.linalg.norm(between - along * (along @ between)))
    if len(near) != 2 or len(far) != 2 or apart > max(RIDGE_GAP, tolerance.touch) * thin:
        return None
    low = max((near @ along).min(), (far @ along).min())
    high = min((near @ along).max(), (far @ along).max())
    if high - low <= tolerance.touch * thin:
        return None
    middle = (near.mean(axis=0) + far.mean(axis=0)) / 2
    points = middle + np.outer([low, high] - along @ middle, along)
    own = [normal for box, _, normal in faces if box is first] or [normal for *_, normal in faces]
    return points, bisector if ridge == "bisector" else own[0]
