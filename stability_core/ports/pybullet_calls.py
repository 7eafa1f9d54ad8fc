"""Calls of PyBullet for contacts and freezing, for the port and for the suite's adapter.

``freeze`` stops the body, and sets its mass to 0 and its activation state to asleep. The body is then static:
no step of Bullet changes a bit of its pose, and Bullet does not collide two frozen bodies. ``unfreeze`` restores the
mass. Bullet then computes the inertia again from the shape. The body keeps the gravity from before the freeze until the
next ``setGravity``.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy as np
import pybullet

from stability_core.port import FloatArray, IntArray
from stability_core.ports.shared.vectors import rows_of

Row: TypeAlias = tuple[Any, ...]
"""One row of ``pybullet.getContactPoints``."""
Listed: TypeAlias = tuple[int, int, Row]
"""Bodies a and b of a contact, and Bullet's row of the contact."""

_NOT_MOVING = (0.0, 0.0, 0.0)


def pairs_of(listed: Sequence[Listed]) -> tuple[IntArray, IntArray]:
    """Return bodies a and b of contacts, each of shape (n,)."""
    pairs = np.array([pair[:2] for pair in listed], np.int64).reshape(-1, 2)
    return pairs[:, 0], pairs[:, 1]


def geometry_of(listed: Sequence[Listed]) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return points (n, 3) [m], normals (n, 3) from a to b, and separations (n,) [m], in the world's frame."""
    numbers = rows_of([(*row[5], *row[6], *row[7], row[8]) for _, _, row in listed], 10)
    point = (numbers[:, :3] + numbers[:, 3:6]) / 2
    normal = -numbers[:, 6:9]  # Bullet's normal points from b to a
    return point, normal, numbers[:, 9]


def forces_of(listed: Sequence[Listed]) -> FloatArray:
    """Return forces (n, 3) [N] on body b: the sum of the normal force and of friction in its two directions."""
    numbers = rows_of([(*row[7], row[9], *row[11], row[10], *row[13], row[12]) for _, _, row in listed], 12)
    directions, sizes = numbers.reshape(-1, 3, 4)[..., :3], numbers.reshape(-1, 3, 4)[..., 3:]
    forces: FloatArray = -(sizes * directions).sum(axis=1)
    return forces


def stop(handle: int, client: int) -> None:
    """Set the velocity and the angular velocity of a body to zero."""
    pybullet.resetBaseVelocity(handle, _NOT_MOVING, _NOT_MOVING, client)


def freeze(handle: int, client: int) -> None:
    """Make a body static and asleep."""
    stop(handle, client)
    pybullet.changeDynamics(
        handle, -1, mass=0.0, activationState=pybullet.ACTIVATION_STATE_SLEEP, physicsClientId=client
    )


def unfreeze(handle: int, client: int, mass: float, activation: int) -> None:
    """Make a static body dynamic again, at rest, with this mass [kg] and activation state.

    Bullet applies the gravity of the time at which the body was last active: call ``setGravity`` again if gravity has
    changed.
    """
    pybullet.changeDynamics(handle, -1, mass=mass, activationState=activation, physicsClientId=client)
    stop(handle, client)
