"""Vectors of three by the row, for the few contacts of a frame."""

from __future__ import annotations

import numpy as np

from stability_core.port import FloatArray

_LEVI_CIVITA = np.cross(np.eye(3)[:, None], np.eye(3)).transpose(2, 0, 1)


def dot(a: FloatArray, b: FloatArray) -> FloatArray:
    """Scalar products over the last axis."""
    return np.asarray((a * b).sum(axis=-1))


def cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """As ``numpy.cross`` over the last axis, several times as fast for a few rows."""
    return np.asarray(np.einsum("ijk,...j,...k->...i", _LEVI_CIVITA, a, b))


def rotate(quaternions: FloatArray, vectors: FloatArray) -> FloatArray:
    """Vectors (n, 3) of the bodies' own frames in the world's frame; quaternions (n, 4) as w, x, y, z."""
    scalar, axis = quaternions[:, :1], quaternions[:, 1:]
    twice = 2 * cross(axis, vectors)
    return vectors + scalar * twice + cross(axis, twice)
