"""The common part of two convex figures in a plane: points, segments and polygons."""

from __future__ import annotations

import numpy as np

from scenarios.geometry import FloatArray


def clipped(polygon: FloatArray, outside: FloatArray) -> FloatArray:
    """Return the part (m, 2) of a polygon, segment or point (k, 2) in which a linear function is not positive.

    The array ``outside`` (k,) contains the function's values at the corners. The method is the algorithm of Sutherland
    and Hodgman. A corner may occur twice in the result, because a segment counts as a polygon that runs from one end to
    the other end and back.
    """
    if (outside <= 0.0).all():
        return polygon
    corners, beyond = polygon.tolist(), outside.tolist()  # plain numbers, because NumPy is slow on a few corners
    kept = []
    for (x, y), (u, v), d, e in zip(corners, corners[1:] + corners[:1], beyond, beyond[1:] + beyond[:1], strict=True):
        if d <= 0:
            kept.append((x, y))
        if d * e < 0:
            part = d / (d - e)
            kept.append((x + part * (u - x), y + part * (v - y)))
    return np.array(kept).reshape(-1, 2)


def common_part(first: FloatArray, second: FloatArray, tolerance: float) -> FloatArray:
    """Return the corners (m, 2) of the common part of two convex figures; no corners if the figures are apart.

    Args:
        first: corners of the first figure, shape (k, 2): a point, both ends of a segment, or a polygon's corners in
            counter-clockwise order.
        second: corners of the second figure, shape (l, 2), in the same form.
        tolerance: distance [m] up to which a point or a segment counts as lying on a figure's border.
    """
    if len(first) < len(second):
        first, second = second, first
    if len(second) == 1:
        return second if _outside(first, second, tolerance).max() <= tolerance else np.empty((0, 2))
    if len(first) == 2:
        return _common_segment(first, second, tolerance)
    part = second
    for start, end in zip(first, np.roll(first, -1, axis=0), strict=True):
        outside = (part - start) @ _outward(start, end)
        if outside.max(initial=-np.inf) > tolerance:
            part = clipped(part, outside)
    if len(second) == 2 and len(part):
        along = part @ (second[1] - second[0])
        return part[[along.argmin(), along.argmax()]]  # without corners that occur twice
    return part


def room_inside(polygon: FloatArray, point: FloatArray) -> float:
    """Return the distance [m] from a point (2,) to the border of a counter-clockwise polygon; negative outside."""
    return -float(_outside(polygon, point[None], 0.0).max())


def counter_clockwise(corners: FloatArray) -> FloatArray:
    """Return the corners (k, 2) of a convex figure; the corners of a polygon in counter-clockwise order."""
    if len(corners) < 3:
        return corners
    around = corners - corners.mean(axis=0)
    ordered: FloatArray = corners[np.argsort(np.arctan2(around[:, 1], around[:, 0]))]
    return ordered


def _outward(start: FloatArray, end: FloatArray) -> FloatArray:
    """Return the outward unit normal of an edge of a counter-clockwise polygon."""
    along = end - start
    outward: FloatArray = np.array([along[1], -along[0]]) / np.linalg.norm(along)
    return outward


def _outside(figure: FloatArray, points: FloatArray, tolerance: float) -> FloatArray:
    """Return the distance [m] by which each point (m, 2) lies outside a figure; a negative distance inside a polygon.

    The distance from a polygon is the greatest distance beyond the line of an edge.
    """
    if len(figure) == 1:
        from_point: FloatArray = np.linalg.norm(points - figure[0], axis=1)
        return from_point
    if len(figure) == 2:
        along = figure[1] - figure[0]
        length = np.linalg.norm(along)
        if length <= tolerance:
            return _outside(figure[:1], points, tolerance)
        part = np.clip((points - figure[0]) @ along / length**2, 0.0, 1.0)
        from_segment: FloatArray = np.linalg.norm(points - figure[0] - part[:, None] * along, axis=1)
        return from_segment
    normals = np.array([_outward(start, end) for start, end in zip(figure, np.roll(figure, -1, axis=0), strict=True)])
    beyond: FloatArray = (points @ normals.T - (figure * normals).sum(axis=1)).max(axis=1)
    return beyond


def _common_segment(first: FloatArray, second: FloatArray, tolerance: float) -> FloatArray:
    """Return the common part of two segments: both ends, the crossing point, or nothing."""
    along, across = first[1] - first[0], second[1] - second[0]
    length, reach = np.linalg.norm(along), np.linalg.norm(across)
    turn = along[0] * across[1] - along[1] * across[0]
    if abs(turn) * max(length, reach) <= tolerance * length * reach:
        unit = along / length
        beside = (second - first[0]) @ np.array([-unit[1], unit[0]])
        if np.abs(beside).min() > tolerance:
            return np.empty((0, 2))
        low, high = np.sort((second - first[0]) @ unit)
        low, high = max(0.0, low), min(length, high)
        if high - low <= tolerance:
            return np.empty((0, 2))
        ends: FloatArray = first[0] + np.outer([low, high], unit) + beside.mean() / 2 * np.array([-unit[1], unit[0]])
        return ends
    between = second[0] - first[0]
    share = (between[0] * across[1] - between[1] * across[0]) / turn
    other = (between[0] * along[1] - between[1] * along[0]) / turn
    slack, play = tolerance / length, tolerance / reach
    if not (-slack <= share <= 1 + slack and -play <= other <= 1 + play):
        return np.empty((0, 2))
    crossing: FloatArray = (first[0] + share * along)[None]
    return crossing
