"""Calls of Rapier for contacts and freezing, for the port and for the suite's adapter.

``freeze`` stops a body and makes it ``FIXED``. A body that becomes ``DYNAMIC`` again has the mass and inertia of its
colliders. Rapier scales a body's quaternion to unit length when its type changes and in later steps. Single precision
may have no quaternion of exactly unit length nearby. Each scaling then changes a last bit. Therefore a freeze also
settles the rotation (``rapier_rotation.py``).

Contacts are points in the frames of the two colliders. Rapier detects contacts at the start of a step. As long as a
pair hardly moves, Rapier keeps the contact points (the manifold) of an earlier step with their old distances. Therefore
the caller moves points and normals with the bodies to the present poses, and measures the separation there.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable

import numpy as np
import rapier3d

from stability_core.port import FloatArray, IntArray
from stability_core.ports.rapier_rotation import settle_rotation
from stability_core.ports.shared.vectors import rotate, rows_of

STRETCH = 1e-4
"""Stretch of a copy of a world. Rounding determines the normal between two polyhedra or cylinders with a gap of 0. By
the stretch, bodies of 10 mm have a gap of 1 um. Contact points do not move, because Rapier gives them in
the frames of the bodies.
"""

_Rule = rapier3d.CoefficientCombineRule
_COMBINED: dict[_Rule, Callable[[float, float], float]] = {
    _Rule.AVERAGE: lambda a, b: (a + b) / 2,
    _Rule.MIN: min,
    _Rule.MULTIPLY: lambda a, b: a * b,
    _Rule.MAX: max,
    _Rule.CLAMPED_SUM: lambda a, b: min(max(a + b, 0.0), 1.0),
    _Rule.GEOMETRIC_MEAN: lambda a, b: math.sqrt(a * b),
}
"""Coefficient of a pair, by the rule with the higher number of both colliders' rules."""


def friction_of(first: rapier3d.Collider, second: rapier3d.Collider) -> float:
    """Return the coefficient of friction between two colliders."""
    rule = max(first.friction_combine_rule, second.friction_combine_rule, key=int)
    return _COMBINED[rule](first.friction, second.friction)


def freeze(view: rapier3d.RigidBody) -> None:
    """Stop a dynamic body, and make it fixed, with a rotation that Rapier keeps."""
    stop(view)  # a fixed body with a velocity would keep moving
    view.body_type = rapier3d.RigidBodyType.FIXED
    settle_rotation(view)


def unfreeze(view: rapier3d.RigidBody) -> None:
    """Make a fixed body dynamic and awake."""
    view.body_type = rapier3d.RigidBodyType.DYNAMIC
    view.wake_up()


def stop(view: rapier3d.RigidBody) -> None:
    """Set the velocity and the angular velocity of a body to zero."""
    view.linvel = view.angvel = rapier3d.Vec3.zeros()


def copy_of(world: rapier3d.PhysicsWorld) -> rapier3d.PhysicsWorld:
    """Return a copy of a world for the detection of collisions.

    The colliders of the copy have the same handles. Do not call ``detect_collisions`` in the world itself, because the
    call changed later poses, and once made the next step crash.
    """
    return rapier3d.PhysicsWorld.restore(world.snapshot())


def stretch(world: rapier3d.PhysicsWorld) -> None:
    """Multiply all positions in a world by 1 + ``STRETCH``, so that convex bodies that touch have a gap."""
    placed: list[rapier3d.RigidBody | rapier3d.Collider] = [body for _, body in world.rigid_bodies]
    placed += [collider for _, collider in world.colliders if collider.parent is None]
    for each in placed:
        x, y, z = (number * (1.0 + STRETCH) for number in each.translation.to_tuple())
        each.translation = rapier3d.Vec3(x, y, z)


def directed_manifolds(pair: rapier3d.ContactPair) -> list[rapier3d.ContactManifold]:
    """Return the manifolds of a pair that have a direction.

    Where pieces of compound shapes touch in one point, the normal of Parry (Rapier's collision library) may be zero.
    """
    return [manifold for manifold in pair.manifolds if any(manifold.local_n1.to_tuple())]


def local_points(
    pairs_of_colliders: Iterable[tuple[int, int, rapier3d.ContactPair]],
) -> tuple[IntArray, FloatArray, FloatArray]:
    """Return Rapier's contact points of pairs, including points across a large gap.

    The function leaves out manifolds without a direction (see ``directed_manifolds``).

    Args:
        pairs_of_colliders: body a, body b, and Rapier's pair.

    Returns:
        Three arrays of n points:

        - bodies a and b, shape (n, 2);
        - the normal and the point on a [m] in the frame of a's collider, then the point on b [m] in the frame of b's
          collider, shape (n, 9);
        - the impulses [N s] along the normal, shape (n,).
    """
    pairs, rows, impulses = [], [], []
    for body_a, body_b, pair in pairs_of_colliders:
        for manifold in directed_manifolds(pair):
            normal = manifold.local_n1.to_tuple()
            for point in manifold.points:
                pairs.append((body_a, body_b))
                rows.append(normal + point.local_p1.to_tuple() + point.local_p2.to_tuple())
                impulses.append(point.impulse)
    return np.array(pairs, np.int64).reshape(-1, 2), rows_of(rows, 9), np.array(impulses, np.float64)


def placed_points(
    pairs: IntArray, positions: FloatArray, quaternions: FloatArray, local: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return normals, points on a and points on b [m] in the world's frame, each of shape (n, 3).

    Args:
        pairs: rows of bodies a and b in ``positions`` and ``quaternions``, shape (n, 2).
        positions: positions of bodies [m], shape (k, 3).
        quaternions: orientations of bodies (w, x, y, z), shape (k, 4).
        local: normals and points from ``local_points``, in the frames of the bodies, shape (n, 9).
    """
    a, b = pairs.T
    return (
        rotate(quaternions[a], local[:, :3]),
        positions[a] + rotate(quaternions[a], local[:, 3:6]),
        positions[b] + rotate(quaternions[b], local[:, 6:]),
    )
