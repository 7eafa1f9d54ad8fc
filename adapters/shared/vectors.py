"""Functions of single vectors and quaternions for engines, and the functions of many rows that the ports use too."""

from __future__ import annotations

from scenarios.model import Quaternion, Vector
from stability_core.ports.shared.vectors import cross, dot, rotate, rows_of

__all__ = ["cross", "dot", "half_edges", "rotate", "rows_of", "scalar_last"]


def half_edges(size: Vector) -> Vector:
    """Return the half edges [m] of a box with edges ``size`` [m]."""
    x, y, z = size
    return x / 2, y / 2, z / 2


def scalar_last(quaternion: Quaternion) -> Quaternion:
    """Convert a quaternion (w, x, y, z) to the order (x, y, z, w)."""
    w, x, y, z = quaternion
    return x, y, z, w
