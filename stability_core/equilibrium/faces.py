"""Find the rolling bodies of a snapshot: bodies that touch only in points and lines.

A rigid sphere on a floor has one contact point. If rounding moves this point off the vertical through the centre, no
force at the point balances the sphere. Therefore a moment of a rolling body may stay unbalanced: its weight times
``NOISE`` times its size (``Problem.slack``).
"""

from __future__ import annotations

import numpy as np

from stability_core.compiled import compiled
from stability_core.port import BoolArray, FloatArray, IntArray

NOISE = 1e-6
"""Ratio of a contact point's error to the size of the body: a few roundings of single precision."""
FACE_COSINE = 0.985
"""Cosine of the angle (10 deg) up to which the normals of one face may differ, because normals err by less (see
``compliance.NORMAL_NOISE``)."""


@compiled
def _has_area(point: FloatArray, rows: IntArray, tolerance: float) -> bool:
    """Return True if the points of ``rows`` span more than a point or a line, within a ``tolerance`` [m]."""
    first, longest = point[rows[0]], 0.0
    along = np.zeros(3)
    for row in rows:
        length = np.sqrt(((point[row] - first) ** 2).sum())
        if length > longest:
            longest = length
            along = (point[row] - first) / length
    for row in rows:
        away = point[row] - first
        across = away - (away * along).sum() * along
        if np.sqrt((across**2).sum()) > tolerance:
            return True
    return False


@compiled
def _mark_faces(
    order: IntArray,
    body_a: IntArray,
    body_b: IntArray,
    point: FloatArray,
    normal: FloatArray,
    tolerance: FloatArray,
) -> BoolArray:
    """Return the mask of the contacts that belong to a face with an area, shape (m,).

    Args:
        order: the contacts, sorted by pair, shape (m,).
        body_a: first bodies, shape (m,).
        body_b: second bodies, shape (m,).
        point: contact points [m], shape (m, 3).
        normal: unit normals, shape (m, 3).
        tolerance: error of each point [m], shape (m,).
    """
    m = len(order)
    is_area = np.empty(m, np.bool_)
    is_done = np.zeros(m, np.bool_)
    rows = np.empty(m, np.int64)
    for i in range(m):
        if is_done[i]:
            continue
        first, count = order[i], 0
        j = i
        while j < m and body_a[order[j]] == body_a[first] and body_b[order[j]] == body_b[first]:
            if not is_done[j] and (normal[order[j]] * normal[first]).sum() >= FACE_COSINE:
                is_done[j] = True
                rows[count] = order[j]
                count += 1
            j += 1
        has_area = _has_area(point, rows[:count], tolerance[first])
        for row in rows[:count]:
            is_area[row] = has_area
    return is_area


def rolling_bodies(
    index_a: IntArray, index_b: IntArray, point: FloatArray, normal: FloatArray, size: FloatArray
) -> BoolArray:
    """Return the mask of the bodies that touch only in points and lines, or not at all, shape (n,).

    The cost is O(m log m) for m contacts, and O(k^2) for the k points of each pair.

    Args:
        index_a: first bodies by their index, -1 for the ground, shape (m,).
        index_b: second bodies, shape (m,).
        point: contact points [m], shape (m, 3).
        normal: unit normals from a to b, shape (m, 3).
        size: size of each body [m], then infinity for the ground, shape (n + 1,).
    """
    tolerance = NOISE * np.minimum(size[index_a], size[index_b])
    point, normal = np.ascontiguousarray(point, np.float64), np.ascontiguousarray(normal, np.float64)
    is_area = _mark_faces(np.lexsort((index_b, index_a)), index_a, index_b, point, normal, tolerance)
    rolls = np.ones(len(size), np.bool_)
    rolls[index_a[is_area]] = rolls[index_b[is_area]] = False
    return rolls[:-1]
