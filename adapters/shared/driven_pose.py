"""Pose of a body that the host moves at a prescribed velocity."""

from __future__ import annotations

import math

import numpy as np

from stability_core.port import FloatArray


def advanced(
    position: FloatArray, quaternion: FloatArray, linear: FloatArray, angular: FloatArray, seconds: float
) -> tuple[FloatArray, FloatArray]:
    """Return position (3,) [m] and quaternion (4,) after ``seconds`` at constant velocities (3,) [m/s], [rad/s].

    The angular velocity w is in the world's frame, and the turn is exact: q' = exp(w t / 2) q.
    """
    speed = float(np.linalg.norm(angular))
    if speed == 0.0:
        return position + linear * seconds, quaternion
    half = speed * seconds / 2
    x, y, z = angular / speed * math.sin(half)
    w = math.cos(half)
    turn = np.array([[w, -x, -y, -z], [x, w, -z, y], [y, z, w, -x], [z, -y, x, w]])
    turned = turn @ quaternion
    return position + linear * seconds, turned / np.linalg.norm(turned)
