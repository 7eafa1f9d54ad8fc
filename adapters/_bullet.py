"""PyBullet: Bullet's sequential-impulse solver on rigid bodies in maximal coordinates.

Freezing: the body is stopped, its mass set to 0 and its state to asleep, which makes it static: it is not moved by
anything, bit for bit, and two frozen bodies are not even collided. Thawing gives the mass back, and Bullet then works
out inertia and gravity anew. A body created with mass 0 would never get gravity, so bricks are created with theirs.

Contacts are those that the latest step solved, found at the pose from which that step started. Bullet tells no
approach speed: the adapter keeps every live body's pose and velocity from before each substep.

Friction: a pair's coefficient is the product of the two bodies', so each body gets the square root.

Traps: the ground is a box, as on a plane Bullet needs ten steps to find four contact points; handles of removed bodies
are used again; the contact breaking threshold is one for the whole process, so it is set before every frame;
``numSubSteps`` divides the forces reported, so that substeps are stepped one by one.
"""

from __future__ import annotations

import importlib.metadata
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import pybullet

from adapters.base import Capabilities, Knob, Profile, Simulation, Sleeping
from scenarios.model import Brick, Quaternion, Vector, World
from stability_core.port import GROUND, Contacts, FloatArray, IntArray

GROUND_HALF_EXTENTS = (2.0, 2.0, 0.5)
"""Half the ground's edges [m]: room for any scene of planks, and thick enough that nothing falls through."""

_FROZEN, _AWAKE, _MAY_SLEEP = (
    pybullet.ACTIVATION_STATE_SLEEP,
    pybullet.ACTIVATION_STATE_DISABLE_SLEEPING,
    pybullet.ACTIVATION_STATE_ENABLE_SLEEPING,
)

PROFILES: Mapping[str, Profile] = {
    profile.name: profile
    for profile in (
        Profile("default", "as shipped: four steps of 1/240 s a frame", substeps=4),
        Profile(
            "game",
            "one step a frame",
            substeps=1,
            tuned_by="Stillstack",
            knobs={
                "warmStartingFactor": Knob(
                    0.85, "Bullet's own default; PyBullet ships 0.1, which loses the stack's load"
                ),
                "solverResidualThreshold": Knob(0.0, "the shipped 1e-7 stops iterating too early for 12 g planks"),
            },
        ),
    )
}


@dataclass(frozen=True, slots=True)
class _Motion:
    """Where the live bodies were, and how fast, before a substep; rows in the order of ``body``."""

    body: IntArray
    position: FloatArray
    linear: FloatArray
    angular: FloatArray

    def at(self, bodies: IntArray, points: FloatArray) -> FloatArray:
        """Velocity [m/s] of each body at its point, shape (n, 3); zero for what is frozen and for the ground."""
        if not len(self.body):
            return np.zeros_like(points)
        row = np.minimum(np.searchsorted(self.body, bodies), len(self.body) - 1)
        velocity = self.linear[row] + np.cross(self.angular[row], points - self.position[row])
        return np.where((self.body[row] == bodies)[:, None], velocity, 0.0)


