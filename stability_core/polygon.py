"""Convex polygons in plan: hull, distance, width and centroid of contact points.

Points have the shape (n, 3) [m]. The functions compute with x and y. Vertices and centroids also have z.
"""

from __future__ import annotations

import numpy as np

from stability_core.compiled import compiled
from stability_core.port import FloatArray, IntArray

MANY = 64
"""Number of points above which ``_ranked_in_plan`` drops inner points before sorting, because for fewer points
the sorting alone is faster."""


@compiled
def _turn(points: FloatArray, a: int, b: int, c: int) -> float:
    """Return twice the signed area of the plan triangle of rows a, b, c. A left turn has a positive area."""
    ax, ay = points[a, 0], points[a, 1]
    return float((points[b, 0] - ax) * (points[c, 1] - ay) - (points[b, 1] - ay) * (points[c, 0] - ax))


@compiled
def _outer_rows(points: FloatArray) -> IntArray:
    """Return the rows of ``points`` (n, 3) that do not lie inside the octagon of the outermost points: O(n).

    Reference: S. G. Akl, G. T. Toussaint, "A fast convex hull algorithm", Information Processing Letters 7 (1978)
    219-222.
    """
    corners, farthest = np.zeros(8, np.int64), np.full(8, -np.inf)
    for row in range(len(points)):
        x, y = points[row, 0], points[row, 1]
        for k, along in enumerate((x, x + y, y, y - x, -x, -x - y, -y, x - y)):
            if along > farthest[k]:
                farthest[k], corners[k] = along, row
    outer = np.empty(len(points), np.int64)
    size, is_wide = 0, farthest[0] + farthest[4] > 0.0
    for row in range(len(points)):
        is_inside = is_wide
        for k in range(8):
            a, b = corners[k], corners[(k + 1) % 8]
            is_inside = is_inside and (a == b or _turn(points, a, b, row) > 0.0)
        if not is_inside:
            outer[size] = row
            size += 1
    return outer[:size]


@compiled
def _ranked_in_plan(points: FloatArray) -> IntArray:
    """Return the rows of the points, sorted by x, then by y, without equal points.

    For more than ``MANY`` points, the result leaves out the points inside an octagon (``_outer_rows``), because they
    are no corners of the hull.
    """
    if len(points) > MANY:
        rows = _outer_rows(points)
        rows = rows[np.argsort(points[rows, 1], kind="mergesort")]
        rows = rows[np.argsort(points[rows, 0], kind="mergesort")]
    else:
        rows = np.arange(len(points))
    ranked = np.empty(len(rows), np.int64)
    size = 0
    for row in rows:  # insertion sort, because manifolds are short, and sorted rows take O(n)
        x, y = points[row, 0], points[row, 1]
        place = size
        while place > 0 and (
            points[ranked[place - 1], 0] > x or (points[ranked[place - 1], 0] == x and points[ranked[place - 1], 1] > y)
        ):
            place -= 1
        if place > 0 and points[ranked[place - 1], 0] == x and points[ranked[place - 1], 1] == y:
            continue
        for j in range(size, place, -1):
            ranked[j] = ranked[j - 1]
        ranked[place] = row
        size += 1
    return ranked[:size]


@compiled
def _hull_rows(points: FloatArray) -> IntArray:
    """Return the rows of the hull's vertices in ``points``, shape (k,), counter-clockwise."""
    ranked = _ranked_in_plan(points)
    n = len(ranked)
    if n < 3:
        return ranked
    chain = np.empty(2 * n, np.int64)
    size = 0
    for i in range(n):  # the lower side, from left to right
        while size >= 2 and _turn(points, chain[size - 2], chain[size - 1], ranked[i]) <= 0.0:
            size -= 1
        chain[size] = ranked[i]
        size += 1
    lower = size
    for i in range(n - 2, -1, -1):  # the upper side, back to the first point
        while size > lower and _turn(points, chain[size - 2], chain[size - 1], ranked[i]) <= 0.0:
            size -= 1
        chain[size] = ranked[i]
        size += 1
    return chain[: size - 1]


@compiled
def convex_hull(points: FloatArray) -> FloatArray:
    """Return the vertices (k, 3) of the convex hull in plan, counter-clockwise (Andrew's monotone chain).

    The cost is O(n log n).
    """
    rows = _hull_rows(points)
    hull = np.empty((len(rows), 3))
    for i in range(len(rows)):
        for k in range(3):
            hull[i, k] = points[rows[i], k]
    return hull


