"""From the scene to Chipmunk's plane, in millimetres, and back: its first axis is x, its second z."""

from __future__ import annotations

import math

import numpy as np
import pymunk

from scenarios.model import Brick, Quaternion, Vector
from stability_core.port import FloatArray

UNITS_PER_METRE = 1000.0


def planar_gravity(gravity: Vector) -> tuple[float, float]:
    """Return gravity in engine units."""
    x, _, z = gravity
    return x * UNITS_PER_METRE, z * UNITS_PER_METRE


def moment(brick: Brick) -> float:
    """Return moment of inertia [kg mm2] about y."""
    return brick.mass * (brick.size[0] ** 2 + brick.size[2] ** 2) / 12 * UNITS_PER_METRE**2


def in_plane(position: Vector, quaternion: Quaternion) -> tuple[tuple[float, float], float]:
    """Return position [mm] and angle [rad] in the engine's plane."""
    x, _, z = position
    w, _, j, _ = quaternion
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
