"""Detection of bodies that will collide within the next frames, by geometry and in the same way for every engine.

Engines list pairs up to a gap of 0 to 20 mm, but a body at 10 m/s moves 167 mm per frame. The body may therefore
collide between two readings of the contacts. This module sweeps the boxes of fast bodies along their velocities. Two
boxes have 15 separating axes n: 3 face normals of each box, and 9 cross products of edges. Let d be the vector between
the centres, and r_a and r_b the half widths along n. The translating boxes meet when the last gap closes:

    gap(n) = |d . n| - r_a(n) - r_b(n),    t(n) = gap(n) / closing speed along n,    t = max over n of t(n)

if no gap opens again before t. The axis of the last gap is the normal. The module neglects rotation and gravity within
these frames.
"""

from __future__ import annotations

import math

import numba
import numpy as np

from adapters.shared.box_contacts import CENTER, HALF, PLANK, REACH, TURN, axes_of, face_corners, half_diagonal
from stability_core.port import FloatArray, IntArray

HORIZON = 2.0
"""Number of frames for which the module predicts collisions, because the policy needs one frame to unfreeze the body
that will be struck, and the collision may occur within the next step."""
FAST = 0.2
"""Least speed [m/s] at which the module sweeps a plank: twice the speed after a fall of 0.5 mm. A sweep is necessary,
because at this speed the plank moves 3 mm per frame, beyond the gaps that engines list. For other bricks the module
multiplies the speed by the square root of the ratio of their size to the size of a plank."""
LEVEL = 0.05
"""Greatest ratio of a corner's depth behind the foremost corner to the smaller box's half diagonal at which the corner
counts for the contact point, so that all corners of a face that strikes flat count."""
PARALLEL = 1e-6
"""Squared length of the cross product of two unit edges below which the edges are parallel and define no axis."""

Approaches = tuple[IntArray, IntArray, FloatArray, FloatArray, FloatArray]


@numba.njit(cache=True)
def _extent(axes: FloatArray, half: FloatArray, normal: FloatArray) -> float:
    """Return half the width [m] of a box along the unit vector ``normal`` (3,)."""
    width = 0.0
    for axis in range(3):
        width += abs(axes[0, axis] * normal[0] + axes[1, axis] * normal[1] + axes[2, axis] * normal[2]) * half[axis]
    return width


