"""Kernels for the contacts of boxes that touch or nearly touch: corners of contact areas, and pairs at a small gap.

The kernels of ``adapters.shared.swept_contacts`` call some of these kernels: see ADR-0002 on Numba's cache.
"""

from __future__ import annotations

import math

import numba
import numpy as np

from stability_core.port import FloatArray, IntArray

NEAR = 0.1e-3
"""Greatest gap [m] of faces that nearly touch. The value exceeds the gaps below a tilted brick at rest, so that all
corners of its contact areas count. A gap of this size is not visible."""
SLACK = 1e-6
"""Greatest sideways gap [m] of edges that meet, because poses in single precision have rounding errors of this size."""
SAME = 1e-3
"""Distance [m] within which a corner and a point of the engine count as the same point."""
PLANK = math.sqrt(58.5e-3 * 58.5e-3 + 11.7e-3 * 11.7e-3 + 3.9e-3 * 3.9e-3)
"""Half the diagonal [m] of the plank that determines the lengths of this module. For a pair of boxes the
kernels multiply a length by the ratio of the smaller box's diagonal to the plank's diagonal, as the core does."""

CENTER, TURN, HALF, REACH = slice(0, 3), slice(3, 7), slice(7, 10), slice(10, 13)
"""Columns of a box: centre [m], quaternion (w, x, y, z), half edges [m], and half extents along x, y, z [m]."""

_MOST_CORNERS = 8
"""Greatest number of corners of a face clipped by another face, because each of four cuts adds at most one corner."""


@numba.njit(cache=True)
def half_diagonal(half: FloatArray) -> float:
    """Return half the diagonal [m] of a box with half edges ``half`` (3,) [m]."""
    return math.sqrt(half[0] * half[0] + half[1] * half[1] + half[2] * half[2])


@numba.njit(cache=True)
def _pair_size(box_a: FloatArray, box_b: FloatArray) -> float:
    """Return the ratio of the smaller of two boxes' diagonals to the diagonal of the plank."""
    return min(half_diagonal(box_a[HALF]), half_diagonal(box_b[HALF])) / PLANK


@numba.njit(cache=True)
def axes_of(quaternion: FloatArray) -> FloatArray:
    """Return the rotation matrix (3, 3) of a unit quaternion (w, x, y, z). Its columns are the box's axes."""
    w, x, y, z = quaternion
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


@numba.njit(cache=True)
def _facing(axes: FloatArray, direction: FloatArray) -> tuple[int, float]:
    """Return the index of the axis most parallel to ``direction``, and the cosine of their angle.

    The cosine is negative if the axis points against ``direction``.
    """
    best, cosine = 0, 0.0
    for axis in range(3):
        along = axes[0, axis] * direction[0] + axes[1, axis] * direction[1] + axes[2, axis] * direction[2]
        if abs(along) > abs(cosine):
            best, cosine = axis, along
    return best, cosine


@numba.njit(cache=True)
def _clip(polygon: FloatArray, normal: FloatArray, limit: float) -> FloatArray:
    """Return the part (k, 3) of a polygon (n, 3) where normal . x <= limit (Sutherland and Hodgman)."""
    n = len(polygon)
    clipped = np.empty((2 * n, 3))
    size = 0
    for i in range(n):
        here, there = polygon[i], polygon[(i + 1) % n]
        depth_here = here[0] * normal[0] + here[1] * normal[1] + here[2] * normal[2] - limit
        depth_there = there[0] * normal[0] + there[1] * normal[1] + there[2] * normal[2] - limit
        if depth_here <= 0.0:
            clipped[size] = here
            size += 1
        if depth_here * depth_there < 0.0:
            part = depth_here / (depth_here - depth_there)
            for k in range(3):
                clipped[size, k] = here[k] + part * (there[k] - here[k])
            size += 1
    return clipped[:size]


@numba.njit(cache=True)
def _face(center: FloatArray, axes: FloatArray, half: FloatArray, axis: int, side: float) -> FloatArray:
    """Return the corners (4, 3) [m] of a box's face, in order around the face."""
    u, v = (axis + 1) % 3, (axis + 2) % 3
    corners = np.empty((4, 3))
    for i in range(4):
        along_u = half[u] if i in (0, 3) else -half[u]
        along_v = half[v] if i < 2 else -half[v]
        for k in range(3):
            corners[i, k] = center[k] + side * half[axis] * axes[k, axis] + along_u * axes[k, u] + along_v * axes[k, v]
    return corners


