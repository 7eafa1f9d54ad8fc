"""DART's contacts as arrays, and the bodies that they name."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from adapters.shared.vectors import rows_of
from stability_core.port import FloatArray, IntArray


class CollisionObjects:
    """Finds the bodies of DART's collision objects, by the names of their skeletons.

    Python's wrapper of a collision object goes by its address. One that is kept beyond its skeleton answers for
    whatever is made there next, so that an object must be forgotten before its skeleton is removed.
    """

    def __init__(self) -> None:
        self._body_of: dict[Any, int] = {}  # filled as they are first met: a name costs several calls

    def pairs_of(self, contacts: Sequence[Any]) -> tuple[IntArray, IntArray]:
        """Return bodies a and b of contacts, each of shape (n,)."""
        return (
            np.array([self.body_of(contact.collisionObject2) for contact in contacts], np.int64),
            np.array([self.body_of(contact.collisionObject1) for contact in contacts], np.int64),
        )

    def body_of(self, collision_object: Any) -> int:
        """Return the body, the ground or the fixed box that a collision object belongs to."""
        body = self._body_of.get(collision_object)
        if body is None:
            body = int(collision_object.getShapeFrame().getSkeleton().getName())
            self._body_of[collision_object] = body
        return body

    def forget(self, body: int) -> None:
        """Forget the collision object of a body."""
        self._body_of = {shape: known for shape, known in self._body_of.items() if known != body}

    def clear(self) -> None:
        """Forget all collision objects."""
        self._body_of.clear()


def geometry_of(contacts: Sequence[Any]) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return points (n, 3) [m], normals (n, 3) from a to b, and separations (n,) [m]."""
    point = rows_of([contact.point for contact in contacts], 3)
    normal = rows_of([contact.normal for contact in contacts], 3)
    return point, normal, -np.array([contact.penetrationDepth for contact in contacts])


def forces_of(contacts: Sequence[Any]) -> FloatArray:
    """Return forces (n, 3) [N] on b."""
    return rows_of([contact.force for contact in contacts], 3)
