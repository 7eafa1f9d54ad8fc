"""A world of DART with the settings of a profile, in which every brick is a skeleton of one shape."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import dartpy
import numpy as np

from adapters._dart_coordinates import coordinates_of
from adapters._dart_limits import contacts_for, raise_limit
from adapters._dart_settings import configure, read_knobs
from adapters.profile import KnobValue, Profile
from adapters.shared.vectors import rotate, rows_of
from scenarios.model import Brick, World
from scenarios.solids import moments_of
from stability_core.port import FloatArray


class DartWorld:
    """A world, with the skeletons and joints of its bodies. The name of a skeleton is the body's id."""

    def __init__(self, world: World, profile: Profile, expected: Sequence[Brick]) -> None:
        self.world = dartpy.simulation.World()
        self.world.setGravity(list(world.gravity))
        self._knobs = profile.values
        configure(self.world, self._knobs, expected)
        self.skeletons: dict[int, Any] = {}
        """Skeleton of each body."""
        self.joints: dict[int, Any] = {}
        """Joint of each body."""
        self._welds: dict[tuple[int, int], Any] = {}  # constraint of each joined pair
        self._friction = world.friction
        self._has_capsules = self._knobs.get("collision_detector") == "DART"
        self._room = 0  # number of bricks to which DART's limit on contacts is raised
        self._make_room(len(expected))

    def read_knobs(self) -> Mapping[str, KnobValue]:
        """Return the present values of the knobs that the world reports."""
        return read_knobs(self.world, self._knobs)

    def add_fixed(self, body: int, box: Brick) -> None:
        """Add the ground or a fixed body, with the id ``body`` in contacts."""
        skeleton = dartpy.dynamics.Skeleton(str(body))
        joint, node = skeleton.createWeldJointAndBodyNodePair()
        self._add_shape(node, box)
        pose = dartpy.math.Isometry3()
        pose.set_translation(list(box.position))
        pose.set_rotation(rotate(np.tile(box.quaternion, (3, 1)), np.eye(3)).T)
        joint.setTransformFromParentBodyNode(pose)
        skeleton.setMobile(False)
        self.world.addSkeleton(skeleton)

    def add_live(self, body: int, brick: Brick) -> None:
        """Add a live brick on a free joint, at rest.

        Raises:
            NotImplementedError: if the detector has no capsules, or the adapter cannot raise DART's limit on contacts.
        """
        skeleton = dartpy.dynamics.Skeleton(str(body))
        joint, node = skeleton.createFreeJointAndBodyNodePair()
        shape = self._add_shape(node, brick)
        inertia = dartpy.dynamics.Inertia()
        inertia.setMass(brick.mass)
        inertia.setMoment(
            shape.computeInertia(brick.mass)
            if brick.shape == "box" and brick.moments is None
            else np.diag(moments_of(brick))
        )
        node.setInertia(inertia)
        joint.setPositions(coordinates_of(brick.position, brick.quaternion))
        self._make_room(len(self.skeletons) + 1)  # because the host may spawn bricks that were not expected
        self.world.addSkeleton(skeleton)
        self.skeletons[body] = skeleton
        self.joints[body] = joint

    def add_moved(self, body: int, brick: Brick) -> None:
        """Add a brick that the host moves, on a joint of prescribed velocity."""
        self.add_live(body, brick)
        self.joints[body].setActuatorType(dartpy.dynamics.ActuatorType.VELOCITY)

    def remove(self, body: int) -> None:
        """Remove a brick; the caller must hold no wrapper of its collision object."""
        self.world.getConstraintSolver().clearLastCollisionResult()
        del self.joints[body]
        self.world.removeSkeleton(self.skeletons.pop(body))

    def join(self, pair: tuple[int, int]) -> None:
        """Join two bodies by a weld constraint. DART then uses the dense solver instead of the matrix-free solver."""
        first, second = (self.skeletons[body].getBodyNode(0) for body in pair)
        self._welds[pair] = dartpy.constraint.WeldJointConstraint(first, second)
        self.world.getConstraintSolver().addConstraint(self._welds[pair])

    def part(self, pair: tuple[int, int]) -> None:
        """Remove the constraint of two bodies."""
        self.world.getConstraintSolver().removeConstraint(self._welds.pop(pair))

    def coordinates(self, bodies: Iterable[int]) -> FloatArray:
        """Return free joints' coordinates (n, 6) in world axes: rotation vectors [rad], then positions [m]."""
        return rows_of([self.joints[body].getPositions() for body in bodies], 6)

    def rates(self, bodies: Iterable[int]) -> FloatArray:
        """Return free joints' velocities (n, 6): angular [rad/s], then linear [m/s], along the world's axes."""
        return rows_of([self.joints[body].getVelocities() for body in bodies], 6)

    def close(self) -> None:
        """Free the wrappers, then the world, because a wrapper that outlives the world crashes the process."""
        self._welds.clear()
        self.joints.clear()
        self.skeletons.clear()
        del self.world

    def _make_room(self, bricks: int) -> None:
        """Raise DART's limit on contacts to at least the greatest number of contacts among ``bricks`` bricks."""
        if bricks > self._room:
            self._room = max(bricks, 2 * self._room)
            raise_limit(self.world.getConstraintSolver(), contacts_for(self._room))

    def _add_shape(self, node: Any, box: Brick) -> Any:
        if box.shape == "capsule" and not self._has_capsules:
            raise NotImplementedError(
                "dart: the adapter builds capsules with the collision detector 'DART' only: use the profile game or "
                "tuned, without a varied collision_detector"
            )
        shape = _shape(box)
        shape_node = node.createShapeNode(shape)
        shape_node.createCollisionAspect()
        shape_node.createDynamicsAspect().setFrictionCoeff(self._friction)
        return shape


def _shape(brick: Brick) -> Any:
    diameter, _, length = brick.size
    match brick.shape:
        case "capsule":
            return dartpy.dynamics.CapsuleShape(diameter / 2, length - diameter)
        case "sphere":
            return dartpy.dynamics.SphereShape(diameter / 2)
    return dartpy.dynamics.BoxShape(list(brick.size))
