"""A world of SAPIEN with the settings of a profile, and its bodies, which SAPIEN calls components of entities."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from adapters.profile import KnobValue, Profile
from adapters.shared.quiet_import import silenced_stderr
from adapters.shared.vectors import half_edges
from scenarios.model import Brick, Quaternion, Vector, World
from scenarios.shapes import Polyhedron
from scenarios.solids import moments_of
from stability_core.port import FloatArray
from stability_core.ports.sapien_states import BodyStates

with silenced_stderr(), warnings.catch_warnings():
    warnings.simplefilter("ignore")
    import sapien
    from sapien import physx

_SCENE = ("enable_tgs", "bounce_threshold")
_BODY = ("solver_position_iterations", "angular_damping", "sleep_threshold")
_SHAPE = ("contact_offset",)
KNOBS = frozenset({*_SCENE, *_BODY, *_SHAPE})
"""Attributes of SAPIEN's scene, bodies and shapes that a profile may set."""
_FROM_X_TO_Z: Quaternion = (math.sqrt(0.5), 0.0, -math.sqrt(0.5), 0.0)
"""Turn from the axis of PhysX's capsule to the axis of a brick."""


class PhysxWorld:
    """A world, with the components of its bodies."""

    def __init__(self, world: World, profile: Profile) -> None:
        knobs = profile.values
        self._for_bodies = {name: knobs[name] for name in _BODY if name in knobs}
        self._for_shapes = {name: knobs[name] for name in _SHAPE if name in knobs}
        # These settings belong to the process; a system reads them at its creation.
        physx.set_scene_config(gravity=world.gravity, **{name: knobs[name] for name in _SCENE if name in knobs})
        self._built_gravity = world.gravity
        self._gravity_change = np.zeros(3, np.float32)
        self.system = physx.PhysxCpuSystem()
        self._scene = sapien.Scene([self.system])
        self._material = physx.PhysxMaterial(world.friction, world.friction, 0.0)
        self.components: dict[int, Any] = {}
        """Component of each body."""
        self.body_of: dict[Any, int] = {}
        """Id of the body, the ground or the fixed body of each component.

        While the map holds the Python object of a component, SAPIEN returns this object for the component.
        """
        self._joints: dict[tuple[int, int], list[Any]] = {}  # of each joined pair
        self._without_contact: set[tuple[int, int]] = set()  # joined pairs that PhysX does not collide
        self._removed_components: list[Any] = []  # removed after the latest step
        self.states = BodyStates(self.system, self.components, self.body_of)

    def add_fixed(self, body: int, box: Brick) -> None:
        """Add the ground or a fixed body, with the id ``body`` in contacts."""
        component = physx.PhysxRigidStaticComponent()
        self._add(component, box)
        self.body_of[component] = body

    def add_live(self, body: int, brick: Brick) -> None:
        """Add a live brick, at rest."""
        component = physx.PhysxRigidDynamicComponent()
        self._add(component, brick)
        component.mass = brick.mass
        component.inertia = _moments(brick)
        if brick.shape != "box":  # SAPIEN has set the principal axes of its mesh
            component.cmass_local_pose = sapien.Pose()
        for name, value in self._for_bodies.items():
            setattr(component, name, value)
        self.components[body] = component
        self.body_of[component] = body
        self.states.count_rows()

    def add_moved(self, body: int, brick: Brick) -> None:
        """Add a brick that the host moves."""
        self.add_live(body, brick)
        self.components[body].kinematic = True

    def read_knobs(self, names: Iterable[str]) -> dict[str, KnobValue]:
        """Return the present values of the named knobs, from the process, the first body and its shape.

        Without a body the method returns only the knobs of the process.
        """
        owners: list[tuple[tuple[str, ...], Any]] = [(_SCENE, physx.get_scene_config())]
        if self.components:
            first = next(iter(self.components.values()))
            owners += [(_BODY, first), (_SHAPE, first.collision_shapes[0])]
        return {name: getattr(owner, name) for knobs, owner in owners for name in knobs if name in set(names)}

    def remove(self, body: int) -> None:
        """Remove a body, and keep its component until the next step, because contacts still refer to the component."""
        component = self.components.pop(body)
        del self.body_of[component]
        self._scene.remove_entity(component.entity)
        self._removed_components.append(component)
        self.states.count_rows()

    def join(self, pair: tuple[int, int], radius: float) -> None:
        """Join two bodies by joints that lock three points, ``radius`` [m] from the middle of the bodies' centres."""
        first, second = (self.components[body] for body in pair)
        if not self._collides(pair):
            self._without_contact.add(pair)
        poses = [component.entity.pose for component in (first, second)]
        middle = (poses[0].p + poses[1].p) / 2
        self._joints[pair] = []
        for point in middle + radius * np.eye(3, dtype=np.float32):
            joint = physx.PhysxDriveComponent(second)
            joint.set_parent(first)
            joint.set_pose_in_parent(poses[0].inv() * sapien.Pose(point))
            joint.set_pose_in_child(poses[1].inv() * sapien.Pose(point))
            for lock in (joint.set_limit_x, joint.set_limit_y, joint.set_limit_z):
                lock(0.0, 0.0)
            second.entity.add_component(joint)
            self._joints[pair].append(joint)

    def part(self, pair: tuple[int, int]) -> None:
        """Remove the joints of two bodies, wake both, and make PhysX collide them if it does not.

        PhysX ignores a new pair of jointed bodies, but keeps a pair that it already collides. If PhysX filters the
        pairs of a body anew, it drops the contacts of all pairs in which the body is joined. Therefore the method does
        so only for a pair that was joined before PhysX listed the pair.
        """
        for joint in self._joints.pop(pair):
            joint.entity.remove_component(joint)
        for body in pair:
            self.components[body].wake_up()
            if pair in self._without_contact:
                (shape,) = self.components[body].collision_shapes
                shape.set_collision_groups(shape.get_collision_groups())
        self._without_contact.discard(pair)

    def set_gravity(self, gravity: Vector) -> None:
        """Set the gravity [m/s2] of the steps that follow."""
        self._gravity_change = np.subtract(gravity, self._built_gravity).astype(np.float32)

    def add_gravity_change(self, masses: Mapping[int, float]) -> None:
        """Apply the change of gravity as a force on bodies in the next step, because SAPIEN cannot change gravity.

        Args:
            masses: mass [kg] of each body.
        """
        if self._gravity_change.any():
            for body, mass in masses.items():
                self.components[body].add_force_torque(mass * self._gravity_change, np.zeros(3, np.float32))

    def forget_removed(self) -> None:
        """Release the components that the host removed before the latest step."""
        self._removed_components.clear()

    def close(self) -> None:
        """Free the world."""
        self.components.clear()
        self._scene.clear()

    def _collides(self, pair: tuple[int, int]) -> bool:
        """Return whether PhysX listed a contact of two bodies in the latest step."""
        wanted = {self.components[body] for body in pair}
        return any(wanted == set(contact.bodies) for contact in self.system.get_contacts())

    def _add(self, component: Any, brick: Brick) -> None:
        shape = _shape(brick, self._material)
        for name, value in self._for_shapes.items():
            setattr(shape, name, value)
        component.attach(shape)
        entity = sapien.Entity()
        entity.add_component(component)
        entity.pose = sapien.Pose(brick.position, brick.quaternion)
        self._scene.add_entity(entity)


def _shape(brick: Brick, material: Any) -> Any:
    """Return a collision shape; turn the axis of a capsule from PhysX's x to the brick's z."""
    x, _, z = half_edges(brick.size)
    if isinstance(brick.shape, Polyhedron):
        return physx.PhysxCollisionShapeConvexMesh(
            brick.shape.array.astype(np.float32), np.ones(3, np.float32), material
        )
    if brick.shape == "sphere":
        return physx.PhysxCollisionShapeSphere(x, material)
    if brick.shape == "capsule":
        shape = physx.PhysxCollisionShapeCapsule(x, z - x, material)
        shape.local_pose = sapien.Pose(q=_FROM_X_TO_Z)
        return shape
    return physx.PhysxCollisionShapeBox(half_edges(brick.size), material)


def _moments(brick: Brick) -> FloatArray:
    if brick.shape != "box" or brick.moments is not None:
        return np.array(moments_of(brick))
    x, y, z = brick.size
    moments: FloatArray = brick.mass / 12 * np.array([y * y + z * z, x * x + z * z, x * x + y * y])
    return moments
