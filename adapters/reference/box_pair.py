"""Contact points of two boxes: separating axes, and clipping of faces.

Separating axes: the three face normals of each box, and the nine cross products of their edges. The axis with the
greatest separation gives the normal. In a tie a face of the first box wins, then a face of the second box. Where two
boxes touch along parallel edges, the cross product vanishes, so that the normal is a face normal. Therefore an inverted
V stands only if its planks are steeper than 90 deg minus the friction angle (``Capabilities.ridge_normal``).

Points: the reference face belongs to the box whose face gives the normal. The sides of the reference face clip the face
of the other box that is most antiparallel to the normal (Sutherland and Hodgman). Two crossing edges have one point, in
the middle of the common perpendicular of both edges.
"""

from __future__ import annotations

import math

import numba
import numpy as np

from stability_core.port import FloatArray

FACE_PREFERENCE = 1e-5
"""Separation [m] by which a later axis must exceed an earlier axis, so that rounding errors do not change the normal of
boxes at rest. A box rocks by less between two frames."""
PARALLEL = 1e-3
"""Sine of the angle between two edges below which their cross product is not an axis. The direction of the product is
then mostly a rounding error."""
SAME_POINT = 1e-6
"""Distance [m] below which two points of a pair are one point."""

MOST_POINTS = 8
"""Greatest number of points of a pair, because each of four cuts adds at most one corner to a face."""


@numba.njit(cache=True)
def dot(a: FloatArray, b: FloatArray) -> float:
    """Return the scalar product of vectors (3,)."""
    return float(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


@numba.njit(cache=True)
def axes_of(q: FloatArray) -> FloatArray:
    """Return the box's axes (3, 3), as rows, of a unit quaternion (w, x, y, z)."""
    w, x, y, z = q[0], q[1], q[2], q[3]
    axes = np.empty((3, 3))
    axes[0, 0], axes[0, 1], axes[0, 2] = 1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)
    axes[1, 0], axes[1, 1], axes[1, 2] = 2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)
    axes[2, 0], axes[2, 1], axes[2, 2] = 2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)
    return axes


@numba.njit(cache=True)
def collide(
    center_a: FloatArray,
    axes_a: FloatArray,
    half_a: FloatArray,
    center_b: FloatArray,
    axes_b: FloatArray,
    half_b: FloatArray,
    lengths: FloatArray,
    corner: FloatArray,
    depth: FloatArray,
    normal: FloatArray,
) -> int:
    """Write points, gaps and the normal of two boxes; return the number of points.

    Args:
        center_a: centre of box a [m].
        axes_a: axes of box a, as rows.
        half_a: half edges of box a [m].
        center_b: centre of box b [m].
        axes_b: axes of box b, as rows.
        half_b: half edges of box b [m].
        lengths: ``detector.SLACK``, ``FACE_PREFERENCE`` and ``SAME_POINT``, times the scale of the world.
        corner: receives the points, shape (8, 3).
        depth: receives the gaps, shape (8,).
        normal: receives the unit normal from a to b, shape (3,).
    """
    between = center_b - center_a
    face_a, gap_a = _widest_face(between, axes_a, half_a, axes_b, half_b, lengths[1])
    face_b, gap_b = _widest_face(between, axes_b, half_b, axes_a, half_a, lengths[1])
    gap = gap_b if gap_b > gap_a + lengths[1] else gap_a
    edge_a, edge_b, depth[0] = _widest_edges(between, axes_a, half_a, axes_b, half_b, gap + lengths[1], normal)
    if edge_a >= 0:
        _write_edge_point(center_a, axes_a, half_a, center_b, axes_b, half_b, edge_a, edge_b, normal, corner[0])
        return 1
    if gap == gap_a:
        sign = 1.0 if dot(between, axes_a[face_a]) >= 0.0 else -1.0
        normal[:] = sign * axes_a[face_a]
        return _clip_face(center_a, axes_a, half_a, center_b, axes_b, half_b, face_a, sign, lengths[2], corner, depth)
    sign = 1.0 if dot(between, axes_b[face_b]) >= 0.0 else -1.0
    normal[:] = sign * axes_b[face_b]
    return _clip_face(center_b, axes_b, half_b, center_a, axes_a, half_a, face_b, -sign, lengths[2], corner, depth)


@numba.njit(cache=True)
def _widest_face(
    between: FloatArray, axes: FloatArray, half: FloatArray, other_axes: FloatArray, other_half: FloatArray, tie: float
) -> tuple[int, float]:
    """Return the axis of a box along which both boxes are farthest apart, and their separation [m] along it."""
    best, gap = 0, -np.inf
    for i in range(3):
        separation = abs(dot(between, axes[i])) - half[i]
        for j in range(3):
            separation -= other_half[j] * abs(dot(axes[i], other_axes[j]))
        if separation > gap + tie:
            best, gap = i, separation
    return best, gap


