"""DART: every brick is a skeleton of one box on a free joint, stepped by a boxed LCP over all contacts.

How it works here:

- Freeze: ``resetVelocities``, then ``setMobile(False)``. An immobile skeleton is left out of integration and of the
  contact problem, so it drifts by exactly zero and costs almost nothing; contacts of two immobile skeletons vanish.
- Contacts: DART collides first, then solves, then moves, so the contacts belong to the poses before the latest
  substep. DART's normal points from object 2 to object 1: object 2 is our body a.
- Friction: a pair takes the smaller coefficient of the two, so that the world's value on everything is the pair's.
  The law is a box: up to sqrt(2) mu along the diagonal of the two tangents, and those are DART's
  choice: no call in Python turns them, and a small tilt of the normal may.
- Approach speed: DART reports none. The velocities before each substep are kept, and the fastest approach is taken.
- ``find_contacts`` runs the world's collision group into a separate result. The group keeps nothing between steps, so
  that the call changes nothing; but later steps can only be compared within what the solver repeats, see below.

Traps:

- DART keeps 1000 contacts as shipped and lets pairs share them beyond; ``_dart_limits`` raises that.
- Penetration recovers at 1 mm/s at most, and more slowly below 0.4 mm at 240 Hz (a hundredth of the depth a step); no
  knob in Python changes that. Only shorter steps keep a landing brick from sinking.
- The matrix-free solver gives up when its iterations run out and starts afresh with the dense one, whose time grows
  with the cube of the contacts. Its relative tolerance is in effect absolute [N s], for impulses below 1 N s.
- With DART's own collision detector the matrix-free solver is not repeatable on tens of bricks: the same contacts in
  the same order give impulses that differ within the tolerance, as memory happens to lie. FCL's and Bullet's were
  repeatable, but there a brick on a frozen one stuck 1 deg above the friction angle (a turned friction box?).
- DART's own sleeping engages under ``default`` after its half second; under the matrix-free solver a pile that rests
  below both speed thresholds was still awake after 3 s.
- The Python wrapper of a collision object goes by its address. One that is kept beyond its skeleton answers for
  whatever is made there next, so ``_remove`` forgets it first, together with the contacts that still point to it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any

import dartpy
import numpy as np

from adapters._dart_coordinates import coordinates_of, quaternions_of
from adapters._dart_limits import contacts_for, raise_limit
from adapters._dart_settings import KNOBS, allow_sleep, configure
from adapters.profile import Capabilities, Profile, Sleeping
from adapters.profile_files import load_settings
from adapters.shared.contact_completion import fixed_id
from adapters.shared.contact_forces import SubstepForces
from adapters.shared.live_pairs import of_live
from adapters.shared.vectors import rotate, rows_of
from adapters.substeps import SubstepSimulation
from scenarios.model import UPRIGHT, Brick, Quaternion, Vector, World
from stability_core.port import GROUND, Contacts, FloatArray, IntArray

_SETTINGS = load_settings("dart", KNOBS.__contains__)


class DartSimulation(SubstepSimulation):
    """One DART world; see the module's docstring for how freezing, contacts and friction work."""

    engine = "dart"
    iterations = "matrix_free_max_iterations"
    capabilities = Capabilities(
        contact_points="4 points or more",
        near_contacts=False,
        separation=True,
        relative_velocity="from the velocities before each substep",
        forces="normal and friction",
        freeze="immobile skeleton",
        frozen_contacts=False,
        friction_law="box pyramid, the smaller coefficient of the pair",
        moved="a joint of prescribed velocity",
        deterministic="no",
    )
    profiles = _SETTINGS.profiles

    def __init__(self, profile: Profile, world: World, sleeping: Sleeping, expected: Sequence[Brick]) -> None:
        super().__init__(profile, world, sleeping, expected)
        self._world = dartpy.simulation.World()
        self._world.setGravity(list(world.gravity))
        configure(self._world, {name: knob.value for name, knob in profile.knobs.items()}, expected)
        allow_sleep(self._world, sleeping)
        self._room = 0  # bricks for whose contacts DART's limit is raised
        self._make_room(len(expected))
        self._skeletons: dict[int, Any] = {}
        self._joints: dict[int, Any] = {}
        self._id_of: dict[Any, int] = {}  # collision object -> body, filled as they are first met
        self._latest: Contacts | None = None  # of the latest step, once read
        x, y, z = self.ground_half_edges  # a box rather than a plane: box on box gives the best manifolds
        self._add_fixed(GROUND, (2 * x, 2 * y, 2 * z), (0.0, 0.0, -z), UPRIGHT)
        for index, box in enumerate(world.fixed):
            self._add_fixed(fixed_id(index), box.size, box.position, box.quaternion)

    # -- bodies ---------------------------------------------------------------------------------------

    def _spawn(self, body: int, brick: Brick) -> None:
        skeleton = dartpy.dynamics.Skeleton(str(body))
        joint, node = skeleton.createFreeJointAndBodyNodePair()
        shape = self._add_shape(node, brick.size)
        inertia = dartpy.dynamics.Inertia()
        inertia.setMass(brick.mass)
        inertia.setMoment(shape.computeInertia(brick.mass))
        node.setInertia(inertia)
        joint.setPositions(coordinates_of(brick.position, brick.quaternion))
        self._make_room(len(self._skeletons) + 1)  # bricks may come that were not expected
        self._world.addSkeleton(skeleton)
        self._skeletons[body] = skeleton
        self._joints[body] = joint

    def _spawn_moved(self, body: int, brick: Brick) -> None:
        self._spawn(body, brick)
        self._joints[body].setActuatorType(dartpy.dynamics.ActuatorType.VELOCITY)

    def _remove(self, body: int) -> None:
        self._latest = self._read_contacts(self._world.getLastCollisionResult())
        self._id_of = {shape: known for shape, known in self._id_of.items() if known != body}
        self._world.getConstraintSolver().clearLastCollisionResult()
        del self._joints[body]
        self._world.removeSkeleton(self._skeletons.pop(body))

    def _move(self, body: int, position: Vector, quaternion: Quaternion) -> None:
        joint = self._joints[body]
        joint.setPositions(coordinates_of(position, quaternion))
        joint.resetVelocities()

    # -- actions --------------------------------------------------------------------------------------

    def _push(self, body: int, impulse: Vector) -> None:
        joint = self._joints[body]
        velocities = joint.getVelocities()
        velocities[3:] += np.array(impulse) / self.bricks[body].mass
        joint.setVelocities(velocities)

    def _press(self, body: int, force: Vector) -> None:
        node = self._skeletons[body].getBodyNode(0)
        node.addExtForce(list(force))

    def _drive(self, body: int, linear: Vector, angular: Vector, seconds: float) -> None:  # noqa: ARG002
        velocities = np.array((*angular, *linear))
        self._joints[body].setVelocities(velocities)  # contacts of the step are solved against it
        self._joints[body].setCommands(velocities)

    def _set_gravity(self, gravity: Vector) -> None:
        self._world.setGravity(list(gravity))
        self._world.setTimeStep(self._world.getTimeStep())  # wakes every body that the engine put to sleep

    # -- time -----------------------------------------------------------------------------------------

    def _begin_frame(self, substep_s: float) -> None:
        if self._world.getTimeStep() != substep_s:  # setting it wakes every body that the engine put to sleep
            self._world.setTimeStep(substep_s)

    def _forces_of_substep(self) -> SubstepForces:
        contacts = self._world.getLastCollisionResult().getContacts()
        return SubstepForces(*self._pairs(contacts), rows_of([contact.force for contact in contacts], 3))

    def _substep(self) -> None:
        self._world.step()

    def _end_frame(self) -> None:
        self._latest = None
        if self._before is not None:  # the contacts belong to the poses before the last substep, and so do all arms
            centers = self._before.position
            self._before = replace(self._before, position=np.repeat(centers[-1:], len(centers), axis=0))

    # -- state ----------------------------------------------------------------------------------------

    def _poses(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]:
        coordinates = self._coordinates(bodies.tolist())
        return coordinates[:, 3:], quaternions_of(coordinates[:, :3])

    def _positions(self, bodies: IntArray) -> FloatArray:
        return self._coordinates(bodies.tolist())[:, 3:]

    def _velocities(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]:
        rates = self._rates(bodies.tolist())
        return rates[:, 3:], rates[:, :3]

    # -- called by the port ---------------------------------------------------------------------------

    def _freeze(self, body: int) -> None:
        self._joints[body].resetVelocities()
        self._skeletons[body].setMobile(False)

    def _thaw(self, body: int) -> None:
        self._joints[body].resetVelocities()
        self._skeletons[body].setMobile(True)

    def _contacts(self) -> Contacts:
        if self._latest is None:
            self._latest = self._read_contacts(self._world.getLastCollisionResult())
        return of_live(self._latest, self.bodies)

    def _find_contacts(self) -> Contacts:
        solver, result = self._world.getConstraintSolver(), dartpy.collision.CollisionResult()
        solver.getCollisionGroup().collide(solver.getCollisionOption(), result)
        return self._read_contacts(result)

    # -- the end --------------------------------------------------------------------------------------

    def _close(self) -> None:
        # From the leaves to the root: a wrapper that outlives its world brings the process down.
        self._id_of.clear()
        self._joints.clear()
        self._skeletons.clear()
        del self._world

    # -- helpers --------------------------------------------------------------------------------------

    def _make_room(self, bricks: int) -> None:
        """Raise DART's limit on contacts to what so many bricks can have."""
        if bricks > self._room:
            self._room = max(bricks, 2 * self._room)
            raise_limit(self._world.getConstraintSolver(), contacts_for(self._room))

    def _add_fixed(self, body: int, size: Vector, position: Vector, quaternion: Quaternion) -> None:
        """Add the ground or a fixed box, which contacts name ``body``."""
        skeleton = dartpy.dynamics.Skeleton(str(body))
        joint, node = skeleton.createWeldJointAndBodyNodePair()
        self._add_shape(node, size)
        pose = dartpy.math.Isometry3()
        pose.set_translation(list(position))
        pose.set_rotation(rotate(np.tile(quaternion, (3, 1)), np.eye(3)).T)
        joint.setTransformFromParentBodyNode(pose)
        skeleton.setMobile(False)
        self._world.addSkeleton(skeleton)

    def _add_shape(self, body: Any, size: Vector) -> Any:
        shape = dartpy.dynamics.BoxShape(list(size))
        node = body.createShapeNode(shape)
        node.createCollisionAspect()
        node.createDynamicsAspect().setFrictionCoeff(self.world.friction)
        return shape

    def _coordinates(self, bodies: Iterable[int]) -> FloatArray:
        """Free joints' coordinates (n, 6): rotation vectors [rad], then positions [m], in world axes."""
        return rows_of([self._joints[body].getPositions() for body in bodies], 6)

    def _rates(self, bodies: Iterable[int]) -> FloatArray:
        """Free joints' velocities (n, 6): angular [rad/s], then linear [m/s], in world axes."""
        return rows_of([self._joints[body].getVelocities() for body in bodies], 6)

    def _read_contacts(self, result: Any) -> Contacts:
        """All contacts of a collision, those of frozen bodies and of bodies removed since included."""
        contacts = result.getContacts()
        if not contacts:
            return Contacts.empty()
        depth = np.array([contact.penetrationDepth for contact in contacts])
        point = rows_of([contact.point for contact in contacts], 3)
        normal = rows_of([contact.normal for contact in contacts], 3)
        force = rows_of([contact.force for contact in contacts], 3) if self.reads_forces else None
        return self._contacts_of_step(self._pairs(contacts), point, normal, -depth, force)

    def _pairs(self, contacts: Sequence[Any]) -> tuple[IntArray, IntArray]:
        """Return bodies a and b of DART's contacts, each of shape (n,)."""
        return (
            np.array([self._body_of(contact.collisionObject2) for contact in contacts], np.int64),
            np.array([self._body_of(contact.collisionObject1) for contact in contacts], np.int64),
        )

    def _body_of(self, collision_object: Any) -> int:
        body = self._id_of.get(collision_object)
        if body is None:
            body = int(collision_object.getShapeFrame().getSkeleton().getName())
            self._id_of[collision_object] = body
        return body