class BulletSimulation(Simulation):
    """A world of PyBullet in DIRECT mode."""

    engine: ClassVar[str] = "bullet"
    profiles: ClassVar[Mapping[str, Profile]] = PROFILES
    capabilities: ClassVar[Capabilities] = Capabilities(
        contact_points="up to 4 points",
        separation=True,
        relative_velocity="from the velocities before the step",
        forces=True,
        freeze="mass 0 and asleep",
        frozen_contacts=True,
        friction_law="cone",
        deterministic="across processes",
    )

    def __init__(self, profile: Profile, world: World, sleeping: Sleeping, expected: Sequence[Brick]) -> None:
        super().__init__(profile, world, sleeping, expected)
        self._client = pybullet.connect(pybullet.DIRECT)
        self._handles: dict[int, int] = {}
        self._bodies: dict[int, int] = {}
        self._shapes: dict[Vector, int] = {}
        self._before: list[_Motion] = []
        self._step_s = 0.0
        pybullet.setGravity(*world.gravity, physicsClientId=self._client)
        self._set(**{name: knob.value for name, knob in profile.knobs.items()})
        ground = self._create(GROUND_HALF_EXTENTS, 0.0, (0.0, 0.0, -GROUND_HALF_EXTENTS[2]), (1.0, 0.0, 0.0, 0.0))
        self._bodies[ground] = GROUND

    @staticmethod
    def _version() -> str:
        return importlib.metadata.version("pybullet")

    def _set(self, **parameters: float) -> None:
        pybullet.setPhysicsEngineParameter(**parameters, physicsClientId=self._client)

    def _create(self, half_extents: Vector, mass: float, position: Vector, quaternion: Quaternion) -> int:
        shape = self._shapes.get(half_extents)
        if shape is None:
            shape = pybullet.createCollisionShape(
                pybullet.GEOM_BOX, halfExtents=half_extents, physicsClientId=self._client
            )
            self._shapes[half_extents] = shape
        handle: int = pybullet.createMultiBody(
            baseMass=mass,
            baseCollisionShapeIndex=shape,
            basePosition=position,
            baseOrientation=_to_bullet(quaternion),
            useMaximalCoordinates=True,
            physicsClientId=self._client,
        )
        pybullet.changeDynamics(
            handle,
            -1,
            lateralFriction=math.sqrt(self.world.friction),
            spinningFriction=0.0,
            rollingFriction=0.0,
            restitution=0.0,
            linearDamping=0.0,
            angularDamping=0.0,
            activationState=_AWAKE,
            physicsClientId=self._client,
        )
        return handle

    def _spawn(self, body: int, brick: Brick) -> None:
        x, y, z = brick.size
        handle = self._create((x / 2, y / 2, z / 2), brick.mass, brick.position, brick.quaternion)
        self._handles[body] = handle
        self._bodies[handle] = body

    def _remove(self, body: int) -> None:
        handle = self._handles.pop(body)
        del self._bodies[handle]
        pybullet.removeBody(handle, physicsClientId=self._client)

    def _push(self, body: int, impulse: Vector) -> None:
        (vx, vy, vz), angular = pybullet.getBaseVelocity(self._handles[body], physicsClientId=self._client)
        mass = self.bricks[body].mass
        linear = (vx + impulse[0] / mass, vy + impulse[1] / mass, vz + impulse[2] / mass)
        pybullet.resetBaseVelocity(self._handles[body], linear, angular, physicsClientId=self._client)

    def _move(self, body: int, position: Vector, quaternion: Quaternion) -> None:
        handle = self._handles[body]
        pybullet.resetBasePositionAndOrientation(handle, position, _to_bullet(quaternion), physicsClientId=self._client)
        self._stop(handle)

    def _stop(self, handle: int) -> None:
        pybullet.resetBaseVelocity(handle, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), physicsClientId=self._client)

    def _freeze(self, body: int) -> None:
        handle = self._handles[body]
        self._stop(handle)
        pybullet.changeDynamics(handle, -1, mass=0.0, activationState=_FROZEN, physicsClientId=self._client)

    def _thaw(self, body: int) -> None:
        handle = self._handles[body]
        mass = self.bricks[body].mass
        pybullet.changeDynamics(handle, -1, mass=mass, activationState=_AWAKE, physicsClientId=self._client)
        self._stop(handle)

    def _step(self, seconds: float) -> None:
        step_s = seconds / self.info.profile.substeps
        if step_s != self._step_s:
            self._set(fixedTimeStep=step_s)
            self._step_s = step_s
        self._before.clear()
        for _ in range(self.info.profile.substeps):
            if self.is_observed:
                self._before.append(self._motion())
            pybullet.stepSimulation(physicsClientId=self._client)

    def _motion(self) -> _Motion:
        bodies = np.fromiter(self._live, np.int64, len(self._live))
        return _Motion(bodies, self._positions(bodies), *self._velocities(bodies))

    def _positions(self, bodies: IntArray) -> FloatArray:
        read, client, handles = pybullet.getBasePositionAndOrientation, self._client, self._handles
        return _rows([read(handles[body], physicsClientId=client)[0] for body in bodies.tolist()], 3)

    def _poses(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]:
        read, client, handles = pybullet.getBasePositionAndOrientation, self._client, self._handles
        both = _rows([sum(read(handles[body], physicsClientId=client), ()) for body in bodies.tolist()], 7)
        return both[:, :3], both[:, [6, 3, 4, 5]]

    def _velocities(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]:
        read, client, handles = pybullet.getBaseVelocity, self._client, self._handles
        both = _rows([sum(read(handles[body], physicsClientId=client), ()) for body in bodies.tolist()], 6)
        return both[:, :3], both[:, 3:]

    def _contacts(self) -> Contacts:
        listed = self._listed()
        if not listed:
            return Contacts.empty()
        body_of = self._bodies
        pair = np.array([(body_of[row[1]], body_of[row[2]]) for row in listed], np.int64)
        numbers = np.array([(*row[5], *row[6], *row[7], row[8]) for row in listed])
        body_a, body_b = pair[:, 0], pair[:, 1]
        point = (numbers[:, :3] + numbers[:, 3:6]) / 2
        normal = -numbers[:, 6:9]  # Bullet's normal points from b to a
        return Contacts(
            body_a,
            body_b,
            point,
            normal,
            numbers[:, 9],
            self._fastest_approach(body_a, body_b, point, normal),
            np.full(len(listed), self.world.friction),
        )

    def _listed(self) -> list[tuple[Any, ...]]:
        """Bullet's own rows of every contact that touches a live body, each once."""
        live, body_of, client = self._live, self._bodies, self._client
        if 2 * len(live) > len(self.bricks):
            every = pybullet.getContactPoints(physicsClientId=client)
            return [row for row in every if body_of[row[1]] in live or body_of[row[2]] in live]
        rows: list[tuple[Any, ...]] = []
        for body in live:
            handle = self._handles[body]
            for row in pybullet.getContactPoints(handle, physicsClientId=client):
                other = body_of[row[2] if row[1] == handle else row[1]]
                if other < body or other not in live:  # a pair of live bodies is met twice
                    rows.append(row)
        return rows

    def _fastest_approach(self, a: IntArray, b: IntArray, point: FloatArray, normal: FloatArray) -> FloatArray:
        """Velocity [m/s] of b against a, (n, 3), in the substep in which they approached each other fastest."""
        fastest = np.full((len(a), 3), np.nan)
        speed = np.full(len(a), -np.inf)
        for motion in self._before:
            velocity = motion.at(b, point) - motion.at(a, point)
            approach = -np.einsum("ij,ij->i", velocity, normal)
            faster = approach > speed
            fastest[faster], speed[faster] = velocity[faster], approach[faster]
        return fastest

    def _close(self) -> None:
        pybullet.disconnect(self._client)


def _to_bullet(quaternion: Quaternion) -> Quaternion:
    """Bullet's order of components is (x, y, z, w)."""
    w, x, y, z = quaternion
    return x, y, z, w


def _rows(rows: list[tuple[float, ...]], width: int) -> FloatArray:
    """Rows as an array of shape (n, width), also for n = 0."""
    return np.array(rows, np.float64).reshape(len(rows), width)
