"""``DartWorld``: access of ``FreeBodyPort`` to the body nodes of a user's DART world."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Set
from typing import Any

import numpy as np
from dartpy.dynamics import ActuatorType, FreeJoint

from stability_core.port import FloatArray
from stability_core.ports.dart_calls import CollisionObjects, forces_of, freeze, geometry_of, unfreeze
from stability_core.ports.dart_shapes import box_around, friction_of, motion_of, solid_of
from stability_core.ports.dart_twin import present_contacts
from stability_core.ports.shared.body_motions import COLUMNS
from stability_core.ports.shared.free_body_world import Concerns, FreeBodyWorld, Touching, Vector
from stability_core.ports.shared.shapes import Solid
from stability_core.ports.shared.vectors import dot, rows_of

_BY_FORCES = (ActuatorType.FORCE, ActuatorType.PASSIVE)
"""Actuator types of the joints that move by forces."""


class DartWorld(FreeBodyWorld):
    """The body nodes of a ``dartpy.simulation.World``."""

    engine = "DART"
    setter = "world.setTimeStep()"
    ids_from = "skeletons"

    def __init__(self, world: Any, *, takes_all: bool) -> None:
        self._world, self._takes_all = world, takes_all
        self._listed: list[tuple[Any, int]] = []  # each skeleton, with its number of bodies
        self.nodes: dict[int, Any] = {}
        """Body node of each id."""
        self.ids: dict[Any, int] = {}
        """Id of each body node."""
        self._frozen: set[int] = set()
        self._next = 0
        self._objects = CollisionObjects(lambda shape: self.ids[shape.getBodyNodePtr()])
        self._stale_steps = -1  # number of steps after which DART's list of contacts refers to freed memory

    def gravity(self) -> Vector:
        """Return the world's gravity [m/s2]."""
        x, y, z = self._world.getGravity().tolist()
        return x, y, z

    def step_s(self) -> float:
        """Return the time [s] of one step."""
        return float(self._world.getTimeStep())

    def check(self) -> None:
        """Raise ``ValueError`` if the world has constraints, and the user has not named the free bodies."""
        count = self._world.getConstraintSolver().getNumConstraints()
        if self._takes_all and count:
            raise ValueError(
                f"this DART world has constraints between bodies (count {count}), and DART does not say which bodies: "
                "pass the free bodies, attach(world, bodies=[...]), because the extension does not know the forces of "
                "joints"
            )

    def has_changed(self) -> bool:
        """Return True if bodies have come or gone since the previous call.

        A frozen body that has gone becomes mobile, because the user may add its skeleton again.
        """
        skeletons = [self._world.getSkeleton(index) for index in range(self._world.getNumSkeletons())]
        listed = [(skeleton, skeleton.getNumBodyNodes()) for skeleton in skeletons]
        if listed == self._listed:
            return False
        self._listed = listed
        nodes = [node for skeleton in skeletons for node in skeleton.getBodyNodes()]
        for node in self.ids.keys() - nodes:
            body = self.ids.pop(node)
            del self.nodes[body]
            self._stale_steps = self._world.getSimFrames()
            if body in self._frozen:  # the user may add the skeleton again, and expects it mobile
                self._frozen.remove(body)
                unfreeze(node.getSkeleton())
        for node in nodes:
            if node not in self.ids:
                self.ids[node], self.nodes[self._next] = self._next, node
                self._next += 1
        self._objects.clear()
        return True

    def can_read(self, bodies: Collection[int]) -> bool:
        """Return True if no body in ``bodies`` is mobile, and the number of skeletons is as at ``has_changed``.

        Otherwise the port may read DART's list of contacts. The list refers to freed memory once a skeleton has left.
        """
        return self._world.getNumSkeletons() == len(self._listed) and not any(map(self.is_mover, bodies))

    def bodies(self) -> list[int]:
        """Return the ids of the bodies of the world at the latest ``has_changed``."""
        return [*self.nodes]

    def reason_against(self, body: int) -> str | None:
        """Return why a body that is not frozen cannot freeze, and the fix; None if it can freeze."""
        node = self.nodes[body]
        skeleton = node.getSkeleton()
        name, joint = f"({skeleton.getName()!r})", skeleton.getJoint(0)
        if not skeleton.getNumDofs():
            return f"{name} is fixed to the world, so that it cannot fall: list free bodies only"
        if skeleton.getNumBodyNodes() > 1 or not isinstance(joint, FreeJoint):
            return f"{name} has joints: list free bodies only, because the extension leaves robots alone"
        if not skeleton.isMobile():
            return f"{name} is immobile, so that it cannot fall: call setMobile(True), or leave out the body"
        if joint.getActuatorType() not in _BY_FORCES:
            return f"{name} has an actuator, which drives its joint: leave out the body, or set ActuatorType.FORCE"
        if not node.getGravityMode():
            return (
                f"{name} has no gravity, so that it stands by itself: leave out the body, or call setGravityMode(True)"
            )
        return None

    def mass(self, body: int) -> float:
        """Return the mass [kg] of a live body."""
        return float(self.nodes[body].getMass())

    def solid(self, body: int) -> Solid | None:
        """Return the shape of a body, relative to its centre of mass: see ``solid_of``."""
        return solid_of(self.nodes[body])

    def motions(self, bodies: list[int]) -> FloatArray:
        """Return the motions of bodies in the columns of ``body_motions``, shape (n, 13)."""
        return rows_of([motion_of(self.nodes[body]) for body in bodies], COLUMNS)

    def box(self, body: int) -> FloatArray:
        """Return the lower, then the upper corner [m] of the box around a body, along the world's axes, shape (6,)."""
        return box_around(self.nodes[body])

    def is_kinematic(self, body: int) -> bool:
        """Return True for an immobile body that the user may move by its joint's positions."""
        skeleton = self.nodes[body].getSkeleton()
        return bool(skeleton.getNumDofs()) and not skeleton.isMobile()

    def is_mover(self, body: int) -> bool:
        """Return True for a mobile body with degrees of freedom, because forces or an actuator may move this body."""
        skeleton = self.nodes[body].getSkeleton()
        return bool(skeleton.getNumDofs()) and bool(skeleton.isMobile())

    def freeze(self, body: int) -> None:
        """Freeze a live body at its present pose."""
        self._frozen.add(body)
        freeze(self.nodes[body].getSkeleton())

    def unfreeze(self, body: int) -> None:
        """Make a frozen body live, at rest."""
        self._frozen.remove(body)
        unfreeze(self.nodes[body].getSkeleton())

    def step_contacts(self, concerns: Concerns, bodies: Set[int]) -> Touching:
        """Return the contacts of the latest step that ``concerns`` selects.

        If a skeleton has left since the step, return the contacts of the present poses.
        """
        if self._world.getSimFrames() == self._stale_steps:
            return self.present_contacts(concerns, bodies)
        contacts = self._world.getLastCollisionResult().getContacts()
        return _touching(contacts, self._objects, concerns, lambda frame: (frame, 0.0))

    def present_contacts(self, concerns: Concerns, bodies: Set[int]) -> Touching:  # noqa: ARG002
        """Return the contacts of the present poses that ``concerns`` selects, without a change of the world."""
        with present_contacts(self._world, self.nodes) as (contacts, originals):
            copies = CollisionObjects(lambda frame: originals[frame].body)
            return _touching(contacts, copies, concerns, lambda frame: originals[frame][1:])