@numba.njit(cache=True)
def face_corners(
    box_a: FloatArray, box_b: FloatArray, normal: FloatArray, slack: float
) -> tuple[FloatArray, FloatArray]:
    """Return the corners (k, 3) [m] of the contact area of two boxes, and their separations (k,) [m].

    Args:
        box_a: row of box a, shape (13,).
        box_b: row of box b, shape (13,).
        normal: unit normal from a to b, shape (3,).
        slack: distance [m] by which the function enlarges the clipping face on each side.
    """
    axes_a, axes_b = axes_of(box_a[TURN]), axes_of(box_b[TURN])
    axis_a, cosine_a = _facing(axes_a, normal)
    axis_b, cosine_b = _facing(axes_b, -normal)
    a_is_reference = abs(cosine_a) >= abs(cosine_b)
    box, axes, axis, cosine = box_a, axes_a, axis_a, cosine_a
    other, other_axes = box_b, axes_b
    if not a_is_reference:
        box, axes, axis, cosine = box_b, axes_b, axis_b, cosine_b
        other, other_axes = box_a, axes_a
    half = box[HALF]
    outward = np.sign(cosine) * axes[:, axis]
    facing, facing_cosine = _facing(other_axes, -outward)
    polygon = _face(other[CENTER], other_axes, other[HALF], facing, np.sign(facing_cosine))
    for side_axis in ((axis + 1) % 3, (axis + 2) % 3):
        side = axes[:, side_axis].copy()
        middle = side[0] * box[0] + side[1] * box[1] + side[2] * box[2]
        polygon = _clip(polygon, side, middle + half[side_axis] + slack)
        polygon = _clip(polygon, -side, -middle + half[side_axis] + slack)
    separation = np.empty(len(polygon))
    for i in range(len(polygon)):
        separation[i] = -half[axis]
        for k in range(3):
            separation[i] += (polygon[i, k] - box[k]) * outward[k]
    return polygon, separation


@numba.njit(cache=True)
def _parting_face(box_a: FloatArray, box_b: FloatArray, normal: FloatArray) -> float:
    """Return the greatest gap [m] between two boxes along the normal of a face, negative if they overlap.

    Write the unit normal of this face, from a to b, into ``normal`` (3,).
    """
    axes_a, axes_b = axes_of(box_a[TURN]), axes_of(box_b[TURN])
    widest = -np.inf
    for of_a in (True, False):
        axes, half = (axes_a, box_a[HALF]) if of_a else (axes_b, box_b[HALF])
        others, other_half = (axes_b, box_b[HALF]) if of_a else (axes_a, box_a[HALF])
        for axis in range(3):
            along = 0.0
            for k in range(3):
                along += (box_b[k] - box_a[k]) * axes[k, axis]
            gap = abs(along) - half[axis]
            for other in range(3):
                cosine = 0.0
                for k in range(3):
                    cosine += others[k, other] * axes[k, axis]
                gap -= abs(cosine) * other_half[other]
            if gap > widest:
                widest = gap
                for k in range(3):
                    normal[k] = axes[k, axis] if along >= 0.0 else -axes[k, axis]
    return widest


@numba.njit(cache=True)
def note_reach(boxes: FloatArray, rows: IntArray) -> None:
    """Write the half extents along x, y and z of the boxes in ``rows`` into their columns ``REACH``."""
    for row in rows:
        axes = axes_of(boxes[row, TURN])
        for k in range(3):
            reach = 0.0
            for axis in range(3):
                reach += abs(axes[k, axis]) * boxes[row, HALF][axis]
            boxes[row, REACH][k] = reach


