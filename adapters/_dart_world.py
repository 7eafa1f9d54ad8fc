"""A world of DART, opened as the profile's knobs say: every brick is a skeleton of one box."""

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
from stability_core.port import FloatArray


class DartWorld:
    """A world, with the skeletons and the joints of its bodies. Contacts find a body by its skeleton's name."""

    def __init__(self, world: World, profile: Profile, expected: Sequence[Brick]) -> None:
        self.world = dartpy.simulation.World()
        self.world.setGravity(list(world.gravity))
        self._knobs = profile.values
        configure(self.world, self._knobs, expected)
        self.skeletons: dict[int, Any] = {}
        """Skeleton of each body."""
        self.joints: dict[int, Any] = {}
        """Joint of each body."""
        self._friction = world.friction
        self._room = 0  # bricks for whose contacts DART's limit is raised
        self._make_room(len(expected))

    def read_knobs(self) -> Mapping[str, KnobValue]:
        """Return the knobs that the world shows."""
        return read_knobs(self.world, self._knobs)

    def add_fixed(self, body: int, box: Brick) -> None:
        """Add the ground or a fixed box, which contacts name ``body``."""
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
        """Add a live brick on a free joint, at rest."""
        skeleton = dartpy.dynamics.Skeleton(str(body))
        joint, node = skeleton.createFreeJointAndBodyNodePair()
        shape = self._add_shape(node, brick)
        inertia = dartpy.dynamics.Inertia()
        inertia.setMass(brick.mass)
        inertia.setMoment(shape.computeInertia(brick.mass))
        node.setInertia(inertia)
        joint.setPositions(coordinates_of(brick.position, brick.quaternion))
        self._make_room(len(self.skeletons) + 1)  # bricks may come that were not expected
        self.world.addSkeleton(skeleton)
        self.skeletons[body] = skeleton
        self.joints[body] = joint

    def add_moved(self, body: int, brick: Brick) -> None:
        """Add a brick that the host moves, on a joint whose velocity is prescribed."""
        self.add_live(body, brick)
        self.joints[body].setActuatorType(dartpy.dynamics.ActuatorType.VELOCITY)

    def remove(self, body: int) -> None:
        """Take out a brick; no wrapper of its collision object may be left."""
        self.world.getConstraintSolver().clearLastCollisionResult()
        del self.joints[body]
        self.world.removeSkeleton(self.skeletons.pop(body))

    def coordinates(self, bodies: Iterable[int]) -> FloatArray:
        """Return free joints' coordinates (n, 6): rotation vectors [rad], then positions [m], in world axes."""
        return rows_of([self.joints[body].getPositions() for body in bodies], 6)

    def rates(self, bodies: Iterable[int]) -> FloatArray:
        """Return free joints' velocities (n, 6): angular [rad/s], then linear [m/s], in world axes."""
        return rows_of([self.joints[body].getVelocities() for body in bodies], 6)

    def close(self) -> None:
        """Free the world, from the leaves to the root: a wrapper that outlives it brings the process down."""
        self.joints.clear()
        self.skeletons.clear()
        del self.world

    def _make_room(self, bricks: int) -> None:
        """Raise DART's limit on contacts to what so many bricks can have."""
        if bricks > self._room:
            self._room = max(bricks, 2 * self._room)
            raise_limit(self.world.getConstraintSolver(), contacts_for(self._room))

    def _add_shape(self, node: Any, box: Brick) -> Any:
        shape = dartpy.dynamics.BoxShape(list(box.size))
        shape_node = node.createShapeNode(shape)
        shape_node.createCollisionAspect()
        shape_node.createDynamicsAspect().setFrictionCoeff(self._friction)
        return shape
