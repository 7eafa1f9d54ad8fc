"""Rapier's contact points, which are in the frames of the colliders, and their conversion to the world's frame."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable

import numpy as np
import rapier3d

from adapters.shared.vectors import rotate, rows_of
from stability_core.port import FloatArray, IntArray


def local_points(
    pairs_of_colliders: Iterable[tuple[int, int, rapier3d.ContactPair]],
) -> tuple[IntArray, FloatArray, FloatArray]:
    """Return all of Rapier's contact points of pairs, including points across a large gap.

    Args:
        pairs_of_colliders: body a, body b, and Rapier's pair.

    Returns:
        Three arrays of n points:

        - bodies a and b, shape (n, 2);
        - the normal and the point on a [m] in a's frame, then the point on b [m] in b's frame, shape (n, 9);
        - the impulses [N s] along the normal, shape (n,).
    """
    pairs, rows, impulses = [], [], []
    for body_a, body_b, pair in pairs_of_colliders:
        for manifold in pair.manifolds:
            normal = manifold.local_n1.to_tuple()
            for point in manifold.points:
                pairs.append((body_a, body_b))
                rows.append(normal + point.local_p1.to_tuple() + point.local_p2.to_tuple())
                impulses.append(point.impulse)
    return np.array(pairs, np.int64), rows_of(rows, 9), np.array(impulses, np.float64)


def in_bodies(pairs: IntArray, local: FloatArray, turned: Collection[int]) -> FloatArray:
    """Return normals and points (n, 9) in the frames of the bodies, given those in the frames of their colliders.

    Args:
        pairs: bodies a and b, shape (n, 2).
        local: normals and points from ``local_points``, shape (n, 9).
        turned: bodies whose collider is turned by 90 deg about x.
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
        fixed: positions (k, 3) [m] and quaternions (k, 4) of fixed boxes and ground, by rising id.
        poses_of: returns the positions (m, 3) [m] and quaternions (m, 4) of bodies, given their ids (m,).
    """
    fixed_positions, fixed_quaternions = fixed
    bodies, place = np.unique(pairs, return_inverse=True)
    rows = bodies[: np.searchsorted(bodies, 0)] + len(fixed_positions)  # negative ids, up to the ground's
    positions, quaternions = poses_of(bodies[len(rows) :])
    positions = np.vstack([fixed_positions[rows], positions])
    quaternions = np.vstack([fixed_quaternions[rows], quaternions])
    a, b = place.reshape(pairs.shape).T
    return (
        rotate(quaternions[a], local[:, :3]),
        positions[a] + rotate(quaternions[a], local[:, 3:6]),
        positions[b] + rotate(quaternions[b], local[:, 6:]),
    )
