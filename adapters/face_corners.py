"""Corners of two boxes' contact faces that nearly touch, for engines that list penetrating points only.

Of a brick that rests on three corners, tilted by micrometres, such an engine lists three points: half of the true
contact area. Under load the fourth corner would carry as well. Other engines report it by a small gap; for the rest
it is found here from the boxes' geometry, by clipping one face by the other as the engines themselves do.
"""

from __future__ import annotations

import numba
import numpy as np

from stability_core.port import Contacts, FloatArray, IntArray

NEAR = 0.1e-3
"""Gap [m] up to which faces nearly touch: above the tilt of a brick at rest, below any visible distance."""
SAME = 1e-3
"""Distance [m] within which a corner is one that the engine has listed."""


@numba.njit(cache=True)
def _axes(quaternion: FloatArray) -> FloatArray:
    """Rotation matrix (3, 3) of a unit quaternion (w, x, y, z); its columns are the box's axes."""
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
    """The axis most along ``direction`` and its cosine, negative if it points the other way."""
    best, cosine = 0, 0.0
    for axis in range(3):
        along = axes[0, axis] * direction[0] + axes[1, axis] * direction[1] + axes[2, axis] * direction[2]
        if abs(along) > abs(cosine):
            best, cosine = axis, along
    return best, cosine


@numba.njit(cache=True)
def _clip(polygon: FloatArray, normal: FloatArray, limit: float) -> FloatArray:
    """The part (k, 3) of a polygon where normal . x <= limit (Sutherland and Hodgman)."""
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
    """Corners (4, 3) of a box's face, in order around it."""
    u, v = (axis + 1) % 3, (axis + 2) % 3
    corners = np.empty((4, 3))
    for i in range(4):
        along_u = half[u] if i in (0, 3) else -half[u]
        along_v = half[v] if i < 2 else -half[v]
        for k in range(3):
            corners[i, k] = center[k] + side * half[axis] * axes[k, axis] + along_u * axes[k, u] + along_v * axes[k, v]
    return corners


@numba.njit(cache=True)
def _corners(box_a: FloatArray, box_b: FloatArray, normal: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Corners (k, 3) of the contact face of two boxes, and their separations (k,); ``normal`` points from a to b."""
    axes_a, axes_b = _axes(box_a[3:7]), _axes(box_b[3:7])
    axis_a, cosine_a = _facing(axes_a, normal)
    axis_b, cosine_b = _facing(axes_b, -normal)
    a_is_reference = abs(cosine_a) >= abs(cosine_b)
    box, axes, axis, cosine = box_a, axes_a, axis_a, cosine_a
    other, other_axes = box_b, axes_b
    if not a_is_reference:
        box, axes, axis, cosine = box_b, axes_b, axis_b, cosine_b
        other, other_axes = box_a, axes_a
    outward = np.sign(cosine) * axes[:, axis]
    facing, facing_cosine = _facing(other_axes, -outward)
    polygon = _face(other[:3], other_axes, other[7:], facing, np.sign(facing_cosine))
    for side_axis in ((axis + 1) % 3, (axis + 2) % 3):
        side = axes[:, side_axis].copy()
        middle = side[0] * box[0] + side[1] * box[1] + side[2] * box[2]
        polygon = _clip(polygon, side, middle + box[7 + side_axis])
        polygon = _clip(polygon, -side, -middle + box[7 + side_axis])
    separation = np.empty(len(polygon))
    for i in range(len(polygon)):
        separation[i] = -box[7 + axis]
        for k in range(3):
            separation[i] += (polygon[i, k] - box[k]) * outward[k]
    return polygon, separation


@numba.njit(cache=True)
def _missing(
    box_a: FloatArray, box_b: FloatArray, normal: FloatArray, point: FloatArray, pair: IntArray
) -> tuple[IntArray, FloatArray, FloatArray]:
    """A row of its pair (k,), point (k, 3) and separation (k,) of each corner that is not listed.

    Rows of a pair stand together; boxes (n, 10) are centre, quaternion (w, x, y, z) and half edges.
    """
    n = len(pair)
    row, corner, gap = np.empty(8 * n, np.int64), np.empty((8 * n, 3)), np.empty(8 * n)
    size, first = 0, 0
    while first < n:
        last = first
        while last < n and pair[last] == pair[first]:
            last += 1
        points, separations = _corners(box_a[first], box_b[first], normal[first])
        for i in range(len(points)):
            listed = False
            for j in range(first, last):
                distance2 = 0.0
                for k in range(3):
                    distance2 += (points[i, k] - point[j, k]) ** 2
                listed = listed or distance2 < SAME**2
            if not listed and abs(separations[i]) <= NEAR:
                row[size], corner[size], gap[size] = first, points[i], separations[i]
                size += 1
        first = last
    return row[:size], corner[:size], gap[:size]


def with_missing_corners(contacts: Contacts, bodies: IntArray, boxes: FloatArray) -> Contacts:
    """The contacts, and behind them the corners of their faces that nearly touch and that the engine did not list.

    A corner has the normal and the relative velocity of its pair's first point.

    Args:
        contacts: at least one, as the engine lists them.
        bodies: every body that they name, rising, shape (m,).
        boxes: of each of these: centre [m], quaternion (w, x, y, z), half edges [m]; shape (m, 10).
    """
    a, b = np.searchsorted(bodies, contacts.body_a), np.searchsorted(bodies, contacts.body_b)
    order = np.argsort(a * len(bodies) + b, kind="stable")
    a, b = a[order], b[order]
    normal, point = contacts.normal[order], contacts.point[order]
    row, corner, gap = _missing(boxes[a], boxes[b], normal, point, a * len(bodies) + b)
    if not len(row):
        return contacts
    row = order[row]
    return Contacts(
        np.concatenate([contacts.body_a, contacts.body_a[row]]),
        np.concatenate([contacts.body_b, contacts.body_b[row]]),
        np.concatenate([contacts.point, corner]),
        np.concatenate([contacts.normal, contacts.normal[row]]),
        np.concatenate([contacts.separation, gap]),
        np.concatenate([contacts.relative_velocity, contacts.relative_velocity[row]]),
        np.concatenate([contacts.friction, contacts.friction[row]]),
    )


def prepare() -> None:
    """Compile the kernels, or read them from the cache, before any frame is timed."""
    stacked = np.array([[0.0, 0.0, z, 1.0, 0.0, 0.0, 0.0, 0.5, 0.5, 0.5] for z in (0.0, 1.0)])
    up, ids = np.array([[0.0, 0.0, 1.0]]), np.arange(2)
    with_missing_corners(Contacts(ids[:1], ids[1:], up / 2, up, np.zeros(1), up, np.zeros(1)), ids, stacked)
