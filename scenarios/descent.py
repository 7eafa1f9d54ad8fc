"""Straight descent of a convex body onto another convex body, with the exact shapes of both.

A point a of the upper body lies straight above a point b of the lower body if a - b = (0, 0, h). The upper body can
sink by the smallest h of all pairs of points. All differences a - b fill a convex set D. The farthest point of D along
a direction (a support point) is the difference of the bodies' support points. The smallest h is the height at which the
z axis enters D from below. Bodies that are flush to within ``GRAZE``, seen from above, count as beside each other.

1. The distance algorithm of Gilbert, Johnson and Keerthi, in two dimensions, finds a triangle of points of D around the
   z axis, seen from above. If the algorithm finds no triangle, D lies beside the axis, and no part of one body is above
   the other body.
2. Portal refinement lowers the triangle until no point of D lies below the triangle's plane. In each step the point of
   D that is farthest below the plane replaces a corner of the triangle. The refinement chooses the corner so that the
   triangle stays around the axis.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from scenarios.shapes import FloatArray, Point, Shape, support_points

GRAZE = 1e-9
"""Overlap [m] seen from above, below which two bodies count as flush, because flush bodies do not carry each other."""
ENOUGH = 1e-10
"""Greatest error [m] of a height, far above rounding and far below any gap that counts."""
_MEETS = 1e-12
"""Distance [m] from the axis within which a point or a segment meets the axis, because of rounding."""
_THIN = 1e-12
"""Ratio of a triangle's double area to the square of its greatest distance from the axis, below which it is a line."""
_MOST_STEPS = 200
"""Greatest number of refinements. A polyhedron needs about ten, a round body about thirty."""

SupportOf = Callable[[FloatArray], FloatArray]


@dataclass(frozen=True, slots=True)
class Placed:
    """A shape in its pose."""

    shape: Shape
    size: Point
    """Edge lengths [m] of the smallest box along its own axes."""
    center: FloatArray
    """Centre of mass [m], shape (3,)."""
    turn: FloatArray
    """Rotation matrix from the own frame to the world's, shape (3, 3)."""

    def support(self, direction: FloatArray) -> FloatArray:
        """Return the body's farthest point [m] along a direction (3,), shape (3,), in the world's frame."""
        local = support_points(self.shape, self.size, (direction @ self.turn)[None])[0]
        farthest: FloatArray = self.center + self.turn @ local
        return farthest


def lowest_difference(upper: Placed, lower: Placed) -> float:
    """Return the distance [m] by which the upper body can sink straight down to the lower body.

    The distance is infinite if the bodies do not overlap in plan (seen from above) by more than ``GRAZE``. The distance
    is negative if the upper body must rise to lie on the lower body.
    """

    def support(direction: FloatArray) -> FloatArray:
        return upper.support(direction) - lower.support(-direction)

    triangle = _around_axis(support, upper.center - lower.center)
    return np.inf if triangle is None else _lowered(triangle, support)


def _around_axis(support: SupportOf, inner: FloatArray) -> FloatArray | None:
    """Return a triangle (3, 3) of the set around the z axis, seen from above.

    The result is None if the set lies beside the axis, or the axis lies within ``GRAZE`` of the border of its outline.
    """
    toward = -inner[:2] if np.hypot(*inner[:2]) > GRAZE else np.array([1.0, 0.0])
    points = [support(np.append(toward, 0.0))]
    for _ in range(_MOST_STEPS):
        toward, points = _nearest(points)
        length = float(np.hypot(*toward))
        if len(points) == 3:
            return None if _is_flush(points, support) else np.array(points)
        if length > _MEETS:
            directions = [toward / length]
        else:
            aside = _aside(points)
            directions = [aside, -aside]
        found = [(direction, support(np.append(direction, 0.0))) for direction in directions]
        direction, new = max(found, key=lambda pair: float(pair[1][:2] @ pair[0]))
        if new[:2] @ direction < GRAZE:
            return None
        points.append(new)
    return None


