"""Functions of many vectors and quaternions, one per row."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stability_core.port import FloatArray

_LEVI_CIVITA = np.cross(np.eye(3)[:, None], np.eye(3)).transpose(2, 0, 1)


def dot(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return the scalar products of vectors (..., 3), shape (...)."""
    return np.asarray((a * b).sum(axis=-1))


def cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return the cross products of vectors (..., 3).

    For a few rows, the function is several times as fast as ``numpy.cross``.
    """
    return np.asarray(np.einsum("ijk,...j,...k->...i", _LEVI_CIVITA, a, b))


def rotate(quaternions: FloatArray, vectors: FloatArray) -> FloatArray:
    """Rotate vectors (n, 3) from the bodies' frames to the world's frame, by unit quaternions (w, x, y, z) (n, 4)."""
    scalar, axis = quaternions[:, :1], quaternions[:, 1:]
    twice = 2 * cross(axis, vectors)
    return vectors + scalar * twice + cross(axis, twice)


def rows_of(vectors: Sequence[Sequence[float] | FloatArray], width: int) -> FloatArray:
    """Return a sequence of n vectors as an array of shape (n, width), also for n = 0."""
    return np.array(vectors, np.float64).reshape(len(vectors), width)
