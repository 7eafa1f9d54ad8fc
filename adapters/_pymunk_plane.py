"""From the scene to Chipmunk's plane, in millimetres, and back: its first axis is x, its second z."""

from __future__ import annotations

import math

import numpy as np
import pymunk

from scenarios.model import Brick, Quaternion, Vector
from stability_core.port import FloatArray

UNITS_PER_METRE = 1000.0

MAX_OFF_PLANE = 1e-9
"""Distance [m] from the plane, and component of a quaternion, that are rounding, no more."""


def planar_gravity(gravity: Vector) -> tuple[float, float]:
    """Return gravity in engine units.

    Raises:
        ValueError: if it leaves the engine's plane.
    """
    x, y, z = gravity
    if y != 0.0:
        raise ValueError(f"pymunk is planar: gravity must lie in the x-z plane, got {gravity} m/s2")
    return x * UNITS_PER_METRE, z * UNITS_PER_METRE


def moment(brick: Brick) -> float:
    """Return moment of inertia [kg mm2] about y."""
    return brick.mass * (brick.size[0] ** 2 + brick.size[2] ** 2) / 12 * UNITS_PER_METRE**2


def in_plane(position: Vector, quaternion: Quaternion) -> tuple[tuple[float, float], float]:
    """Return position [mm] and angle [rad] in the engine's plane.

    Raises:
        ValueError: if the pose leaves the plane.
    """
    x, y, z = position
    w, i, j, k = quaternion
    if abs(y) > MAX_OFF_PLANE:
        raise ValueError(f"pymunk is planar: put the brick's centre at y = 0, got y = {y} m")
    if max(abs(i), abs(k)) > MAX_OFF_PLANE:
        raise ValueError(f"pymunk is planar: turn bricks about the y axis only, got quaternion {quaternion}")
    return (x * UNITS_PER_METRE, z * UNITS_PER_METRE), -2 * math.atan2(j, w)


def lift(planar: FloatArray) -> FloatArray:
    """Return vectors (n, 2) of the engine's plane as vectors (n, 3)."""
    vectors = np.zeros((len(planar), 3))
    vectors[:, ::2] = planar
    return vectors


def halt(planar: pymunk.Body) -> None:
    """Stop a body, and drop the push out of its overlaps that would move it in its next step."""
    planar.velocity = 0.0, 0.0
    planar.angular_velocity = 0.0
    pymunk.Body.update_position(planar, 0.0)
