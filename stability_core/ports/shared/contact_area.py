"""Corners of contact areas that an engine does not list, for two convex bodies with known vertices.

Some engines list penetrating points only, often three of a face's four corners, or one point per step. Under load the
missing corners would bear force as well. This module completes the contacts of a pair at the normal that the engine
lists. With heights along the normal:

1. Select the vertices of body a near its greatest height, and the vertices of body b near its least height, within a
   tolerance.
2. Project both sets along the normal. Their convex hulls are the faces, edges or vertices that face each other.
3. Intersect the hulls. The corners of the intersection are the corners of the contact area.
4. Fit a plane to the heights of each set. The gap at a corner differs from the gap at the listed point by the
   difference of the planes. Therefore an engine's collision margin cancels out.

The result includes a corner only if its gap is about the gap of the deepest listed point. A body without vertices is a
half space, such as the ground.
"""

from __future__ import annotations

import math

import numba
import numpy as np

from stability_core.port import FloatArray, IntArray

NEAR = 1.67e-3
"""Greatest difference of a corner's gap from the gap at the deepest point [half diagonals of the smaller body]. For a
plank of 117 mm, the value is 0.1 mm. This length exceeds the differences below a tilted body at rest."""
UPRIGHT = 0.9
"""Least cosine of the angle between a cylinder's axis and the normal at which the vertices of its rims represent the
cylinder. A cylinder on its side touches along a line and rolls, but the polygon of its rim has flat sides."""
SAME = 1.67e-2
"""Greatest distance between a corner and a listed point for the same point [half diagonals of the smaller body]."""
_DEGENERATE = 1e-12
"""Area [m2] or squared length [m2] below which points coincide or lie on a line."""


@numba.njit(cache=True)
def _next_corner(points: FloatArray, here: int) -> int:
    """Return the row of the point after row ``here`` on the convex hull, counter-clockwise; -1 if all coincide."""
    there = -1
    for i in range(len(points)):
        dx, dy = points[i, 0] - points[here, 0], points[i, 1] - points[here, 1]
        length2 = dx * dx + dy * dy
        if length2 <= _DEGENERATE:
            continue
        if there < 0:
            there = i
            continue
        ex, ey = points[there, 0] - points[here, 0], points[there, 1] - points[here, 1]
        turn = ex * dy - ey * dx
        if turn < -_DEGENERATE or (turn <= _DEGENERATE and length2 > ex * ex + ey * ey):
            there = i
    return there


@numba.njit(cache=True)
def _hull(points: FloatArray) -> FloatArray:
    """Return the convex hull (k, 3) of points (n, 3) by their first two columns, counter-clockwise (gift wrapping)."""
    n = len(points)
    first = 0
    for i in range(1, n):
        if points[i, 0] < points[first, 0] or (points[i, 0] == points[first, 0] and points[i, 1] < points[first, 1]):
            first = i
    hull = np.empty((n, 3))
    size, here = 0, first
    while size < n:
        for k in range(3):
            hull[size, k] = points[here, k]
        size += 1
        here = _next_corner(points, here)
        if here < 0:
            break
        dx, dy = points[here, 0] - points[first, 0], points[here, 1] - points[first, 1]
        if dx * dx + dy * dy <= _DEGENERATE:
            break
    return hull[:size]


@numba.njit(cache=True)
def _cut(polygon: FloatArray, x: float, y: float, nx: float, ny: float) -> FloatArray:
    """Return the part (k, 3) of a polygon (n, 3) where (p - (x, y)) . (nx, ny) <= 0 (Sutherland and Hodgman)."""
    n = len(polygon)
    kept = np.empty((2 * n + 2, 3))
    size = 0
    for i in range(n):
        j = (i + 1) % n
        depth = (polygon[i, 0] - x) * nx + (polygon[i, 1] - y) * ny
        next_depth = (polygon[j, 0] - x) * nx + (polygon[j, 1] - y) * ny
        if depth <= 0.0:
            for k in range(3):
                kept[size, k] = polygon[i, k]
            size += 1
        if depth * next_depth < 0.0:
            part = depth / (depth - next_depth)
            for k in range(3):
                kept[size, k] = polygon[i, k] + part * (polygon[j, k] - polygon[i, k])
            size += 1
    return kept[:size]


@numba.njit(cache=True)
def _intersection(polygon: FloatArray, window: FloatArray) -> FloatArray:
    """Return the part (k, 3) of a polygon, a line or a point (n, 3) inside a convex window; k = 0 without such a part.

    The corners of the ``window`` (m, 3), m >= 3, are counter-clockwise. The function shifts each edge of the window
    outwards by 1e-6 of its length, so that rounding removes no corner on an edge.
    """
    for i in range(len(window)):
        x, y = window[i, 0], window[i, 1]
        dx, dy = window[(i + 1) % len(window), 0] - x, window[(i + 1) % len(window), 1] - y
        length = math.sqrt(dx * dx + dy * dy)
        if length > 0.0 and len(polygon):
            polygon = _cut(polygon, x + 1e-6 * dy, y - 1e-6 * dx, dy / length, -dx / length)
    return polygon