@numba.njit(cache=True)
def _widest_edges(
    between: FloatArray,
    axes_a: FloatArray,
    half_a: FloatArray,
    axes_b: FloatArray,
    half_b: FloatArray,
    least: float,
    normal: FloatArray,
) -> tuple[int, int, float]:
    """Return the edges whose cross product separates both boxes most, and the separation [m].

    If no cross product separates the boxes by more than ``least`` [m], the edges are -1, and the separation is
    ``least``. Otherwise the function also writes the unit normal (3,) from a to b.
    """
    edge_a, edge_b = -1, -1
    cross = np.empty(3)
    for i in range(3):
        for j in range(3):
            u, v = axes_a[i], axes_b[j]
            cross[0], cross[1] = u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2]
            cross[2] = u[0] * v[1] - u[1] * v[0]
            size = math.sqrt(dot(cross, cross))
            if size < PARALLEL:
                continue
            along = dot(between, cross)
            separation = abs(along)
            for k in range(3):
                separation -= half_a[k] * abs(dot(axes_a[k], cross)) + half_b[k] * abs(dot(axes_b[k], cross))
            if separation / size > least:
                edge_a, edge_b, least = i, j, separation / size
                for k in range(3):
                    normal[k] = (cross[k] if along >= 0.0 else -cross[k]) / size
    return edge_a, edge_b, least


@numba.njit(cache=True)
def _write_edge_point(
    center_a: FloatArray,
    axes_a: FloatArray,
    half_a: FloatArray,
    center_b: FloatArray,
    axes_b: FloatArray,
    half_b: FloatArray,
    edge_a: int,
    edge_b: int,
    normal: FloatArray,
    point: FloatArray,
) -> None:
    """Write the middle (3,) of the common perpendicular of the two edges that face each other."""
    p, q = center_a.copy(), center_b.copy()
    for i in range(3):
        if i != edge_a:
            side = half_a[i] if dot(axes_a[i], normal) > 0.0 else -half_a[i]
            p += side * axes_a[i]
        if i != edge_b:
            side = -half_b[i] if dot(axes_b[i], normal) > 0.0 else half_b[i]
            q += side * axes_b[i]
    u, v = axes_a[edge_a], axes_b[edge_b]
    w = q - p
    cosine = dot(u, v)
    along_u, along_v = dot(w, u), dot(w, v)
    divisor = 1.0 - cosine * cosine
    s = (along_u - cosine * along_v) / divisor
    t = (cosine * along_u - along_v) / divisor
    for k in range(3):
        point[k] = 0.5 * (p[k] + s * u[k] + q[k] + t * v[k])


@numba.njit(cache=True)
def _clip_face(
    center: FloatArray,
    axes: FloatArray,
    half: FloatArray,
    other_center: FloatArray,
    other_axes: FloatArray,
    other_half: FloatArray,
    axis: int,
    sign: float,
    same: float,
    corner: FloatArray,
    depth: FloatArray,
) -> int:
    """Clip the other box's facing face by a reference face; write points and gaps, and return the number of points."""
    direction = sign * axes[axis]
    polygon, cut = np.empty((16, 3)), np.empty((16, 3))
    _write_facing_face(other_center, other_axes, other_half, direction, polygon)
    n = 4
    for other in range(1, 3):
        side = (axis + other) % 3
        middle = dot(axes[side], center)
        for way in (-1.0, 1.0):
            n = _cut(polygon, n, way * axes[side], half[side] + way * middle, cut)
            polygon[:n] = cut[:n]
    level = dot(direction, center) + half[axis]
    points = 0
    for i in range(n):
        gap = dot(direction, polygon[i]) - level
        spot = polygon[i] - 0.5 * gap * direction
        is_new = True
        for k in range(points):
            apart = spot - corner[k]
            is_new &= dot(apart, apart) >= same * same
        if is_new and points < MOST_POINTS:
            corner[points], depth[points] = spot, gap
            points += 1
    return points


@numba.njit(cache=True)
def _write_facing_face(
    center: FloatArray, axes: FloatArray, half: FloatArray, direction: FloatArray, polygon: FloatArray
) -> None:
    """Write the four corners of the face whose outer normal is most antiparallel to ``direction``."""
    facing, cosine = 0, 0.0
    for j in range(3):
        along = dot(axes[j], direction)
        if abs(along) > abs(cosine):
            facing, cosine = j, along
    side = -half[facing] if cosine > 0.0 else half[facing]
    u, v = (facing + 1) % 3, (facing + 2) % 3
    for i in range(4):
        along_u = half[u] if i in (0, 3) else -half[u]
        along_v = half[v] if i < 2 else -half[v]
        for k in range(3):
            polygon[i, k] = center[k] + side * axes[facing, k] + along_u * axes[u, k] + along_v * axes[v, k]


@numba.njit(cache=True)
def _cut(polygon: FloatArray, n: int, across: FloatArray, limit: float, cut: FloatArray) -> int:
    """Write the part of a polygon of n corners where across . x <= limit; return its number of corners."""
    size = 0
    for i in range(n):
        here, there = polygon[i], polygon[(i + 1) % n]
        out_here, out_there = dot(across, here) - limit, dot(across, there) - limit
        if out_here <= 0.0:
            cut[size] = here
            size += 1
        if out_here * out_there < 0.0:
            cut[size] = here + out_here / (out_here - out_there) * (there - here)
            size += 1
    return size
