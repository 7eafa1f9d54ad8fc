"""Calls of DART for contacts and freezing, for the port and for the suite's adapter.

``freeze`` stops a skeleton and makes it immobile. DART does not integrate an immobile skeleton, and leaves the skeleton
out of the contact problem. Therefore no step changes a bit of the skeleton's pose. DART lists no contacts between two
immobile skeletons.

A normal of DART points from object 2 to object 1, so that object 2 is body a.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from stability_core.port import FloatArray, IntArray
from stability_core.ports.shared.vectors import rows_of


def freeze(skeleton: Any) -> None:
    """Stop a skeleton, and make it immobile."""
    skeleton.resetVelocities()
    skeleton.setMobile(False)


def unfreeze(skeleton: Any) -> None:
    """Make a skeleton mobile, at rest."""
    skeleton.resetVelocities()
    skeleton.setMobile(True)


class CollisionObjects:
    """Map from DART's collision objects to the ids of bodies.

    A memory address identifies the Python wrapper of a collision object. DART may reuse the address after the
    skeleton's removal. The caller must therefore call ``forget`` before it removes a skeleton, or ``clear`` afterwards.
    """

    def __init__(self, id_of: Callable[[Any], int]) -> None:
        """Create an empty map; ``id_of`` returns the id of the body to which a shape node belongs."""
        self._id_of = id_of
        self._body_of: dict[Any, int] = {}  # a cache, because the search for a body takes several calls

    def pairs_of(self, contacts: Sequence[Any]) -> tuple[IntArray, IntArray]:
        """Return bodies a and b of contacts, each of shape (n,)."""
        return (
            np.array([self.body_of(contact.collisionObject2) for contact in contacts], np.int64),
            np.array([self.body_of(contact.collisionObject1) for contact in contacts], np.int64),
        )

    def body_of(self, collision_object: Any) -> int:
        """Return the id of the body to which a collision object belongs."""
        body = self._body_of.get(collision_object)
        if body is None:
            body = self._id_of(collision_object.getShapeFrame())
            self._body_of[collision_object] = body
        return body

    def forget(self, body: int) -> None:
        """Delete the collision objects of a body from the map."""
        self._body_of = {shape: known for shape, known in self._body_of.items() if known != body}

    def clear(self) -> None:
        """Delete all collision objects from the map."""
        self._body_of.clear()


def geometry_of(contacts: Sequence[Any]) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return points (n, 3) [m], normals (n, 3) from a to b, and separations (n,) [m], in the world's frame."""
    point = rows_of([contact.point for contact in contacts], 3)
    normal = rows_of([contact.normal for contact in contacts], 3)
    return point, normal, -np.array([contact.penetrationDepth for contact in contacts])


def forces_of(contacts: Sequence[Any]) -> FloatArray:
    """Return the forces (n, 3) [N] on body b of each contact, in the world's frame."""
    return rows_of([contact.force for contact in contacts], 3)
