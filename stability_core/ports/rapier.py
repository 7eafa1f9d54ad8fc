"""A port to a Rapier world that the user owns.

The id of a body is ``id_of(handle)``. The port controls free dynamic bodies. All other bodies are obstacles:

- kinematic, fixed and disabled bodies;
- bodies with joints, locked axes or a contact skin, and bodies without mass or without the world's gravity;
- bodies that the user leaves out;
- colliders without a body.

The port returns Rapier's contacts, and adds the missing corners of contact areas between boxes, standing cylinders,
convex polyhedra and half spaces. The port changes no setting of the world or of a live body.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Set
from itertools import chain
from typing import Any

import numpy as np
import rapier3d

from stability_core.port import FloatArray
from stability_core.ports.rapier_bodies import Pair, RapierBodies, id_of
from stability_core.ports.rapier_calls import (
    copy_of,
    freeze,
    friction_of,
    local_points,
    placed_points,
    stretch,
    unfreeze,
)
from stability_core.ports.rapier_shapes import in_bodies, solid_of
from stability_core.ports.shared.body_motions import COLUMNS
from stability_core.ports.shared.body_pairs import pairs_of
from stability_core.ports.shared.free_body_port import FreeBodyPort
from stability_core.ports.shared.free_body_world import Concerns, FreeBodyWorld, Touching, Vector
from stability_core.ports.shared.shapes import Solid
from stability_core.ports.shared.vectors import dot

__all__ = ["RapierWorld", "id_of", "open_port"]

MAX_SEPARATION = 0.1e-3
"""Greatest gap [m] of a contact point. Rapier also lists points within its prediction distance. The value may be small,
because bodies at rest sink into Rapier's soft contacts."""


def open_port(world: Any, bodies: Collection[int] | None) -> FreeBodyPort:
    """Return a port to a world of Rapier.

    Args:
        world: a ``rapier3d.PhysicsWorld``.
        bodies: ids of the bodies to control, see ``id_of``; None for all bodies that can freeze.

    Raises:
        TypeError: if ``world`` is no ``rapier3d.PhysicsWorld``.
        ValueError: if a body cannot freeze, or ``bodies`` lists a body twice.
    """
    if not isinstance(world, rapier3d.PhysicsWorld):
        raise TypeError(
            f"attach() needs a rapier3d.PhysicsWorld, got {type(world).__name__}: build the world by "
            "rapier3d.PhysicsWorld(gravity=(0, 0, -9.81)), and add bodies by its add_body()"
        )
    return FreeBodyPort(RapierWorld(world), ("rapier", id(world)), bodies)