@numba.njit(cache=True)
def missing_corners(
    boxes: FloatArray, a: IntArray, b: IntArray, normal: FloatArray, point: FloatArray
) -> tuple[IntArray, FloatArray, FloatArray]:
    """Return the corners of contact areas that the engine's contacts do not list.

    Args:
        boxes: all boxes, shape (m, 13).
        a: row of the first box of each contact, shape (n,); contacts of a pair are adjacent.
        b: row of the second box of each contact, shape (n,).
        normal: unit normals from a to b, shape (n, 3).
        point: contact points [m], shape (n, 3).

    Returns:
        The index (k,) of a contact of the corner's pair, the corners (k, 3) [m] and their separations (k,) [m].
    """
    n = len(a)
    row, corner, gap = np.empty(8 * n, np.int64), np.empty((8 * n, 3)), np.empty(8 * n)
    size, first = 0, 0
    while first < n:
        last = first
        while last < n and a[last] == a[first] and b[last] == b[first]:
            last += 1
        points, separations = face_corners(boxes[a[first]], boxes[b[first]], normal[first], 0.0)
        pair_size = _pair_size(boxes[a[first]], boxes[b[first]])
        for i in range(len(points)):
            listed = False
            for j in range(first, last):
                distance2 = 0.0
                for k in range(3):
                    distance2 += (points[i, k] - point[j, k]) ** 2
                listed = listed or distance2 < (SAME * pair_size) ** 2
            if not listed and abs(separations[i]) <= NEAR * pair_size:
                row[size], corner[size], gap[size] = first, points[i], separations[i]
                size += 1
        first = last
    return row[:size], corner[:size], gap[:size]


@numba.njit(cache=True)
def _neighbours(boxes: FloatArray, live: IntArray, listed: IntArray, way: float) -> list[tuple[int, int]]:
    """Return the pairs of a live box and a near box, without the pairs that the engine lists.

    A pair consists of two rows, the lower row first. The cost is O(boxes) per live box.

    Args:
        boxes: all boxes, shape (n, 13).
        live: rows of the live boxes, in rising order, shape (m,).
        listed: n a + b for each pair (a, b) that the engine lists, in rising order.
        way: distance [m] added to the greatest gap of a near pair.
    """
    found = [(0, 0) for _ in range(0)]
    for one in live:
        for other in range(len(boxes)):
            near = other != one
            gap = NEAR * _pair_size(boxes[one], boxes[other]) + way
            for k in range(3):  # written so that NaN, a row without a body, fails
                reach = boxes[one, REACH][k] + boxes[other, REACH][k] + gap
                near = near and abs(boxes[one, k] - boxes[other, k]) <= reach
            if not near:
                continue
            at = np.searchsorted(live, other)
            if other < one and at < len(live) and live[at] == other:
                continue  # skip the second occurrence of a pair of live boxes
            key = min(one, other) * len(boxes) + max(one, other)
            at = np.searchsorted(listed, key)
            if at == len(listed) or listed[at] != key:
                found.append((min(one, other), max(one, other)))
    return found


@numba.njit(cache=True)
def near_corners(
    boxes: FloatArray, live: IntArray, listed: IntArray, slack: float, way: float
) -> tuple[IntArray, IntArray, FloatArray, FloatArray, FloatArray]:
    """Return the corners of the contact areas of near boxes, without the pairs that the engine lists.

    Args:
        boxes: all boxes, shape (n, 13).
        live: rows of the live boxes, in rising order, shape (m,).
        listed: n a + b for each pair (a, b) that the engine lists, in rising order.
        slack: greatest sideways gap [m] of edges that meet, for the plank. Corners closer together than four times the
            slack count as one corner.
        way: distance [m] added to the greatest gap and overlap of a near pair, for bodies that have moved by that
            distance after they touched.

    Returns:
        Rows a (k,) and b (k,), corners (k, 3) [m], normals from a to b (k, 3), and gaps (k,) [m].
    """
    pairs = _neighbours(boxes, live, listed, way)
    room = _MOST_CORNERS * len(pairs)
    a, b, gap = np.empty(room, np.int64), np.empty(room, np.int64), np.empty(room)
    corner, normals = np.empty((room, 3)), np.empty((room, 3))
    normal = np.empty(3)
    size = 0
    for first, second in pairs:
        pair_size = _pair_size(boxes[first], boxes[second])
        near = NEAR * pair_size + way
        if abs(_parting_face(boxes[first], boxes[second], normal)) > near:
            continue
        points, separations = face_corners(boxes[first], boxes[second], normal, slack * pair_size)
        start = size
        for i in range(len(points)):
            is_new = True
            for j in range(start, size):
                distance2 = 0.0
                for k in range(3):
                    distance2 += (points[i, k] - corner[j, k]) ** 2
                is_new = is_new and distance2 >= (4 * slack * pair_size) ** 2
            if is_new and abs(separations[i]) <= near:
                a[size], b[size], gap[size] = first, second, separations[i]
                corner[size], normals[size] = points[i], normal
                size += 1
    return a[:size], b[:size], corner[:size], normals[:size], gap[:size]