@compiled
def _foot(x: float, y: float, a: FloatArray, b: FloatArray) -> float:
    """Return the parameter, 0 at a and 1 at b, of the nearest point to (x, y) on the segment from a to b."""
    dx, dy = b[0] - a[0], b[1] - a[1]
    length2 = dx * dx + dy * dy
    if length2 > 0.0:
        return float(min(1.0, max(0.0, ((x - a[0]) * dx + (y - a[1]) * dy) / length2)))
    return 0.0


@compiled
def _distance_to_segment(x: float, y: float, a: FloatArray, b: FloatArray) -> float:
    t = _foot(x, y, a, b)
    return float(np.hypot(x - a[0] - t * (b[0] - a[0]), y - a[1] - t * (b[1] - a[1])))


@compiled
def nearest_point(hull: FloatArray, x: float, y: float) -> tuple[float, float]:
    """Return the point on the border of the hull (n, 3), n > 0, that is nearest to (x, y) in plan."""
    least, near_x, near_y = np.inf, x, y
    for i in range(len(hull)):
        a, b = hull[i], hull[(i + 1) % len(hull)]
        distance = _distance_to_segment(x, y, a, b)
        if distance < least:
            t = _foot(x, y, a, b)
            least, near_x, near_y = distance, a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])
    return near_x, near_y


@compiled
def is_inside(hull: FloatArray, x: float, y: float) -> bool:
    """Return True if (x, y) lies in the hull (n, 3) or on its border, and False for a point or a line."""
    n = len(hull)
    for i in range(n):
        ax, ay = hull[i, 0], hull[i, 1]
        j = i + 1 if i + 1 < n else 0
        if (hull[j, 0] - ax) * (y - ay) - (hull[j, 1] - ay) * (x - ax) < 0.0:
            return False
    return n >= 3


@compiled
def lies_on(hull: FloatArray, x: float, y: float) -> bool:
    """Return True if (x, y) lies in the hull (n, 3) or on its border. A point or a line counts as border."""
    return is_inside(hull, x, y) if len(hull) > 2 else bool(inside_distance(hull, x, y) == 0.0)


@compiled
def inside_distance(hull: FloatArray, x: float, y: float) -> float:
    """Return the distance [m] from (x, y) to the border of the hull: positive inside, negative outside.

    The distance is >= 0 if and only if a vertical ray through (x, y) hits the hull. Without points, the distance is
    minus infinity. A point or a line has no inside.
    """
    n = len(hull)
    if n == 0:
        return -np.inf
    nearest = np.inf
    for i in range(n):
        nearest = min(nearest, _distance_to_segment(x, y, hull[i], hull[(i + 1) % n]))
    return nearest if is_inside(hull, x, y) else -nearest


@compiled
def width(hull: FloatArray) -> float:
    """Return the least width [m] of the hull in plan, or zero for a point or a line."""
    n = len(hull)
    if n < 3:
        return 0.0
    least = np.inf
    for i in range(n):
        a, b = hull[i], hull[(i + 1) % n]
        edge = np.hypot(b[0] - a[0], b[1] - a[1])
        farthest = 0.0
        for j in range(n):
            farthest = max(farthest, _turn(hull, i, (i + 1) % n, j) / edge)
        least = min(least, farthest)
    return least


@compiled
def centroid(hull: FloatArray) -> tuple[float, float, float]:
    """Return the area centroid of the hull in plan, at the mean height of the vertices.

    For a point or a line, the result is the mean of the vertices.
    """
    n = len(hull)
    x, y, z = 0.0, 0.0, 0.0
    for i in range(n):
        x, y, z = x + hull[i, 0] / n, y + hull[i, 1] / n, z + hull[i, 2] / n
    area, moment_x, moment_y = 0.0, 0.0, 0.0
    for i in range(1, n - 1):
        part = _turn(hull, 0, i, i + 1)
        area += part
        moment_x += part * (hull[0, 0] + hull[i, 0] + hull[i + 1, 0]) / 3.0
        moment_y += part * (hull[0, 1] + hull[i, 1] + hull[i + 1, 1]) / 3.0
    if area > 0.0:
        return moment_x / area, moment_y / area, z
    return x, y, z