def _touching(
    contacts: Iterable[Any],
    objects: CollisionObjects,
    concerns: Concerns,
    original_of: Callable[[Any], tuple[Any, float]],
) -> Touching:
    """Return the contacts of DART that ``concerns`` selects.

    Args:
        contacts: DART's contacts.
        objects: map from collision objects to ids of bodies.
        concerns: returns True if the port needs the contacts of two bodies.
        original_of: returns the shape node of a collision object's frame, and the growth of the frame [m].
    """
    every = [*contacts]
    ids = zip(*(side.tolist() for side in objects.pairs_of(every)), strict=True)
    named = [(pair, contact) for pair, contact in zip(ids, every, strict=True) if concerns(*pair)]
    body_a, body_b = np.array([pair for pair, _ in named], np.int64).reshape(-1, 2).T
    listed = [contact for _, contact in named]
    point, normal, separation = geometry_of(listed)
    pushes = dot(forces_of(listed), normal)[:, None] * normal
    known: dict[tuple[Any, Any], tuple[float, float]] = {}  # friction and growth of each pair
    friction, growth = np.empty(len(listed)), np.empty(len(listed))
    for row, contact in enumerate(listed):
        pair = contact.collisionObject1, contact.collisionObject2
        if pair not in known:
            (shape, larger), (other, other_larger) = (original_of(part.getShapeFrame()) for part in pair)
            known[pair] = min(friction_of(shape), friction_of(other)), larger + other_larger
        friction[row], growth[row] = known[pair]
    return Touching(body_a, body_b, point, normal, separation + growth, friction, pushes)
