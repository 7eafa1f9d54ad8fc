"""A port to a SAPIEN scene that the user owns, with PhysX 5 on the processor.

Ids are SAPIEN's ``entity.per_scene_id``. The port controls free dynamic bodies. All other bodies are obstacles:

- links of articulations, kinematic bodies and static bodies;
- bodies with joints (drives are joints), with locked axes, or without gravity;
- bodies that the user leaves out.

The port returns PhysX's contacts, and adds the missing corners of contact areas between boxes, standing cylinders,
convex meshes and planes. The port changes no setting of the scene or of a live body.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Set
from typing import Any

import numpy as np
import sapien
from sapien import physx

from stability_core.port import FloatArray
from stability_core.ports.sapien_calls import Component, Listed, freeze, listed_pairs, touching_points, unfreeze
from stability_core.ports.sapien_shapes import center_of, solid_of
from stability_core.ports.sapien_states import BodyStates
from stability_core.ports.sapien_twin import INSTANT_S, present_contacts
from stability_core.ports.shared.body_motions import COLUMNS
from stability_core.ports.shared.free_body_port import FreeBodyPort
from stability_core.ports.shared.free_body_world import Concerns, FreeBodyWorld, Touching, Vector
from stability_core.ports.shared.shapes import Solid
from stability_core.ports.shared.vectors import rotate

__all__ = ["SapienWorld", "open_port"]


def open_port(world: Any, bodies: Collection[int] | None) -> FreeBodyPort:
    """Return a port to a scene of SAPIEN.

    Args:
        world: a ``sapien.Scene``, or its ``physx_system``.
        bodies: ``entity.per_scene_id`` of the bodies to control; None for all bodies that can freeze.

    Raises:
        TypeError: if ``world`` is no scene and no ``PhysxCpuSystem``, or the scene has no PhysX on the processor.
        ValueError: if a body cannot freeze, or ``bodies`` lists a body twice.
    """
    system = world.physx_system if isinstance(world, sapien.Scene) else world
    if not isinstance(system, physx.PhysxCpuSystem):
        raise TypeError(
            f"attach() needs a sapien.Scene with PhysX on the processor, got {type(system).__name__}: build the scene "
            "by sapien.Scene([sapien.physx.PhysxCpuSystem()]), with a render system if you need one"
        )
    return FreeBodyPort(SapienWorld(system), ("sapien", id(system)), bodies)


class SapienWorld(FreeBodyWorld):
    """The rigid bodies of a ``PhysxCpuSystem``."""

    engine = "SAPIEN"
    setter = "scene.set_timestep()"
    ids_from = "entity.per_scene_id"

    def __init__(self, system: Any) -> None:
        self.system = system
        x, y, z = system.config.gravity.tolist()
        self._gravity = x, y, z  # a later change has no effect
        self._listed: list[list[Component]] = []
        self._removed: list[list[Component]] = []  # because contacts refer to removed bodies until the next step
        self._components: dict[int, Component] = {}
        self._ids: dict[Component, int] = {}
        self._centers: dict[int, FloatArray] = {}  # of bodies whose centre is not the origin of the frame
        self._parents: set[int] = set()  # bodies to which a joint ties another body
        self._states = BodyStates(system, self._components, self._ids)

    def gravity(self) -> Vector:
        """Return the world's gravity [m/s2]."""
        return self._gravity

    def step_s(self) -> float:
        """Return the time [s] of one step."""
        seconds: float = self.system.timestep
        return seconds

    def has_changed(self) -> bool:
        """Return True if bodies have come or gone since the previous call."""
        system = self.system
        listed = [
            system.rigid_dynamic_components,
            system.rigid_static_components,
            system.articulation_link_components,
        ]
        if listed == self._listed:
            return False
        self._removed, self._listed = self._listed, listed
        self._components.clear()
        self._components.update({part.entity.per_scene_id: part for parts in listed for part in parts})
        self._ids.clear()
        self._ids.update({part: body for body, part in self._components.items()})
        self._states.count_rows()
        centers = {body: center_of(part) for body, part in self._components.items()}
        self._centers = {body: center for body, center in centers.items() if center.any()}
        self._parents.clear()
        for part in self._components.values():
            self._note_parents(part)
        return True

    def can_read(self, bodies: Collection[int]) -> bool:
        """Return True if all ``bodies`` are static and in the scene.

        The rows of dynamic bodies change whenever a body comes or goes.
        """
        parts = [self._components[body] for body in bodies]
        return all(isinstance(part, physx.PhysxRigidStaticComponent) and part.entity is not None for part in parts)

    def bodies(self) -> list[int]:
        """Return the ids of the bodies of the world at the latest ``has_changed``."""
        return [*self._components]

    def reason_against(self, body: int) -> str | None:
        """Return why a body that is not frozen cannot freeze, and the fix; None if it can freeze."""
        part = self._components[body]
        if isinstance(part, physx.PhysxArticulationLinkComponent):
            return "is a link of an articulation: list free bodies only, because the extension leaves robots alone"
        if not isinstance(part, physx.PhysxRigidDynamicComponent):
            return "is static already: list dynamic bodies only"
        if part.kinematic:
            return "is kinematic, so that it cannot fall: list dynamic bodies only"
        if self._note_parents(part) or body in self._parents:
            return "has joints: list free bodies only, because the extension does not know the forces of joints"
        if part.disable_gravity:
            return "has disable_gravity set and stands by itself: leave out the body, or set disable_gravity = False"
        if any(part.locked_motion_axes):
            return "has locked axes: leave out the body, or call set_locked_motion_axes([False] * 6)"
        return None

    def mass(self, body: int) -> float:
        """Return the mass [kg] of a live body."""
        return float(self._components[body].mass)

    def solid(self, body: int) -> Solid | None:
        """Return the shape of a body, relative to its centre of mass: see ``solid_of``."""
        return solid_of(self._components[body])

    def motions(self, bodies: list[int]) -> FloatArray:
        """Return the motions of bodies in the columns of ``body_motions``, shape (n, 13)."""
        rows = np.zeros((len(bodies), COLUMNS))
        dynamic = [row for row, body in enumerate(bodies) if self._is_dynamic(body)]
        if dynamic:
            state = self._states.read(np.array(bodies, np.int64)[dynamic])
            rows[dynamic] = state[:, [4, 5, 6, 1, 2, 3, 0, 7, 8, 9, 10, 11, 12]]
        for row, body in enumerate(bodies) if len(dynamic) < len(bodies) else ():
            if not self._is_dynamic(body):
                rows[row] = _motion_of(self._components[body])
        offset = [row for row, body in enumerate(bodies) if body in self._centers] if self._centers else []
        if offset:
            centers = np.array([self._centers[bodies[row]] for row in offset])
            rows[offset, :3] += rotate(rows[offset][:, [6, 3, 4, 5]], centers)
        return rows

    def box(self, body: int) -> FloatArray:
        """Return the lower, then the upper corner [m] of the box around a body, along the world's axes, shape (6,)."""
        corners: FloatArray = np.ravel(self._components[body].get_global_aabb_fast()).astype(np.float64)
        return corners

    def is_kinematic(self, body: int) -> bool:
        """Return True for a body that the user moves; PhysX lists no contact between this body and a frozen body."""
        return self._is_dynamic(body) and bool(self._components[body].kinematic)

    def is_mover(self, body: int) -> bool:
        """Return True for a body that forces move: a dynamic body that is not kinematic, or a link of a robot."""
        part = self._components[body]
        is_static = isinstance(part, physx.PhysxRigidStaticComponent)
        return not is_static and not self.is_kinematic(body)

    def freeze(self, body: int) -> None:
        """Freeze a live body at its present pose."""
        freeze(self._components[body])

    def unfreeze(self, body: int) -> None:
        """Make a frozen body live, at rest."""
        unfreeze(self._components[body])

    def step_contacts(self, concerns: Concerns, bodies: Set[int]) -> Touching:  # noqa: ARG002
        """Return the contacts of the latest step that ``concerns`` selects."""
        return _touching(listed_pairs(self.system.get_contacts(), self._ids.get, concerns), self.system.timestep)

    def present_contacts(self, concerns: Concerns, bodies: Set[int]) -> Touching:  # noqa: ARG002
        """Return the contacts of the present poses that ``concerns`` selects, without a change of the world."""
        with present_contacts(self._components) as (contacts, ids):
            return _touching(listed_pairs(contacts, ids.get, concerns), INSTANT_S)

    def _is_dynamic(self, body: int) -> bool:
        return isinstance(self._components[body], physx.PhysxRigidDynamicComponent)

    def _note_parents(self, part: Component) -> bool:
        """Return True if a joint ties a body to a second body or to the world, and record the second body."""
        joints = [each for each in part.entity.components if isinstance(each, physx.PhysxJointComponent)]
        self._parents |= {self._ids[joint.parent] for joint in joints if joint.parent in self._ids}
        return bool(joints)


