"""Contacts of pymunk's shapes at their present poses, also at a gap of zero, without a change of the space.

Chipmunk's own query finds overlapping shapes only. Rounding determines its normals between corners that meet. This
module separates two convex outlines along the normals of their edges (separating axes), and clips the facing edges.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple, TypeAlias

import numpy as np
import pymunk

from stability_core.ports.pymunk_reader import Arbiters, arbiters_of, numbers_of

NEAR = 0.01
"""Greatest gap of a pair, in reaches of the smaller shape, because Chipmunk lists no contact at a gap of zero."""
_ADVANCES = 4
"""Greatest number of steps of ``meeting_of``, because the pair of facing edges may change on the way."""
_SAME = 1e-6
"""Length of a common line, in reaches, below which two shapes meet in a corner."""

Point: TypeAlias = tuple[float, float]


class Outline(NamedTuple):
    """A convex shape in the space's coordinates: a circle has 1 corner, a segment 2, a polygon 3 or more."""

    corners: list[Point]
    """Corners, counter-clockwise."""
    radius: float
    """Radius by which the shape extends beyond its corners and edges."""
    reach: float
    """Half of the diagonal of the corners' bounding box, plus the radius."""


class Touch(NamedTuple):
    """A contact of two shapes."""

    normal: Point
    """Unit normal from the first shape to the second."""
    points: list[tuple[float, float, float, float, float]]
    """Point on the first shape (2 numbers), point on the second (2), and their distance (negative for an overlap)."""
    gap: float
    """Separation of the shapes along the normal."""

    def turned(self) -> Touch:
        """Return the contact with the shapes in the other order."""
        nx, ny = self.normal
        return Touch((-nx, -ny), [(*end[2:4], *end[:2], end[4]) for end in self.points], self.gap)


def outline_of(shape: pymunk.Shape) -> Outline:
    """Return the outline of a shape at the present pose of its body."""
    local, radius = _core_of(shape)
    body = shape.body
    assert body is not None
    (c, s), (px, py) = body.rotation_vector, body.position
    corners = [(c * x - s * y + px, s * x + c * y + py) for x, y in local]
    low, high = np.min(corners, axis=0), np.max(corners, axis=0)
    return Outline(corners, radius, float(np.hypot(*(high - low))) / 2 + radius)


def reach_of(shape: pymunk.Shape, center: Point) -> float:
    """Return the greatest distance of a shape's points from ``center``, in the coordinates of its body."""
    local, radius = _core_of(shape)
    return radius + max(math.hypot(x - center[0], y - center[1]) for x, y in local)


def found_contacts(shapes: list[pymunk.Shape], partners: list[pymunk.Shape]) -> Arbiters:
    """Return the contacts of ``shapes`` with one another and with ``partners``, up to a gap of ``NEAR``."""
    arbiters, numbers = [], []
    every = [*shapes, *partners]
    outlines = [outline_of(shape) for shape in every]
    for i, j in _near_pairs(outlines, len(shapes)):
        a, b = every[i], every[j]
        if a.body is None or b.body is None or not collide(a, b):
            continue
        touch = touch_of(outlines[i], outlines[j])
        if touch.points:
            arbiters.append((a.body.id, b.body.id, len(touch.points)))
            numbers.append(numbers_of(touch.normal, touch.points))
    return arbiters_of(arbiters, numbers)


def touch_of(a: Outline, b: Outline) -> Touch:
    """Return the contact of two shapes; without points for a gap above ``NEAR`` and for a corner."""
    near = NEAR * min(a.reach, b.reach)
    if len(a.corners) == 1:
        touch = _touch_of_circle(b, a).turned()
    elif len(b.corners) == 1:
        touch = _touch_of_circle(a, b)
    else:
        touch = _touch_of_edges(a, b)
    points = [point for point in touch.points if point[4] <= near]
    return touch._replace(points=points)


def meeting_of(a: Outline, b: Outline, way: Point) -> Touch | None:
    """Return the contact in which shape a meets shape b, if a moves by ``way`` without turning; None without a meeting.

    The points lie on b. Their distance is the path of a along the normal until the shapes meet (conservative
    advancement). The result is None as well if ``_ADVANCES`` steps do not find the meeting.
    """
    near, part = NEAR * min(a.reach, b.reach), 0.0
    for _ in range(_ADVANCES):
        moved = a._replace(corners=[(x + part * way[0], y + part * way[1]) for x, y in a.corners])
        touch = touch_of(moved, b)
        closing = way[0] * touch.normal[0] + way[1] * touch.normal[1]
        if closing <= 0.0:
            return None
        if touch.gap <= near:
            distance = part * closing + touch.gap
            return touch._replace(points=[(*end[2:4], *end[2:4], distance) for end in touch.points])
        part += touch.gap / closing
        if part > 1.0:
            return None
    return None


def _core_of(shape: pymunk.Shape) -> tuple[Sequence[Point], float]:
    """Return the corners of a shape in the coordinates of its body, and its radius."""
    if isinstance(shape, pymunk.Circle):
        return [shape.offset], shape.radius
    if isinstance(shape, pymunk.Segment):
        return [shape.a, shape.b], shape.radius
    assert isinstance(shape, pymunk.Poly)
    return shape.get_vertices(), shape.radius


def collide(a: pymunk.Shape, b: pymunk.Shape) -> bool:
    """Return True if Chipmunk collides two shapes, by their bodies, filters and sensors."""
    f, g = a.filter, b.filter
    is_rejected = (f.group and f.group == g.group) or not f.categories & g.mask or not g.categories & f.mask
    return not (a.body is b.body or a.sensor or b.sensor or is_rejected)


