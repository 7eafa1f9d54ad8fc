"""Conversion of Rapier's contact points from the frames of the colliders to the world's frame."""

from __future__ import annotations

from collections.abc import Callable, Collection

import numpy as np

from stability_core.port import FloatArray, IntArray
from stability_core.ports.rapier_calls import placed_points


def in_bodies(pairs: IntArray, local: FloatArray, turned: Collection[int]) -> FloatArray:
    """Convert normals and points (n, 9), in place, from the frames of the colliders to the frames of the bodies.

    Args:
        pairs: bodies a and b, shape (n, 2).
        local: normals and points from ``local_points``, shape (n, 9).
        turned: bodies whose collider has a turn of 90 deg about x in the body's frame.
    """
    if not turned:
        return local
    is_turned = np.isin(pairs, list(turned))
    for column, body in ((0, 0), (3, 0), (6, 1)):
        rows = is_turned[:, body]
        x, y, z = local[rows, column : column + 3].T
        local[rows, column : column + 3] = np.column_stack([x, -z, y])
    return local


def in_world(
    pairs: IntArray,
    local: FloatArray,
    fixed: tuple[FloatArray, FloatArray],
    poses_of: Callable[[IntArray], tuple[FloatArray, FloatArray]],
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return normals, points on a and points on b [m] in the world's frame, each of shape (n, 3).

    Args:
        pairs: bodies a and b, shape (n, 2).
        local: normals and points from ``local_points``, shape (n, 9).
        fixed: positions (k, 3) [m] and quaternions (k, 4) of fixed bodies and ground, by rising id.
        poses_of: returns the positions (m, 3) [m] and quaternions (m, 4) of bodies, given their ids (m,).
    """
    fixed_positions, fixed_quaternions = fixed
    bodies, place = np.unique(pairs, return_inverse=True)
    rows = bodies[: np.searchsorted(bodies, 0)] + len(fixed_positions)  # negative ids, up to the ground's
    positions, quaternions = poses_of(bodies[len(rows) :])
    positions = np.vstack([fixed_positions[rows], positions])
    quaternions = np.vstack([fixed_quaternions[rows], quaternions])
    return placed_points(place.reshape(pairs.shape), positions, quaternions, local)
