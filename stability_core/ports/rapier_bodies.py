"""Rapier's bodies and colliders by their ids, and the frames of their contact points."""

from __future__ import annotations

from collections.abc import Collection
from typing import TypeAlias

import numpy as np
import rapier3d

from stability_core.port import FloatArray
from stability_core.ports.rapier_calls import directed_manifolds
from stability_core.ports.rapier_shapes import IDENTITY, Frame, frames_of

_COLLIDER = 1 << 62
"""Summand of the id of a collider without a body, so that the id differs from the id of every body."""
Pair: TypeAlias = tuple[int, int, rapier3d.ContactPair]
"""Bodies a and b of a pair, and Rapier's pair."""


def id_of(handle: rapier3d.RigidBodyHandle) -> int:
    """Return the id of a body.

    The id is the handle's index plus 2**32 times the handle's generation. The generation is 0 unless Rapier has used
    the index before.
    """
    return _number(handle)


class RapierBodies:
    """Record of the bodies of a world, and of its colliders without a body, at the latest ``follow``."""

    def __init__(self, world: rapier3d.PhysicsWorld) -> None:
        self._world = world
        self.views: dict[int, rapier3d.RigidBody] = {}
        """Rapier's view of each body. A collider without a body has no view."""
        self.handles: dict[int, rapier3d.RigidBodyHandle] = {}
        """Handle of each body."""
        self.colliders: dict[int, list[rapier3d.ColliderHandle]] = {}
        """Colliders of each body, and each collider without a body."""
        self._listed: list[rapier3d.RigidBodyHandle] = []
        self._collider_count = 0
        self._knows_all = False  # False once a contact has named an unknown collider
        self._body_of: dict[rapier3d.ColliderHandle, int] = {}
        self._frames: dict[rapier3d.ColliderHandle, list[Frame]] = {}  # of colliders with another frame than the body
        self._with_center: set[int] = set()  # bodies whose centre of mass is not the origin of their frame

    def follow(self) -> bool:
        """Record the present bodies; return True if bodies or colliders have come or gone since the previous call."""
        world = self._world
        listed = list(world.rigid_bodies.handles())
        if self._knows_all and len(world.colliders) == self._collider_count and listed == self._listed:
            return False
        self._listed, self._collider_count, self._knows_all = listed, len(world.colliders), True
        self.handles = {id_of(handle): handle for handle in listed}
        self.views = {body: world.rigid_bodies[handle] for body, handle in self.handles.items()}
        self.colliders = {body: view.colliders for body, view in self.views.items()}
        for collider in world.colliders.handles():
            if world.colliders[collider].parent is None:
                self.colliders[_COLLIDER | _number(collider)] = [collider]
        self._body_of = {collider: body for body, each in self.colliders.items() for collider in each}
        frames = {collider: frames_of(world.colliders[collider]) for collider in self._body_of}
        self._frames = {collider: each for collider, each in frames.items() if each}
        self._with_center = {body for body, view in self.views.items() if any(view.local_center_of_mass.to_tuple())}
        return True

    def are_current(self, bodies: Collection[int]) -> bool:
        """Return True if ``bodies`` are in the world, and the numbers of bodies and colliders are as at ``follow``."""
        present, colliders = self._world.rigid_bodies, self._world.colliders
        if not self._knows_all or len(present) != len(self._listed) or len(colliders) != self._collider_count:
            return False
        for body in bodies:
            handle = self.handles.get(body)
            if self.colliders[body][0] not in colliders if handle is None else handle not in present:
                return False
        return True

    def colliders_of(self, body: int) -> list[rapier3d.Collider]:
        """Return Rapier's views of the colliders of a body."""
        return [self._world.colliders[collider] for collider in self.colliders[body]]

    def body_of(self, collider: rapier3d.ColliderHandle) -> int | None:
        """Return the body of a collider; None if the collider has gone or has come since ``follow``."""
        body = self._body_of.get(collider)
        if body is None:
            self._knows_all = False
        return body

    def motion_of(self, body: int) -> tuple[float, ...]:
        """Return the motion of a body or of a collider without a body, in the columns of ``body_motions``."""
        view = self.views.get(body)
        if view is None:
            (collider,) = self.colliders_of(body)
            return (*collider.translation.to_tuple(), *collider.rotation.to_tuple(), *(0.0,) * 6)
        center = view.center_of_mass if body in self._with_center else view.translation
        velocity: tuple[float, ...] = view.linvel.to_tuple() + view.angvel.to_tuple()
        return (*center.to_tuple(), *view.rotation.to_tuple(), *velocity)

    def places(self, bodies: list[int]) -> tuple[FloatArray, FloatArray]:
        """Return the positions (n, 3) [m] and the quaternions (w, x, y, z), shape (n, 4), of the frames of bodies."""
        placed = [self.views[body] if body in self.views else self.colliders_of(body)[0] for body in bodies]
        rows = np.array([each.translation.to_tuple() + each.rotation.to_tuple() for each in placed]).reshape(-1, 7)
        return rows[:, :3], rows[:, [6, 3, 4, 5]]

    def frames_of_points(self, listed: list[Pair]) -> tuple[list[Frame], list[Frame]] | None:
        """Return the frames, in the frames of bodies a and b, of the points that ``local_points`` returns.

        Returns:
            None if each frame equals the frame of its body.
        """
        if not self._frames:
            return None
        frames_a, frames_b = [], []
        for _, _, pair in listed:
            for manifold in directed_manifolds(pair):
                count = len(manifold.points)
                frames_a += [self._frame_of(pair.collider1, manifold.subshape1)] * count
                frames_b += [self._frame_of(pair.collider2, manifold.subshape2)] * count
        return frames_a, frames_b

    def _frame_of(self, collider: rapier3d.ColliderHandle, part: int) -> Frame:
        frames = self._frames.get(collider, [IDENTITY])
        return frames[part] if len(frames) > 1 else frames[0]


def _number(handle: rapier3d.RigidBodyHandle | rapier3d.ColliderHandle) -> int:
    number: int = (handle.generation << 32) | handle.index
    return number
