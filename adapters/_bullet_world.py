"""A world of Bullet with the settings of a profile, and its bodies."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

import numpy as np

from adapters.profile import EngineInfo, KnobValue
from adapters.shared.quiet_import import silenced_stderr
from adapters.shared.vectors import half_edges, scalar_last
from scenarios.model import Brick, Vector, World
from scenarios.shapes import Polyhedron, Shape
from scenarios.solids import friction_of, moments_of, restitution_of

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
"""Knob for the kind of every body, set at its creation: 0 for a multibody, 1 (as without the knob) for a rigid body."""
HEAVY = 1e6
"""Mass [kg] of a moved body. The mass is large, because PyBullet cannot make a body kinematic. A load of 100 N changes
the body's speed by 0.4 um/s in a step of 1/240 s. The adapter sets the speed before each step."""

_UNTURNED = (0.0, 0.0, 0.0, 1.0)


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
        """Id of the body, the ground or the fixed body of each handle."""
        self._joints: dict[tuple[int, int], list[int]] = {}  # constraints of each joined pair
        self._world = world
        self._shapes: dict[tuple[Shape, Vector], int] = {}
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
        """Set the gravity [m/s2] of active bodies, and of bodies that the caller adds later."""
        pybullet.setGravity(*gravity, physicsClientId=self.client)

    def add_fixed(self, body: int, box: Brick) -> None:
        """Add the ground or a fixed body, with the id ``body`` in contacts."""
        self.body_of[self._add_solid(box, mass=0.0)] = body

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
        """End the engine's own sleep of a body, because a new velocity alone does not end this sleep."""
        pybullet.changeDynamics(handle, -1, activationState=self.awake, physicsClientId=self.client)

    def freeze(self, handle: int) -> None:
        """Make a body static and asleep."""
        pybullet_calls.freeze(handle, self.client)

    def restore_inertia(self, handle: int, brick: Brick) -> None:
        """Set the moments of inertia again after a change of the mass, if Bullet does not compute them exactly."""
        if inertia := _own_inertia(brick):
            pybullet.changeDynamics(handle, -1, **inertia, physicsClientId=self.client)

    def join(self, pair: tuple[int, int], radius: float) -> None:
        """Join two bodies by point-to-point constraints at three points, ``radius`` [m] from the middle of the centres.

        The method uses no fixed constraint, because Bullet's fixed constraint ignores the orientations of both frames
        for rigid bodies, and therefore turns the bodies.
        """
        handles = [self.handles[body] for body in pair]
        poses = [pybullet.getBasePositionAndOrientation(handle, self.client) for handle in handles]
        middle = (np.array(poses[0][0]) + poses[1][0]) / 2
        inverses = [pybullet.invertTransform(*pose) for pose in poses]
        self._joints[pair] = []
        for point in middle + radius * np.eye(3):
            local = [pybullet.multiplyTransforms(*inverse, point.tolist(), _UNTURNED)[0] for inverse in inverses]
            joint = pybullet.createConstraint(
                handles[0],
                -1,
                handles[1],
                -1,
                pybullet.JOINT_POINT2POINT,
                (0.0, 0.0, 0.0),
                *local,
                physicsClientId=self.client,
            )
            self._joints[pair].append(joint)

    def part(self, pair: tuple[int, int]) -> None:
        """End the joint of two bodies."""
        for joint in self._joints.pop(pair):
            pybullet.removeConstraint(joint, self.client)

    def cancel_gravity(self, handle: int, gravity: Vector) -> None:
        """Apply to a moved body the force that cancels ``gravity`` [m/s2] in the next step."""
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
        handle = self._add_solid(brick, mass)
        self.handles[body] = handle
        self.body_of[handle] = body

    def _add_solid(self, brick: Brick, mass: float) -> int:
        """Add a body of this mass [kg] at rest, static if the mass is 0; return its handle."""
        handle: int = pybullet.createMultiBody(
            baseMass=mass,
            baseCollisionShapeIndex=self._shape(brick),
            basePosition=brick.position,
            baseOrientation=scalar_last(brick.quaternion),
            useMaximalCoordinates=self._is_maximal,
            physicsClientId=self.client,
        )
        # The coefficients of a pair are the products of both bodies'.
        pybullet.changeDynamics(
            handle,
            -1,
            lateralFriction=math.sqrt(friction_of(brick, self._world)),
            activationState=self.awake,
            physicsClientId=self.client,
            **_material(brick, self._world),
            **(_own_inertia(brick) if mass == brick.mass else {}),
        )
        return handle

    def _shape(self, brick: Brick) -> int:
        """Return the collision shape of a brick, shared by all bricks of equal shape and size."""
        key = brick.shape, brick.size
        if key not in self._shapes:
            self._shapes[key] = pybullet.createCollisionShape(**_geometry(brick), physicsClientId=self.client)
        return self._shapes[key]


def _geometry(brick: Brick) -> dict[str, Any]:
    """Return PyBullet's description of a brick's collision shape."""
    diameter, _, length = brick.size
    match brick.shape:
        case "box":
            return {"shapeType": pybullet.GEOM_BOX, "halfExtents": half_edges(brick.size)}
        case "cylinder":
            return {"shapeType": pybullet.GEOM_CYLINDER, "radius": diameter / 2, "height": length}
        case "capsule":
            return {"shapeType": pybullet.GEOM_CAPSULE, "radius": diameter / 2, "height": length - diameter}
        case "sphere":
            return {"shapeType": pybullet.GEOM_SPHERE, "radius": diameter / 2}
    return {"shapeType": pybullet.GEOM_MESH, "vertices": brick.shape.vertices}


def _own_inertia(brick: Brick) -> dict[str, Any]:
    """Return the mass and the inertia of a hull, a capsule or a brick with given moments; nothing for other bricks.

    Bullet gives hulls and capsules the inertia of a box.
    """
    is_computed = brick.shape in ("box", "cylinder", "sphere") and brick.moments is None
    # Without the mass in the same call the body's next pose is NaN.
    return {} if is_computed else {"mass": brick.mass, "localInertiaDiagonal": moments_of(brick)}


def _material(brick: Brick, world: World) -> dict[str, float]:
    """Return PyBullet's settings for the margin of a hull and for a restitution above 0."""
    settings = {}
    if isinstance(brick.shape, Polyhedron):
        settings["collisionMargin"] = 0.0  # Bullet would add its margin of 1 mm around the vertices
    if restitution := restitution_of(brick, world):
        settings["restitution"] = math.sqrt(restitution)
    return settings
