"""Normals of contacts at a rim, the border of a cylinder's end face, with an edge, a cylinder's side or another rim.

A rim is a circle. A search over the rim's angle finds the point nearest to another curve, because these points have no
closed form. The search tries a grid of ``GRID`` angles. Then a bounded minimisation of the squared distance continues
between the two neighbours of the best angle. With the tangents t1 and t2 of both curves, the normal is t1 x t2, because
both solids are convex and each touches the plane of both tangents. If the other surface is round, the normal is the
vector between the nearest points.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from functools import partial
from typing import NamedTuple

import numpy as np
from scipy.optimize import minimize_scalar

from scenarios.geometry import FloatArray
from scenarios.statics.convex_solids import Solid, perpendicular

GRID = 48
"""Number of angles of the first search along a rim: 7.5 deg apart, so that the distance has one minimum between two
neighbours of the best angle."""
PRECISE = 1e-10
"""Tolerance of the angle [rad] at the end of the search."""
_LONG = 1e-9
"""Length below which the cross product of two unit vectors counts as zero."""

Nearest = Callable[[FloatArray], FloatArray]
"""Function from points (k, 3) [m] to the nearest points (k, 3) [m] of a curve."""


def rim_normals(first: Solid, second: Solid) -> FloatArray:
    """Return unit normals (k, 3), of either sign, of possible contacts between a rim of a solid and the other solid."""
    normals: list[FloatArray] = []
    for solid, other in ((first, second), (second, first)):
        if solid.disk:
            for end in _near_ends(solid, other):
                normals += _normals_of_rim(solid, end, other)
    lengths = [float(np.linalg.norm(normal)) for normal in normals]
    kept = [normal / length for normal, length in zip(normals, lengths, strict=True) if length > _LONG]
    return np.array(kept).reshape(-1, 3)


def _near_ends(solid: Solid, other: Solid) -> Iterator[FloatArray]:
    """Yield the centre of the end face nearer to the other solid, or both centres.

    The function yields both centres if their distances differ by less than the radius.
    """
    distances = [float(np.linalg.norm(other.core - end, axis=1).min()) for end in solid.core]
    yield solid.core[int(np.argmin(distances))]
    if abs(distances[1] - distances[0]) < solid.disk:
        yield solid.core[int(np.argmax(distances))]


def _normals_of_rim(solid: Solid, end: FloatArray, other: Solid) -> Iterator[FloatArray]:
    rim = _Rim(end, *(solid.disk * perpendicular(solid.axis)))
    if not other.disk:
        for point in other.core:
            angle = _nearest_angle(rim, partial(_at_point, point=point))
            yield point - rim.at(angle)
    for start, stop in other.core[other.edges]:
        nearest = partial(_on_segment, start=start, stop=stop)
        angle = _nearest_angle(rim, nearest)
        at = rim.at(angle)
        yield nearest(at[None])[0] - at
        yield np.cross(rim.tangent(angle), (stop - start) / np.linalg.norm(stop - start))
    if other.disk:
        for center in other.core:
            nearest = partial(_on_circle, center=center, solid=other)
            angle = _nearest_angle(rim, nearest)
            around = nearest(rim.at(angle)[None])[0] - center
            yield np.cross(rim.tangent(angle), np.cross(other.axis, around) / other.disk)


class _Rim(NamedTuple):
    """A circle: the points center + cos(angle) u + sin(angle) v."""

    center: FloatArray
    u: FloatArray
    v: FloatArray

    def points(self, angles: FloatArray) -> FloatArray:
        """Return the points (k, 3) [m] at angles (k,) [rad]."""
        points: FloatArray = self.center + np.outer(np.cos(angles), self.u) + np.outer(np.sin(angles), self.v)
        return points

    def at(self, angle: float) -> FloatArray:
        """Return the point (3,) [m] at an angle [rad]."""
        return self.center + math.cos(angle) * self.u + math.sin(angle) * self.v

    def tangent(self, angle: float) -> FloatArray:
        """Return the unit tangent (3,) at an angle [rad]."""
        along: FloatArray = (math.cos(angle) * self.v - math.sin(angle) * self.u) / np.linalg.norm(self.u)
        return along


def _nearest_angle(rim: _Rim, nearest: Nearest) -> float:
    """Return the angle [rad] at which a rim is nearest to a curve."""
    angles = np.linspace(0.0, 2 * np.pi, GRID, endpoint=False)
    points = rim.points(angles)
    best = float(angles[((nearest(points) - points) ** 2).sum(axis=1).argmin()])

    def squared(angle: float) -> float:
        point = rim.at(angle)[None]
        return float(((nearest(point) - point) ** 2).sum())

    step = 2 * np.pi / GRID
    found = minimize_scalar(squared, bounds=(best - step, best + step), method="bounded", options={"xatol": PRECISE})
    return float(found.x)


def _at_point(points: FloatArray, point: FloatArray) -> FloatArray:
    return np.broadcast_to(point, points.shape)


def _on_segment(points: FloatArray, start: FloatArray, stop: FloatArray) -> FloatArray:
    along = stop - start
    part = np.clip((points - start) @ along / (along @ along), 0.0, 1.0)
    nearest: FloatArray = start + part[:, None] * along
    return nearest


def _on_circle(points: FloatArray, center: FloatArray, solid: Solid) -> FloatArray:
    flat = points - center
    flat = flat - (flat @ solid.axis)[:, None] * solid.axis
    length = np.linalg.norm(flat, axis=1)[:, None]
    nearest: FloatArray = center + solid.disk * flat / np.maximum(length, _LONG * solid.disk)
    return nearest
