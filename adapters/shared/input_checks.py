"""Checks of the host's input, once for all engines: no engine sees a NaN."""

from __future__ import annotations

import math

import numpy as np

from scenarios.model import Brick, Quaternion, Vector


def check_finite(quantity: str, value: Vector, unit: str) -> None:
    """Raise ``ValueError`` unless all components are finite."""
    if not np.isfinite(value).all():
        raise ValueError(f"{quantity} must be finite, got {value} {unit}")


def check_mass(brick: Brick) -> None:
    """Raise ``ValueError`` unless the mass is positive and finite."""
    if not (math.isfinite(brick.mass) and brick.mass > 0):
        raise ValueError(f"brick mass must be positive and finite, got {brick.mass} kg")


def check_box(brick: Brick) -> None:
    """Raise ``ValueError`` unless size and pose are those of a box."""
    if not all(math.isfinite(edge) and edge > 0 for edge in brick.size):
        raise ValueError(f"brick size must be three positive lengths, got {brick.size} m")
    check_pose(brick.position, brick.quaternion)


def check_pose(position: Vector, quaternion: Quaternion) -> None:
    """Raise ``ValueError`` unless the position is finite and the quaternion of unit length."""
    check_finite("position", position, "m")
    if not abs(np.linalg.norm(quaternion) - 1) < 1e-6:  # written so that NaN fails too
        raise ValueError(f"quaternion (w, x, y, z) must be of unit length, got {quaternion}")