@numba.njit(cache=True)
def _slope(hull: FloatArray) -> tuple[float, float]:
    """Return the slopes (gx, gy) of the heights c + gx x + gy y fitted to the corners of a hull by least squares.

    The slope across a line is 0. Both slopes of a point are 0.
    """
    n = len(hull)
    mx, my, mh = 0.0, 0.0, 0.0
    for i in range(n):
        mx, my, mh = mx + hull[i, 0] / n, my + hull[i, 1] / n, mh + hull[i, 2] / n
    xx, xy, yy, xh, yh = 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(n):
        x, y, h = hull[i, 0] - mx, hull[i, 1] - my, hull[i, 2] - mh
        xx, xy, yy, xh, yh = xx + x * x, xy + x * y, yy + y * y, xh + x * h, yh + y * h
    gx, gy = 0.0, 0.0
    determinant = xx * yy - xy * xy
    if n >= 3 and determinant > 1e-9 * (xx + yy) ** 2:
        gx, gy = (yy * xh - xy * yh) / determinant, (xx * yh - xy * xh) / determinant
    elif n >= 2:  # a line: no slope across the line
        gx, gy = xh / (xx + yy), yh / (xx + yy)
    return gx, gy


@numba.njit(cache=True)
def _facing(vertices: FloatArray, frame: FloatArray, sign: float, tolerance: float) -> FloatArray:
    """Return the hull (k, 3) of the vertices that face along ``sign`` times the last row of ``frame``.

    Args:
        vertices: vertices [m] in the world's frame, shape (n, 3).
        frame: two tangents and the normal, one per row.
        sign: 1 for the greatest heights, -1 for the least.
        tolerance: greatest difference of heights [m].
    """
    local = np.empty((len(vertices), 3))
    top = -np.inf
    for i in range(len(vertices)):
        for k in range(3):
            local[i, k] = vertices[i, 0] * frame[k, 0] + vertices[i, 1] * frame[k, 1] + vertices[i, 2] * frame[k, 2]
        top = max(top, sign * local[i, 2])
    size = 0
    for i in range(len(vertices)):
        if sign * local[i, 2] >= top - tolerance:
            for k in range(3):
                local[size, k] = local[i, k]
            size += 1
    return _hull(local[:size])


@numba.njit(cache=True)
def _frame(normal: FloatArray) -> FloatArray:
    """Return a right-handed frame: two tangents and the normal, one per row."""
    x, y, z = normal[0], normal[1], normal[2]
    if abs(z) < 0.7:  # the tangent is horizontal, or in the plane x, z
        length = math.sqrt(x * x + y * y)
        u, v, w = -y / length, x / length, 0.0
    else:
        length = math.sqrt(x * x + z * z)
        u, v, w = z / length, 0.0, -x / length
    return np.array([[u, v, w], [y * w - z * v, z * u - x * w, x * v - y * u], [x, y, z]])


@numba.njit(cache=True)
def _placed(vertices: FloatArray, pose: FloatArray) -> FloatArray:
    """Return vertices (n, 3) [m] of a body in the world's frame; ``pose``: position, then quaternion (x, y, z, w)."""
    x, y, z, w = pose[3], pose[4], pose[5], pose[6]
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
    placed = np.empty(vertices.shape)
    for i in range(len(vertices)):
        for k in range(3):
            placed[i, k] = pose[k]
            for j in range(3):
                placed[i, k] += turn[k, j] * vertices[i, j]
    return placed


@numba.njit(cache=True)
def _stands(axis: FloatArray, pose: FloatArray, normal: FloatArray) -> bool:
    """Return False for a cylinder that touches with its side at a contact normal, otherwise True.

    The ``axis`` (3,) is a unit vector in the body's own frame, or zero for a body that is no cylinder.
    """
    if axis[0] == 0.0 and axis[1] == 0.0 and axis[2] == 0.0:
        return True
    ends = _placed(np.array([[0.0, 0.0, 0.0], [axis[0], axis[1], axis[2]]]), pose)
    along = 0.0
    for k in range(3):
        along += (ends[1, k] - ends[0, k]) * normal[k]
    return abs(along) >= UPRIGHT


