"""Vectors and quaternions: row by row for the contacts of a frame, and one by one for engines."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from scenarios.model import Quaternion, Vector
from stability_core.port import FloatArray

_LEVI_CIVITA = np.cross(np.eye(3)[:, None], np.eye(3)).transpose(2, 0, 1)


def dot(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return scalar products over the last axis."""
    return np.asarray((a * b).sum(axis=-1))


def cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return as ``numpy.cross`` over the last axis, several times as fast for a few rows."""
    return np.asarray(np.einsum("ijk,...j,...k->...i", _LEVI_CIVITA, a, b))


def rotate(quaternions: FloatArray, vectors: FloatArray) -> FloatArray:
    """Return vectors (n, 3) of the bodies' own frames in the world's frame; quaternions (n, 4) as w, x, y, z."""
    scalar, axis = quaternions[:, :1], quaternions[:, 1:]
    twice = 2 * cross(axis, vectors)
    return vectors + scalar * twice + cross(axis, twice)


def rows_of(vectors: Sequence[Sequence[float] | FloatArray], width: int) -> FloatArray:
    """Return vectors as the rows of an array, shape (n, width), also for n = 0."""
    return np.array(vectors, np.float64).reshape(len(vectors), width)


def half_edges(size: Vector) -> Vector:
    """Return half of a box's edges."""
    x, y, z = size
    return x / 2, y / 2, z / 2


def scalar_last(quaternion: Quaternion) -> Quaternion:
    """Return a quaternion (w, x, y, z) as (x, y, z, w)."""
    w, x, y, z = quaternion
    return x, y, z, w
