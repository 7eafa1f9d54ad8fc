"""Checks of the host's input, shared by all engines, so that no engine receives a NaN."""

from __future__ import annotations

import math

import numpy as np

from scenarios.model import Brick, Quaternion, Vector
from scenarios.solids import check_solid

MAX_OFF_PLANE = 1e-9
"""Tolerance for rounding of a pose in a planar engine: distance from the plane [m], and quaternion component."""


def check_finite(quantity: str, value: Vector, unit: str) -> None:
    """Raise ``ValueError``, which names ``quantity`` and ``unit``, unless all components of a vector are finite."""
    if not np.isfinite(value).all():
        raise ValueError(
            f"{quantity} must be finite, got {value} {unit}; give finite numbers, and check for a division by zero"
        )


def check_mass(brick: Brick) -> None:
    """Raise ``ValueError`` unless the mass of a brick is positive and finite."""
    if not (math.isfinite(brick.mass) and brick.mass > 0):
        raise ValueError(
            f"brick mass must be positive and finite, got {brick.mass} kg for the brick at {brick.position} m; give "
            "Brick.mass a number above 0 kg"
        )


def check_body(brick: Brick) -> None:
    """Raise ``ValueError`` unless a brick has a valid shape, size and pose."""
    check_solid(brick)
    check_pose(brick.position, brick.quaternion)


def check_pose(position: Vector, quaternion: Quaternion) -> None:
    """Raise ``ValueError`` unless the position [m] is finite and the quaternion (w, x, y, z) has unit length."""
    check_finite("position", position, "m")
    if not abs(np.linalg.norm(quaternion) - 1) < 1e-6:  # written so that NaN fails too
        raise ValueError(
            f"quaternion (w, x, y, z) must be of unit length, got {quaternion} for the body at {position} m; divide "
            "the quaternion by its length"
        )


def check_vector_in_plane(engine: str, quantity: str, value: Vector, unit: str) -> None:
    """Raise ``ValueError`` unless a vector lies in the plane of a planar engine."""
    if value[1] != 0.0:
        raise ValueError(
            f"{engine} is planar: {quantity} must lie in the x-z plane, got {value} {unit}: set the y component to 0"
        )


def check_pose_in_plane(engine: str, position: Vector, quaternion: Quaternion) -> None:
    """Raise ``ValueError`` unless a pose lies in the plane of a planar engine."""
    _, y, _ = position
    _, i, _, k = quaternion
    if abs(y) > MAX_OFF_PLANE:
        raise ValueError(
            f"{engine} is planar: the brick's centre must lie at y = 0, got the position {position} m: set y to 0, or "
            "use an engine in three dimensions"
        )
    if max(abs(i), abs(k)) > MAX_OFF_PLANE:
        raise ValueError(
            f"{engine} is planar: a brick may turn about the y axis only, got the quaternion {quaternion} for the "
            f"brick at {position} m: set the x and z components of the quaternion to 0"
        )