class RapierWorld(FreeBodyWorld):
    """The rigid bodies of a ``PhysicsWorld``, and its colliders without a body."""

    engine = "Rapier"
    setter = "world.integration_parameters.dt"
    ids_from = "id_of(handle) of stability_core.ports.rapier,"

    def __init__(self, world: rapier3d.PhysicsWorld) -> None:
        self.world = world
        self._bodies = RapierBodies(world)
        # frozen bodies on Rapier's list of active bodies, in the order of the stages of ``rest``
        self._active, self._kinematic, self._asleep = set[int](), set[int](), set[int]()

    def gravity(self) -> Vector:
        """Return the world's gravity [m/s2]."""
        gravity: Vector = self.world.gravity.to_tuple()
        return gravity

    def step_s(self) -> float:
        """Return the time [s] of one step."""
        seconds: float = self.world.integration_parameters.dt
        return seconds

    def check(self) -> None:
        """Raise ``ValueError`` if Rapier has disabled a body in the latest step, because its state was not finite."""
        quarantine = self.world.quarantine
        if not quarantine.is_empty():
            lost = [id_of(handle) for handle in quarantine.bodies]
            raise ValueError(
                f"Rapier has disabled the bodies {lost}, because a pose or a velocity was not finite, and the "
                "simulation has diverged: use a smaller step or softer contacts, or remove the bodies"
            )

    def has_changed(self) -> bool:
        """Return True if bodies or colliders have come or gone since the previous call."""
        return self._bodies.follow()

    def can_read(self, bodies: Collection[int]) -> bool:
        """Return True if ``bodies`` are in the world, and the world has as many bodies and colliders as before."""
        return self._bodies.are_current(bodies)

    def rest(self) -> None:
        """Take frozen bodies off Rapier's list of active bodies, in three stages; each call makes one stage of a body.

        A body whose type has changed stays on the list, unless the body is kinematic and has been asleep for a step.
        Therefore a frozen body first becomes kinematic, then falls asleep, then becomes fixed. A kinematic body at rest
        keeps its place as a fixed body does.
        """
        present = self._bodies.views.keys()
        for body in self._asleep & present:
            self._bodies.views[body].body_type = rapier3d.RigidBodyType.FIXED
        for body in self._kinematic & present:
            self._bodies.views[body].sleep()
        for body in self._active & present:
            self._bodies.views[body].body_type = rapier3d.RigidBodyType.KINEMATIC_POSITION_BASED
        self._active, self._kinematic, self._asleep = set(), self._active, self._kinematic

    def bodies(self) -> list[int]:
        """Return the ids of bodies and of colliders without a body at the latest ``has_changed``."""
        return [*self._bodies.colliders]

    def reason_against(self, body: int) -> str | None:
        """Return why a body that is not frozen cannot freeze, and the fix; None if it can freeze."""
        view = self._bodies.views.get(body)
        if view is None or view.is_fixed:
            return "is fixed already: list dynamic bodies only"
        if view.is_kinematic:
            return "is kinematic, so that it cannot fall: list dynamic bodies only"
        if self._has_joints(body):
            return "has joints: list free bodies only, because the extension does not know the forces of joints"
        if view.gravity_scale != 1.0:
            return "has a gravity_scale other than 1: leave out the body, or set gravity_scale = 1.0"
        if view.locked_axes.bits:
            return "has locked axes: leave out the body, or set locked_axes = rapier3d.LockedAxes.empty()"
        if not view.is_enabled:
            return "is disabled: leave out the body, or set is_enabled = True after you fix the cause"
        if view.mass <= 0.0:
            return "has no mass: give its collider a density or a mass"
        if any(collider.contact_skin for collider in self._bodies.colliders_of(body)):
            return (
                "has a collider with a skin, which touches across a gap: leave out the body, or set contact_skin = 0.0"
            )
        return None

    def mass(self, body: int) -> float:
        """Return the mass [kg] of a live body."""
        return float(self._bodies.views[body].mass)

    def solid(self, body: int) -> Solid | None:
        """Return the shape of a body, relative to its centre of mass: see ``solid_of``."""
        view = self._bodies.views.get(body)
        center = np.zeros(3) if view is None else np.array(view.local_center_of_mass.to_tuple())
        return solid_of(self._bodies.colliders_of(body), center)

    def motions(self, bodies: list[int]) -> FloatArray:
        """Return the motions of bodies in the columns of ``body_motions``, shape (n, 13)."""
        return np.array([self._bodies.motion_of(body) for body in bodies], np.float64).reshape(-1, COLUMNS)

    def box(self, body: int) -> FloatArray:
        """Return the lower, then the upper corner [m] of the box around a body, along the world's axes, shape (6,).

        All six numbers are infinite for a body without colliders.
        """
        boxes = [collider.compute_aabb() for collider in self._bodies.colliders_of(body)]
        lower = np.min([box.mins.to_tuple() for box in boxes], axis=0, initial=np.inf)
        return np.concatenate([lower, np.max([box.maxs.to_tuple() for box in boxes], axis=0, initial=-np.inf)])

    def is_kinematic(self, body: int) -> bool:
        """Return True for a body that the user moves; Rapier lists no contact between this body and a frozen body."""
        return body in self._bodies.views and bool(self._bodies.views[body].is_kinematic)

    def is_mover(self, body: int) -> bool:
        """Return True if a body that the port does not control moves by forces: a free body, or a body with joints."""
        return body in self._bodies.views and bool(self._bodies.views[body].is_dynamic)

    def freeze(self, body: int) -> None:
        """Freeze a live body at its present pose."""
        freeze(self._bodies.views[body])
        self._active.add(body)

    def unfreeze(self, body: int) -> None:
        """Make a frozen body live, at rest."""
        self._active.discard(body)
        self._kinematic.discard(body)
        self._asleep.discard(body)
        unfreeze(self._bodies.views[body])

    def step_contacts(self, concerns: Concerns, bodies: Set[int]) -> Touching:
        """Return the contacts of the latest step that ``concerns`` selects, at the present poses."""
        return self._touching(self.world.narrow_phase, concerns, bodies)

    def present_contacts(self, concerns: Concerns, bodies: Set[int]) -> Touching:
        """Return the contacts of the present poses that ``concerns`` selects, without a change of the world."""
        copied = copy_of(self.world)
        stretch(copied)
        copied.detect_collisions()
        return self._touching(copied.narrow_phase, concerns, bodies)

    # -- helpers --------------------------------------------------------------------------------------

    def _has_joints(self, body: int) -> bool:
        handle = self._bodies.handles[body]
        if self.world.multibody_joints.rigid_body_link(handle) is not None:
            return True
        return any(True for _ in self.world.impulse_joints.attached_joints(handle))

    def _touching(self, narrow_phase: rapier3d.NarrowPhase, concerns: Concerns, bodies: Set[int]) -> Touching:
        listed = [pair for pair in self._pairs(narrow_phase, bodies) if concerns(*pair[:2])]
        pairs, local, impulses = local_points(listed)
        frames = self._bodies.frames_of_points(listed)
        if frames is not None:
            local = in_bodies(local, *frames)
        present = sorted({body for a, b, _ in listed for body in (a, b)})
        rows = np.searchsorted(np.array(present, np.int64), pairs)
        normals, points_a, points_b = placed_points(rows, *self._bodies.places(present), local)
        separations = dot(points_b - points_a, normals)
        near = np.flatnonzero(separations <= MAX_SEPARATION)
        friction = {(a, b): self._friction_of(pair) for a, b, pair in listed}
        body_a, body_b = pairs[near].T
        coefficients = [friction[a, b] for a, b in zip(body_a.tolist(), body_b.tolist(), strict=True)]
        normal = normals[near]
        return Touching(
            body_a,
            body_b,
            (points_a[near] + points_b[near]) / 2,
            normal,
            separations[near],
            np.array(coefficients, np.float64),
            normal * impulses[near, None] / self.step_s(),
        )

    def _pairs(self, narrow_phase: rapier3d.NarrowPhase, bodies: Set[int]) -> Iterator[Pair]:
        """Yield bodies a and b, and the pair, of each pair of near colliders that touches one of ``bodies``."""
        body_of, colliders = self._bodies.body_of, self._bodies.colliders
        return pairs_of(
            bodies,
            len(self._bodies.views),
            narrow_phase.contact_pairs,
            lambda body: chain.from_iterable(map(narrow_phase.contact_pairs_with, colliders[body])),
            lambda pair: (body_of(pair.collider1), body_of(pair.collider2)),
        )

    def _friction_of(self, pair: rapier3d.ContactPair) -> float:
        return friction_of(self.world.colliders[pair.collider1], self.world.colliders[pair.collider2])
