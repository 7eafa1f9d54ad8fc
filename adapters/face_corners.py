"""The contact face of two boxes that touch or nearly touch: where it is, and what parts them there.

A box is a row of ``BoxTable``: centre, quaternion, half edges.
"""

from __future__ import annotations

import numba
import numpy as np

from stability_core.port import FloatArray

CENTER, TURN, HALF, REACH = slice(0, 3), slice(3, 7), slice(7, 10), slice(10, 13)
"""Columns of a box: centre [m], quaternion (w, x, y, z), half edges [m], and how far it reaches along x, y, z [m]."""


@numba.njit(cache=True)
def box_axes(quaternion: FloatArray) -> FloatArray:
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
def face_corners(box_a: FloatArray, box_b: FloatArray, normal: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Corners (k, 3) of the contact face of two boxes, and their separations (k,); ``normal`` points from a to b."""
    axes_a, axes_b = box_axes(box_a[TURN]), box_axes(box_b[TURN])
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
        polygon = _clip(polygon, side, middle + half[side_axis])
        polygon = _clip(polygon, -side, -middle + half[side_axis])
    separation = np.empty(len(polygon))
    for i in range(len(polygon)):
        separation[i] = -half[axis]
        for k in range(3):
            separation[i] += (polygon[i, k] - box[k]) * outward[k]
    return polygon, separation


@numba.njit(cache=True)
def parting_face(box_a: FloatArray, box_b: FloatArray, normal: FloatArray) -> float:
    """Gap [m] between two boxes across the face that parts them best, negative if they overlap.

    The face's unit normal is written into ``normal`` (3,), from a to b.
    """
    axes_a, axes_b = box_axes(box_a[TURN]), box_axes(box_b[TURN])
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
