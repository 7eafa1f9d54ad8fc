"""A world of Bullet with the settings of a profile, and its boxes."""

from __future__ import annotations

import math
from collections.abc import Iterable

from adapters.profile import EngineInfo, KnobValue
from adapters.shared.quiet_import import silenced_stderr
from adapters.shared.vectors import half_edges, scalar_last
from scenarios.model import Brick, Vector, World

with silenced_stderr():  # PyBullet prints its build date on import
    import pybullet

    from stability_core.ports import pybullet_calls


KNOBS = frozenset(
    {
        "allowedCcdPenetration",
        "constraintSolverType",
        "contactBreakingThreshold",
        "contactERP",
        "contactSlop",
        "deterministicOverlappingPairs",
        "enableConeFriction",
        "enableSAT",
        "erp",
        "frictionERP",
        "globalCFM",
        "minimumSolverIslandSize",
        "numNonContactInnerIterations",
        "numSolverIterations",
        "restitutionVelocityThreshold",
        "solverResidualThreshold",
        "splitImpulsePenetrationThreshold",
        "useSplitImpulse",
        "warmStartingFactor",
        "useMaximalCoordinates",
    }
)
"""Parameters of PyBullet's engine that affect contacts, and ``MAXIMAL_COORDINATES``."""
MAXIMAL_COORDINATES = "useMaximalCoordinates"
"""Knob for the kind of every body, set at its creation: 1 for a rigid body, 0 for a multibody."""
HEAVY = 1e6
"""Mass [kg] of a moved body. The mass is large, because PyBullet cannot make a body kinematic. A load of 100 N changes
the body's speed by 0.4 um/s in a step of 1/240 s, and the adapter sets the speed before each step."""


class BulletWorld:
    """A world in DIRECT mode, with PyBullet's handle of each body. PyBullet reuses the handles of removed bodies."""

    def __init__(self, world: World, info: EngineInfo) -> None:
        self.client: int = pybullet.connect(pybullet.DIRECT)
        self.awake = (
            pybullet.ACTIVATION_STATE_DISABLE_SLEEPING if info.sleeping == "off" else pybullet.ACTIVATION_STATE_WAKE_UP
        )
        """Activation state of a live body."""
        self.handles: dict[int, int] = {}
        """Handle of each body."""
        self.body_of: dict[int, int] = {}
        """Body, ground or fixed box of each handle."""
        self._friction = math.sqrt(world.friction)  # the coefficient of a pair is the product of both bodies'
        self._shapes: dict[Vector, int] = {}
        self._step_s = 0.0
        self.set_gravity(world.gravity)
        values = dict(info.profile.values)
        self._is_maximal = bool(values.pop(MAXIMAL_COORDINATES, True))
        self._configure(**values, reportSolverAnalytics=1)

    def set_step(self, seconds: float) -> None:
        """Set the length [s] of the steps that follow."""
        if seconds != self._step_s:
            self._configure(fixedTimeStep=seconds)
            self._step_s = seconds

    def set_gravity(self, gravity: Vector) -> None:
        """Set the gravity [m/s2] of active bodies, and of bodies that are added later."""
        pybullet.setGravity(*gravity, physicsClientId=self.client)

    def add_fixed(self, body: int, box: Brick) -> None:
        """Add the ground or a fixed box; ``body`` is its id in contacts."""
        self.body_of[self._add_box(box, mass=0.0)] = body

    def add_live(self, body: int, brick: Brick) -> None:
        """Add a live brick, at rest."""
        self._add(body, brick, brick.mass)

    def add_moved(self, body: int, brick: Brick) -> None:
        """Add a brick that the host moves."""
        self._add(body, brick, HEAVY)

    def remove(self, body: int) -> None:
        """Remove a body."""
        handle = self.handles.pop(body)
        del self.body_of[handle]
        pybullet.removeBody(handle, physicsClientId=self.client)

    def let_collide(self, handle: int, other: int, *, do: bool) -> None:
        """Set whether two bodies collide. Bullet also drops its cached contact of the pair."""
        pybullet.setCollisionFilterPair(handle, other, -1, -1, int(do), self.client)

    def wake(self, handle: int) -> None:
        """End the engine's own sleep of a body, because a new velocity alone does not end it."""
        pybullet.changeDynamics(handle, -1, activationState=self.awake, physicsClientId=self.client)

    def freeze(self, handle: int) -> None:
        """Make a body static and asleep."""
        pybullet_calls.freeze(handle, self.client)

    def cancel_gravity(self, handle: int, gravity: Vector) -> None:
        """Apply the force to a moved body that cancels ``gravity`` [m/s2] in the next step."""
        place, _ = pybullet.getBasePositionAndOrientation(handle, self.client)
        x, y, z = gravity
        lift = (-HEAVY * x, -HEAVY * y, -HEAVY * z)
        pybullet.applyExternalForce(handle, -1, lift, place, pybullet.WORLD_FRAME, self.client)

    def stop(self, handle: int) -> None:
        """Set both velocities of a body to zero."""
        pybullet_calls.stop(handle, self.client)

    def close(self) -> None:
        """Free the world."""
        pybullet.disconnect(self.client)

    def read_knobs(self, names: Iterable[str]) -> dict[str, KnobValue]:
        """Return the present values of the named parameters that Bullet reports."""
        shown = pybullet.getPhysicsEngineParameters(physicsClientId=self.client)
        return {name: shown[name] for name in names if name in shown}

    def _configure(self, **parameters: KnobValue) -> None:
        pybullet.setPhysicsEngineParameter(**parameters, physicsClientId=self.client)

    def _add(self, body: int, brick: Brick, mass: float) -> None:
        handle = self._add_box(brick, mass)
        self.handles[body] = handle
        self.body_of[handle] = body

    def _add_box(self, box: Brick, mass: float) -> int:
        """Add a box of this mass [kg] at rest, static if the mass is 0; return its handle."""
        shape = self._shapes.get(box.size)
        if shape is None:
            shape = pybullet.createCollisionShape(
                pybullet.GEOM_BOX, halfExtents=half_edges(box.size), physicsClientId=self.client
            )
            self._shapes[box.size] = shape
        handle: int = pybullet.createMultiBody(
            baseMass=mass,
            baseCollisionShapeIndex=shape,
            basePosition=box.position,
            baseOrientation=scalar_last(box.quaternion),
            useMaximalCoordinates=self._is_maximal,
            physicsClientId=self.client,
        )
        pybullet.changeDynamics(
            handle, -1, lateralFriction=self._friction, activationState=self.awake, physicsClientId=self.client
        )
        return handle