def _motion_of(part: Component) -> tuple[float, ...]:
    """Return the motion of a static body or a link, in the columns of ``body_motions``, with the frame as centre."""
    pose = part.entity_pose
    w, *xyz = pose.q
    moves = isinstance(part, physx.PhysxRigidBodyComponent)
    velocity = (*part.linear_velocity, *part.angular_velocity) if moves else (0.0,) * 6
    return (*pose.p, *xyz, w, *velocity)


def _touching(pairs: Iterable[Listed], step_s: float) -> Touching:
    """Return the contact points of pairs in a step of ``step_s`` [s]."""
    listed = list(pairs)
    (body_a, body_b), numbers = touching_points(listed, 1.0)
    friction = {(a, b): _friction_of(contact) for a, b, _, contact in listed}
    of_row: FloatArray = np.array([friction[pair] for pair in zip(body_a.tolist(), body_b.tolist(), strict=True)])
    return Touching(
        body_a, body_b, numbers[:, :3], numbers[:, 3:6], numbers[:, 6], of_row.reshape(-1), numbers[:, 7:] / step_s
    )


def _friction_of(contact: Any) -> float:
    """Return the coefficient of friction of a pair, the mean of both materials' static coefficients."""
    first, second = contact.shapes
    return float(first.physical_material.static_friction + second.physical_material.static_friction) / 2