@numba.njit(cache=True)
def area_corners(
    vertices_a: FloatArray, vertices_b: FloatArray, normal: FloatArray, point: FloatArray, gap: float, near: float
) -> tuple[FloatArray, FloatArray]:
    """Return the corners (k, 3) [m] of the contact area of two convex bodies, and their gaps (k,) [m].

    The result omits corners whose gap differs from ``gap`` by more than ``near``. Two edges that cross have no corners,
    because these edges meet in the listed point.

    Args:
        vertices_a: vertices of body a in the world's frame, shape (m, 3); m = 0 for a half space.
        vertices_b: vertices of body b in the world's frame, shape (n, 3); n = 0 for a half space.
        normal: unit normal from a to b, shape (3,).
        point: a contact point that the engine lists, shape (3,).
        gap: separation [m] at that point.
        near: greatest difference [m] of a corner's gap from the gap at ``point``.
    """
    frame = _frame(normal)
    here = np.empty(3)
    for k in range(3):
        here[k] = frame[k, 0] * point[0] + frame[k, 1] * point[1] + frame[k, 2] * point[2]
    nothing = np.empty((0, 3))
    hull_a = _facing(vertices_a, frame, 1.0, 2 * near) if len(vertices_a) else nothing
    hull_b = _facing(vertices_b, frame, -1.0, 2 * near) if len(vertices_b) else nothing
    if not len(hull_a):
        area = hull_b
    elif not len(hull_b):
        area = hull_a
    elif len(hull_b) >= 3:
        area = _intersection(hull_a, hull_b)
    elif len(hull_a) >= 3:
        area = _intersection(hull_b, hull_a)
    else:
        return nothing, np.empty(0)  # two edges cross in the listed point
    x_a, y_a = _slope(hull_a) if len(hull_a) else (0.0, 0.0)
    x_b, y_b = _slope(hull_b) if len(hull_b) else (0.0, 0.0)
    corners, gaps = np.empty((len(area), 3)), np.empty(len(area))
    size = 0
    for i in range(len(area)):
        x, y = area[i, 0] - here[0], area[i, 1] - here[1]
        opened = gap + (x_b - x_a) * x + (y_b - y_a) * y
        if abs(opened - gap) > near:
            continue
        height = here[2] + (x_a + x_b) / 2 * x + (y_a + y_b) / 2 * y
        for k in range(3):
            corners[size, k] = area[i, 0] * frame[0, k] + area[i, 1] * frame[1, k] + height * frame[2, k]
        gaps[size] = opened
        size += 1
    return corners[:size], gaps[:size]


@numba.njit(cache=True)
def _is_listed(corner: FloatArray, points: FloatArray, same: float) -> bool:
    """Return True if one of the points (n, 3) lies within the distance ``same`` of a corner (3,)."""
    for i in range(len(points)):
        x, y, z = points[i, 0] - corner[0], points[i, 1] - corner[1], points[i, 2] - corner[2]
        if x * x + y * y + z * z <= same * same:
            return True
    return False


@numba.njit(cache=True)
def missing_corners(
    vertices: FloatArray,
    first_vertex: IntArray,
    poses: FloatArray,
    sizes: FloatArray,
    axes: FloatArray,
    a: IntArray,
    b: IntArray,
    point: FloatArray,
    normal: FloatArray,
    separation: FloatArray,
) -> tuple[IntArray, FloatArray, FloatArray]:
    """Return the corners of contact areas that the engine's contacts do not list.

    Args:
        vertices: vertices of all bodies in their own frames [m], shape (v, 3).
        first_vertex: first vertex of each body, and v, shape (m + 1,).
        poses: positions [m] and quaternions (x, y, z, w), shape (m, 7).
        sizes: greatest distance [m] of each body's vertices from its own origin, such as the half diagonal of a box,
            shape (m,); infinite for a half space.
        axes: axes of cylinders in their own frames, shape (m, 3); zero for other bodies.
        a: row of the first body of each contact, shape (n,); contacts of a pair are adjacent. A negative row is a body
            of unknown shape. Pairs with this body get no corners.
        b: row of the second body of each contact, or a negative row as in ``a``, shape (n,).
        point: contact points [m], shape (n, 3).
        normal: unit normals from a to b, shape (n, 3).
        separation: separations [m], shape (n,).

    Returns:
        The index (k,) of the deepest contact of the corner's pair, the corners (k, 3) [m], and their gaps (k,) [m].
    """
    room, kept = 16 + len(a), 0
    rows, corners, gaps = np.empty(room, np.int64), np.empty((room, 3)), np.empty(room)
    first = 0
    while first < len(a):
        last = deepest = first
        while last < len(a) and a[last] == a[first] and b[last] == b[first]:
            deepest = last if separation[last] < separation[deepest] else deepest
            last += 1
        i, j = a[first], b[first]
        fits = i >= 0 and j >= 0 and min(sizes[i], sizes[j]) < np.inf
        if fits and _stands(axes[i], poses[i], normal[deepest]) and _stands(axes[j], poses[j], normal[deepest]):
            size = min(sizes[i], sizes[j])
            found, opened = area_corners(
                _placed(vertices[first_vertex[i] : first_vertex[i + 1]], poses[i]),
                _placed(vertices[first_vertex[j] : first_vertex[j + 1]], poses[j]),
                normal[deepest],
                point[deepest],
                separation[deepest],
                NEAR * size,
            )
            while kept + len(found) > room:
                rows, corners, gaps = (
                    np.concatenate((rows, rows)),
                    np.concatenate((corners, corners)),
                    np.concatenate((gaps, gaps)),
                )
                room *= 2
            for i in range(len(found)):
                if not _is_listed(found[i], point[first:last], SAME * size):
                    for k in range(3):
                        corners[kept, k] = found[i, k]
                    rows[kept], gaps[kept] = deepest, opened[i]
                    kept += 1
        first = last
    return rows[:kept], corners[:kept], gaps[:kept]