@numba.njit(cache=True)
def _separating_axis(axes_a: FloatArray, axes_b: FloatArray, k: int, axis: FloatArray) -> bool:
    """Write the unit separating axis with index k of 15 into ``axis`` (3,); return False if its edges are parallel."""
    if k < 3:
        axis[:] = axes_a[:, k]
        return True
    if k < 6:
        axis[:] = axes_b[:, k - 3]
        return True
    u, v = axes_a[:, (k - 6) // 3], axes_b[:, (k - 6) % 3]
    axis[0] = u[1] * v[2] - u[2] * v[1]
    axis[1] = u[2] * v[0] - u[0] * v[2]
    axis[2] = u[0] * v[1] - u[1] * v[0]
    length2 = axis[0] ** 2 + axis[1] ** 2 + axis[2] ** 2
    if length2 < PARALLEL:
        return False
    axis /= math.sqrt(length2)
    return True


@numba.njit(cache=True)
def _impact(
    box_a: FloatArray, box_b: FloatArray, velocity: FloatArray, most: float, normal: FloatArray
) -> tuple[float, float, bool]:
    """Return the time [s] until two boxes meet, the gap along the last axis, and whether that axis is a face normal.

    Write the axis that closes last, from a to b, into ``normal`` (3,).

    Args:
        box_a: row of box a, shape (13,).
        box_b: row of box b, shape (13,).
        velocity: velocity [m/s] of b relative to a, shape (3,).
        most: time limit [s].
        normal: output, shape (3,).

    Returns:
        Three values:

        - the time [s], inf if the boxes do not meet within ``most`` or already overlap;
        - the present gap [m];
        - True if the axis is the normal of a face.
    """
    axes_a, axes_b = axes_of(box_a[TURN]), axes_of(box_b[TURN])
    between = box_b[CENTER] - box_a[CENTER]
    enter, leave, gap_then, is_face = 0.0, most, -1.0, True
    axis = np.empty(3)
    for k in range(15):
        if not _separating_axis(axes_a, axes_b, k, axis):
            continue
        distance = between[0] * axis[0] + between[1] * axis[1] + between[2] * axis[2]
        speed = velocity[0] * axis[0] + velocity[1] * axis[1] + velocity[2] * axis[2]
        if distance < 0.0:
            distance, speed = -distance, -speed
            axis *= -1.0
        width = _extent(axes_a, box_a[HALF], axis) + _extent(axes_b, box_b[HALF], axis)
        gap = distance - width
        if gap > 0.0:
            if speed >= 0.0:
                return np.inf, 0.0, True
            if gap / -speed >= enter:
                enter, gap_then, is_face = gap / -speed, gap, k < 6
                normal[:] = axis
        if speed != 0.0:
            leave = min(leave, (width - distance) / speed if speed > 0.0 else (width + distance) / -speed)
    if gap_then <= 0.0 or enter > leave:
        return np.inf, 0.0, True
    return enter, gap_then, is_face


@numba.njit(cache=True)
def _edge_towards(box: FloatArray, direction: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the middle (3,) [m] and the unit axis (3,) of the edge of a box that lies farthest along ``direction``.

    The axis is the box's axis that is most nearly perpendicular to the direction.
    """
    axes = axes_of(box[TURN])
    across, least = 0, np.inf
    middle = box[CENTER].copy()
    for axis in range(3):
        along = axes[0, axis] * direction[0] + axes[1, axis] * direction[1] + axes[2, axis] * direction[2]
        if abs(along) < least:
            across, least = axis, abs(along)
    for axis in range(3):
        if axis != across:
            along = axes[0, axis] * direction[0] + axes[1, axis] * direction[1] + axes[2, axis] * direction[2]
            middle += np.sign(along) * box[HALF][axis] * axes[:, axis]
    return middle, axes[:, across].copy()


@numba.njit(cache=True)
def _crossing(box_a: FloatArray, box_b: FloatArray, normal: FloatArray) -> FloatArray:
    """Return the point (3,) [m] on the foremost edge of box a that is nearest to the foremost edge of box b."""
    p, u = _edge_towards(box_a, normal)
    q, v = _edge_towards(box_b, -normal)
    w = q - p
    cosine = u[0] * v[0] + u[1] * v[1] + u[2] * v[2]
    along_u = w[0] * u[0] + w[1] * u[1] + w[2] * u[2]
    along_v = w[0] * v[0] + w[1] * v[1] + w[2] * v[2]
    sine2 = max(1.0 - cosine * cosine, PARALLEL)
    nearest: FloatArray = p + (along_u - cosine * along_v) / sine2 * u
    return nearest


@numba.njit(cache=True)
def _meeting_point(box_a: FloatArray, box_b: FloatArray, normal: FloatArray, is_face: bool, slack: float) -> FloatArray:
    """Return the middle (3,) [m] of the contact area of two boxes that just touch along ``normal``."""
    if not is_face:
        return _crossing(box_a, box_b, normal)
    points, separations = face_corners(box_a, box_b, normal, slack)
    if not len(points):
        return _crossing(box_a, box_b, normal)
    middle, count = np.zeros(3), 0
    for i in range(len(points)):
        if separations[i] <= separations.min() + slack:
            middle += points[i]
            count += 1
    middle /= count
    return middle


@numba.njit(cache=True)
def approaches(
    boxes: FloatArray,
    velocity: FloatArray,
    fast: IntArray,
    is_live: np.typing.NDArray[np.bool_],
    listed: IntArray,
    first: int,
    seconds: float,
) -> Approaches:
    """Return the pairs of bodies that will meet within ``seconds``, each with one contact point.

    The cost is O(boxes) per fast body.

    Args:
        boxes: all boxes, shape (n, 13).
        velocity: velocities of the boxes [m/s], shape (n, 3).
        fast: rows of the bodies to sweep, in rising order, shape (m,).
        is_live: whether the body of each row is live, shape (n,); a pair needs at least one live body.
        listed: n a + b for each pair (a, b), a < b, that has contacts already, in rising order.
        first: row of the first body. The function skips the earlier rows, of the ground and the fixed boxes.
        seconds: time within which the pairs meet.

    Returns:
        Five arrays:

        - rows a, shape (k,);
        - rows b, of the fast bodies, shape (k,);
        - points on the present surface of a [m], shape (k, 3);
        - normals from a to b, shape (k, 3);
        - present gaps [m], shape (k,).
    """
    n = len(boxes)
    found = [(0, 0) for _ in range(0)]
    numbers = [np.empty(7) for _ in range(0)]
    normal = np.empty(3)
    for one in fast:
        for other in range(first, n):
            relative = velocity[one] - velocity[other]
            near = other != one and (is_live[one] or is_live[other])
            for k in range(3):  # written so that NaN, a row without a body, fails
                reach = boxes[one, REACH][k] + boxes[other, REACH][k]
                here = boxes[one, k] - boxes[other, k]
                there = here + relative[k] * seconds
                near = near and min(here, there) <= reach and max(here, there) >= -reach
            if not near:
                continue
            at = np.searchsorted(fast, other)
            if other < one and at < len(fast) and fast[at] == other:
                continue  # skip the second occurrence of a pair of fast bodies
            key = min(one, other) * n + max(one, other)
            at = np.searchsorted(listed, key)
            if at < len(listed) and listed[at] == key:
                continue
            time, gap, is_face = _impact(boxes[other], boxes[one], relative, seconds, normal)
            if time > seconds:
                continue
            met = boxes[one].copy()
            met[CENTER] += relative * time
            size = min(half_diagonal(boxes[one, HALF]), half_diagonal(boxes[other, HALF]))
            point = _meeting_point(boxes[other], met, normal, is_face, LEVEL * size)
            row = np.empty(7)
            row[:3], row[3:6], row[6] = point, normal, gap
            found.append((other, one))
            numbers.append(row)
    a, b, gap_of = np.empty(len(found), np.int64), np.empty(len(found), np.int64), np.empty(len(found))
    points, normals = np.empty((len(found), 3)), np.empty((len(found), 3))
    for k in range(len(found)):
        a[k], b[k] = found[k]
        points[k], normals[k], gap_of[k] = numbers[k][:3], numbers[k][3:6], numbers[k][6]
    return a, b, points, normals, gap_of


def fast_rows(half: FloatArray, velocity: FloatArray) -> IntArray:
    """Return the indices of the bodies that are fast enough for a sweep.

    Args:
        half: half edges [m], shape (m, 3).
        velocity: velocities [m/s], shape (m, 3).
    """
    speed2 = np.einsum("ij,ij->i", velocity, velocity)
    if not (speed2 > 0.0).any():
        return np.empty(0, np.int64)
    size = np.sqrt(np.einsum("ij,ij->i", half, half)) / PLANK
    return np.flatnonzero(speed2 > FAST * FAST * size)
