"""Contact points at the start of a substep, moved with the bodies to the end of the substep.

A body has the pose (x, q) before the substep, and (x', q') after the substep. A point p on the body moves to

    p' = x' + r (p - x),   r = q' q^-1 as a rotation,

and the normal n turns to n' with body a. The separation at the end of the substep is (p_b' - p_a') . n'.
"""

from __future__ import annotations

import numba
import numpy as np

from stability_core.port import FloatArray, IntArray


def carried(
    rows: FloatArray, bodies: IntArray, before: FloatArray, after: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return points midway between both bodies (n, 3) [m], normals (n, 3) and separations (n,) [m] after a substep.

    Args:
        rows: contact points at the poses ``before``: bodies a and b, points on a and b, normal, force, shape (n, 14).
        bodies: ids of the bodies that may move, in rising order, shape (m,); all other bodies are at rest.
        before: states of ``bodies`` before the substep, shape (m, 13).
        after: states of ``bodies`` after the substep, shape (m, 13); if equal to ``before``, no point moves.
    """
    points, normals, separations = np.empty((len(rows), 3)), np.empty((len(rows), 3)), np.empty(len(rows))
    _carry(rows, bodies, before, after, points, normals, separations)
    return points, normals, separations


@numba.njit("void(float64[:], float64[:], float64[:], float64[:], float64[:])", cache=True)
def _turned(first: FloatArray, second: FloatArray, vector: FloatArray, center: FloatArray, out: FloatArray) -> None:
    """Turn the offset of a point from ``center`` with a body, and write the result into ``out``.

    Args:
        first: quaternion (w, x, y, z) of the body before the turn, shape (4,).
        second: quaternion (w, x, y, z) of the body after the turn, shape (4,).
        vector: the point, shape (3,).
        center: centre of the turn, shape (3,).
        out: output, shape (3,).
    """
    w = second[0] * first[0] + second[1] * first[1] + second[2] * first[2] + second[3] * first[3]
    x = -second[0] * first[1] + second[1] * first[0] - second[2] * first[3] + second[3] * first[2]
    y = -second[0] * first[2] + second[1] * first[3] + second[2] * first[0] - second[3] * first[1]
    z = -second[0] * first[3] - second[1] * first[2] + second[2] * first[1] + second[3] * first[0]
    vx, vy, vz = vector[0] - center[0], vector[1] - center[1], vector[2] - center[2]
    tx, ty, tz = 2.0 * (y * vz - z * vy), 2.0 * (z * vx - x * vz), 2.0 * (x * vy - y * vx)
    out[0] = vx + w * tx + y * tz - z * ty
    out[1] = vy + w * ty + z * tx - x * tz
    out[2] = vz + w * tz + x * ty - y * tx


@numba.njit(
    "void(float64[:, :], int64[:], float64[:, :], float64[:, :], float64[:, :], float64[:, :], float64[:])", cache=True
)
def _carry(
    rows: FloatArray,
    bodies: IntArray,
    before: FloatArray,
    after: FloatArray,
    points: FloatArray,
    normals: FloatArray,
    separations: FloatArray,
) -> None:
    """Write the results of ``carried`` into ``points``, ``normals`` and ``separations``."""
    origin, on, turned = np.zeros(3), np.empty((2, 3)), np.empty(3)
    for row in range(len(rows)):
        normal = rows[row, 8:11].copy()
        for side in range(2):
            point = rows[row, 2 + 3 * side : 5 + 3 * side]
            on[side] = point
            body = rows[row, side]
            k = np.searchsorted(bodies, body)
            if k == len(bodies) or bodies[k] != body:
                continue  # frozen, a fixed box or the ground
            first, second = before[k, 3:7], after[k, 3:7]
            _turned(first, second, point, before[k, 0:3], turned)
            on[side] = after[k, 0:3] + turned
            if side == 0:
                _turned(first, second, rows[row, 8:11], origin, normal)
        for axis in range(3):
            points[row, axis] = (on[0, axis] + on[1, axis]) / 2
            normals[row, axis] = normal[axis]
        separations[row] = np.sum((on[1] - on[0]) * normal)
