"""Coordinates of DART's free joints: a rotation vector [rad], then a position [m], along the world's axes."""

from __future__ import annotations

import numpy as np

from scenarios.model import Quaternion, Vector
from stability_core.port import FloatArray


def coordinates_of(position: Vector, quaternion: Quaternion) -> FloatArray:
    """Return a free joint's coordinates (6,): rotation vector [rad], then position [m]."""
    shorter_way = np.array(quaternion) * (1 if quaternion[0] >= 0 else -1)
    axis = shorter_way[1:]
    sine = np.linalg.norm(axis)
    if sine > 0:
        axis *= 2 * np.arctan2(sine, shorter_way[0]) / sine
    return np.concatenate([axis, position])


def quaternions_of(rotation_vectors: FloatArray) -> FloatArray:
    """Convert rotation vectors (n, 3) [rad] to quaternions (w, x, y, z), shape (n, 4)."""
    half = np.linalg.norm(rotation_vectors, axis=1, keepdims=True) / 2
    return np.hstack([np.cos(half), rotation_vectors / 2 * np.sinc(half / np.pi)])
