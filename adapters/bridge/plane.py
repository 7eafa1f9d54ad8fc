"""Checks of a planar engine behind the bridge, which plays the x-z plane."""

from __future__ import annotations

from scenarios.model import Quaternion, Vector

_ROUNDING = 1e-9
"""Distance [m] from the plane, and component of a quaternion, that are rounding, no more."""


def check_pose_in_plane(engine: str, position: Vector, quaternion: Quaternion) -> None:
    """Raise ``ValueError`` unless the pose lies in the plane."""
    _, y, _ = position
    _, i, _, k = quaternion
    if abs(y) > _ROUNDING:
        raise ValueError(f"{engine} is planar: put the brick's centre at y = 0, got y = {y} m")
    if max(abs(i), abs(k)) > _ROUNDING:
        raise ValueError(f"{engine} is planar: turn bricks about the y axis only, got quaternion {quaternion}")


def check_vector_in_plane(engine: str, what: str, vector: Vector) -> None:
    """Raise ``ValueError`` unless the vector lies in the plane."""
    if vector[1] != 0.0:
        raise ValueError(f"{engine} is planar: {what} must lie in the x-z plane, got {vector}")