def _near_pairs(outlines: list[Outline], count: int) -> Iterator[tuple[int, int]]:
    """Yield the pairs of rows whose bounding boxes, enlarged by ``NEAR``, touch; the first row is below ``count``."""
    grown = [outline.radius + NEAR * outline.reach for outline in outlines]
    low = np.array([np.min(outline.corners, axis=0) for outline in outlines]).reshape(-1, 2) - np.array(grown)[:, None]
    high = np.array([np.max(outline.corners, axis=0) for outline in outlines]).reshape(-1, 2) + np.array(grown)[:, None]
    for i in range(count):
        meets = (low[i + 1 :] <= high[i]).all(axis=1) & (high[i + 1 :] >= low[i]).all(axis=1)
        for j in np.flatnonzero(meets).tolist():
            yield i, i + 1 + j


def _edges(corners: list[Point]) -> Iterator[tuple[Point, Point, Point]]:
    """Yield start, end and outward unit normal of each edge; a segment has an edge on either side."""
    for (ax, ay), (bx, by) in zip(corners, corners[1:] + corners[:1], strict=True):
        length = math.hypot(bx - ax, by - ay)
        if length > 0.0:
            yield (ax, ay), (bx, by), ((by - ay) / length, (ax - bx) / length)


def _height(point: Point, start: Point, normal: Point) -> float:
    return (point[0] - start[0]) * normal[0] + (point[1] - start[1]) * normal[1]


def _touch_of_circle(a: Outline, circle: Outline) -> Touch:
    """Return the contact of a shape and a circle, at any gap."""
    (cx, cy), inside, normal = circle.corners[0], -math.inf, (0.0, 1.0)
    nearest, gap = a.corners[0], math.inf
    for start, end, outward in _edges(a.corners):
        height = _height((cx, cy), start, outward)
        if height > inside:
            inside, normal = height, outward
        length2 = (end[0] - start[0]) ** 2 + (end[1] - start[1]) ** 2
        along = ((cx - start[0]) * (end[0] - start[0]) + (cy - start[1]) * (end[1] - start[1])) / length2
        along = min(max(along, 0.0), 1.0)
        point = start[0] + along * (end[0] - start[0]), start[1] + along * (end[1] - start[1])
        distance = math.hypot(cx - point[0], cy - point[1])
        if distance < gap:
            nearest, gap = point, distance
    if len(a.corners) == 1:
        gap = math.hypot(cx - nearest[0], cy - nearest[1])
    if len(a.corners) > 2 and inside <= 0.0:  # the centre lies inside a polygon
        gap = inside
        nearest = cx - inside * normal[0], cy - inside * normal[1]
    elif gap > 0.0:
        normal = (cx - nearest[0]) / gap, (cy - nearest[1]) / gap
    nx, ny = normal
    on_a = nearest[0] + a.radius * nx, nearest[1] + a.radius * ny
    on_b = cx - circle.radius * nx, cy - circle.radius * ny
    gap -= a.radius + circle.radius
    return Touch(normal, [(*on_a, *on_b, gap)], gap)


def _touch_of_edges(a: Outline, b: Outline) -> Touch:
    """Return the contact of two shapes with edges, at any gap; without points if the shapes meet in a corner."""
    gap_a, edge_a = _separation(a, b)
    gap_b, edge_b = _separation(b, a)
    if gap_b > gap_a + _SAME * min(a.reach, b.reach):
        return _clipped(gap_b, edge_b, b, a).turned()
    return _clipped(gap_a, edge_a, a, b)


def _separation(a: Outline, b: Outline) -> tuple[float, tuple[Point, Point, Point]]:
    """Return the greatest separation of the corners of b from an edge of a, and this edge."""
    return max((min(_height(corner, edge[0], edge[2]) for corner in b.corners), edge) for edge in _edges(a.corners))


def _clipped(gap: float, edge: tuple[Point, Point, Point], a: Outline, b: Outline) -> Touch:
    """Return the contact of an edge of a and the facing edge of b, with the ``gap`` of the shapes without radii."""
    gap -= a.radius + b.radius
    start, end, (nx, ny) = edge
    length = math.hypot(end[0] - start[0], end[1] - start[1])
    tx, ty = (end[0] - start[0]) / length, (end[1] - start[1]) / length
    facing = min(_edges(b.corners), key=lambda other: other[2][0] * nx + other[2][1] * ny)
    ends = sorted((_height(corner, start, (tx, ty)), _height(corner, start, (nx, ny))) for corner in facing[:2])
    (t0, h0), (t1, h1) = ends
    low, high = max(t0, 0.0), min(t1, length)
    same = _SAME * min(a.reach, b.reach)
    if high - low <= same and (low <= same or high >= length - same):
        return Touch((nx, ny), [], gap)
    slope = (h1 - h0) / (t1 - t0) if t1 - t0 > same else 0.0
    points = []
    for t in (low, high) if high - low > same else (low,):
        height = h0 + slope * (t - t0) if slope else min(h0, h1)
        foot = start[0] + t * tx, start[1] + t * ty
        on_a = foot[0] + a.radius * nx, foot[1] + a.radius * ny
        above = height - b.radius
        on_b = foot[0] + above * nx, foot[1] + above * ny
        points.append((*on_a, *on_b, above - a.radius))
    return Touch((nx, ny), points, gap)