def _is_flush(points: list[FloatArray], support: SupportOf) -> bool:
    """Return whether the axis lies within ``GRAZE`` of the border of the set's outline, seen from above.

    The polygon of known points gets one more corner beyond the edge that is nearest to the axis. The search ends when
    this edge is farther from the axis than ``GRAZE``, or lies on the border.
    """
    polygon = [point[:2] for point in points]
    if _turns(polygon[1] - polygon[0], polygon[2] - polygon[0]) < 0:
        polygon.reverse()
    for _ in range(_MOST_STEPS):
        corners = np.array(polygon)
        edges = np.roll(corners, -1, axis=0) - corners
        outward = np.column_stack([edges[:, 1], -edges[:, 0]])
        outward /= np.maximum(np.hypot(*edges.T), np.finfo(float).tiny)[:, None]
        distance = np.einsum("ij,ij->i", outward, corners)
        nearest = int(distance.argmin())
        if distance[nearest] > GRAZE:
            return False
        new = support(np.append(outward[nearest], 0.0))[:2]
        if new @ outward[nearest] - distance[nearest] <= _MEETS:
            return True
        polygon.insert(nearest + 1, new)
    return True


def _aside(points: list[FloatArray]) -> FloatArray:
    """Return the horizontal direction (2,) across a segment that meets the axis; the x axis for a single point."""
    if len(points) == 1:
        return np.array([1.0, 0.0])
    x, y = (points[1] - points[0])[:2].tolist()
    return np.array([-y, x]) / math.hypot(x, y)


def _nearest(points: list[FloatArray]) -> tuple[FloatArray, list[FloatArray]]:
    """Return the horizontal vector to the axis from a simplex's nearest point, and the corners around this point."""
    if len(points) == 1:
        return -points[0][:2], points
    if len(points) == 2:
        one, other = points
        edge = (other - one)[:2]
        share = -float(one[:2] @ edge) / max(float(edge @ edge), np.finfo(float).tiny)
        if share <= 0:
            return -one[:2], [one]
        if share >= 1:
            return -other[:2], [other]
        return -(one[:2] + share * edge), points
    first, second, third = points
    if _is_around(first, second, third):
        return np.zeros(2), points
    edges = [_nearest([one, other]) for one, other in ((first, third), (second, third), (first, second))]
    return min(edges, key=lambda found: float(found[0] @ found[0]))


def _turns(one: FloatArray, other: FloatArray) -> float:
    return float(one[0] * other[1] - one[1] * other[0])


def _is_around(first: FloatArray, second: FloatArray, third: FloatArray) -> bool:
    """Return whether three points span a triangle around the axis, seen from above."""
    area = _turns(second - first, third - first)
    sides = np.array([_turns(first, second), _turns(second, third), _turns(third, first)])
    longest = max(np.hypot(*point[:2]) for point in (first, second, third))
    return abs(area) > _THIN * longest**2 and bool((sides * np.sign(area) >= -_MEETS * longest).all())


def _lowered(triangle: FloatArray, support: SupportOf) -> float:
    """Return the height [m] at which the axis enters the set from below, from a ``triangle`` (3, 3) around the axis."""
    height = np.inf
    for _ in range(_MOST_STEPS):
        slope_x, slope_y, height = np.linalg.solve(np.column_stack([triangle[:, :2], np.ones(3)]), triangle[:, 2])
        normal = np.array([slope_x, slope_y, -1.0])
        new = support(normal / np.linalg.norm(normal))
        if (new - triangle[0]) @ normal <= ENOUGH * np.linalg.norm(normal):
            return float(height)
        corners = [np.array([*pair, new]) for pair in (triangle[[0, 1]], triangle[[1, 2]], triangle[[2, 0]])]
        triangle = max(corners, key=_inside)
        if _inside(triangle) == -np.inf:  # the new point is in line with every edge, to within rounding
            break
    return float(height)


def _inside(triangle: FloatArray) -> float:
    """Return the axis's least barycentric coordinate in a triangle, seen from above.

    The coordinate is at most 1/3, and negative outside. It is minus infinity for a triangle without area.
    """
    first, second, third = triangle
    area = _turns(second - first, third - first)
    if abs(area) <= _THIN * max(float(point[:2] @ point[:2]) for point in triangle):
        return -np.inf
    return min(_turns(first, second) / area, _turns(second, third) / area, _turns(third, first) / area)
