"""Conversions between the scene [m] and Chipmunk's plane [mm], whose first axis is x and whose second axis is z."""

from __future__ import annotations

import math

import numpy as np

from scenarios.model import Brick, Quaternion, Vector
from scenarios.shapes import Polyhedron
from scenarios.solids import moments_of
from stability_core.port import FloatArray

UNITS_PER_METRE = 1000.0


def planar_gravity(gravity: Vector) -> tuple[float, float]:
    """Return the components of gravity [m/s2] in the plane, in engine units [mm/s2]."""
    x, _, z = gravity
    return x * UNITS_PER_METRE, z * UNITS_PER_METRE


def moment(brick: Brick) -> float:
    """Return the moment of inertia [kg mm2] of a brick about the y axis."""
    if brick.shape != "box" or brick.moments is not None:
        return moments_of(brick)[1] * UNITS_PER_METRE**2
    return brick.mass * (brick.size[0] ** 2 + brick.size[2] ** 2) / 12 * UNITS_PER_METRE**2


def outline(polyhedron: Polyhedron) -> tuple[list[tuple[float, float]], float]:
    """Return the corners [mm] in the engine's plane of a prism with its axis along y, and its depth [m].

    Raises:
        NotImplementedError: if the polyhedron is not a prism with its axis along y; the message names the fix.
    """
    depth = polyhedron.extents[1]
    ends = [
        {(round(x / depth, 9), round(z / depth, 9)) for x, y, z in polyhedron.vertices if abs(y - side) < 1e-9 * depth}
        for side in (-depth / 2, depth / 2)
    ]
    if ends[0] != ends[1] or 2 * len(ends[0]) != len(polyhedron.vertices):
        raise NotImplementedError(
            "pymunk is planar: a polyhedron must be a prism with its axis along y, with equal corners at both ends, "
            f"got {len(polyhedron.vertices)} vertices, of which {len(ends[0])} and {len(ends[1])} are corners of the "
            "ends: use another engine"
        )
    corners = [(x * UNITS_PER_METRE, z * UNITS_PER_METRE) for x, y, z in polyhedron.vertices if y < 0]
    return corners, depth


def in_plane(position: Vector, quaternion: Quaternion) -> tuple[tuple[float, float], float]:
    """Return a pose's position [mm] and angle [rad] in the engine's plane."""
    x, _, z = position
    w, _, j, _ = quaternion
    return (x * UNITS_PER_METRE, z * UNITS_PER_METRE), -2 * math.atan2(j, w)


def lift(planar: FloatArray) -> FloatArray:
    """Convert vectors (n, 2) in the engine's plane to vectors (n, 3) with y = 0."""
    vectors = np.zeros((len(planar), 3))
    vectors[:, ::2] = planar
    return vectors
