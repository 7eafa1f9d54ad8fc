"""A world of Box3D with the settings of a profile, and its bodies.

The C API takes definitions by address. A variable holds each definition during the call, because Python may free a
temporary object before Box3D reads the object.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
from robox3d._ffi import ffi, lib
from robox3d.core import _log

from adapters._box3d_state import raw_handle
from adapters.profile import KnobValue, Profile
from adapters.shared.vectors import half_edges
from scenarios.model import Brick, Quaternion, Vector, World
from scenarios.shapes import Polyhedron
from scenarios.solids import friction_of, moments_of, volume_of
from stability_core.port import GROUND, IntArray

_FIELDS = ("contactHertz", "enableSleep")
"""Knobs that are fields of ``b3WorldDef``."""
KNOBS = frozenset({*_FIELDS, "lengthUnitsPerMeter", "contactRecycleDistance", "subStepCount", "sleepThreshold"})
"""Knobs that a profile may have."""

WELD_HERTZ = 240.0
"""Stiffness of a weld joint [Hz], because an overhanging plank tilted by 1 deg with the 60 Hz as shipped."""
_STILL: Vector = (0.0, 0.0, 0.0)


class Box3dWorld:
    """A world, with the handles and shapes of its bodies."""

    def __init__(self, world: World, profile: Profile) -> None:
        self._knobs = profile.values
        self._scene = world
        self.iterations = int(self._knobs["subStepCount"])
        """Number of the solver's iterations per step."""
        self.has_diverged = False
        self.shapes: dict[int, int] = {}
        """Index of the shape of each body."""
        self.body_of = np.full(64, GROUND)
        """Id of the body, the ground or the fixed body of each shape, by the shape's index."""
        self.raw_handles = np.zeros(64, np.uint64)
        """Handle of each body as a number, by the body's id: the input of batch functions."""
        self.handles: dict[int, Any] = {}
        """Handle of each body."""
        self._joints: dict[tuple[int, int], Any] = {}  # of each joined pair
        self.world = self._opened(world)

    def add_fixed(self, body: int, box: Brick) -> None:
        """Add the ground or a fixed body, with the id ``body`` in contacts."""
        self._add_solid(body, box, lib.b3_staticBody)

    def add_live(self, body: int, brick: Brick) -> None:
        """Add a live brick, at rest."""
        self._add(body, brick, lib.b3_dynamicBody)
        self.restore_inertia(body, brick)

    def add_moved(self, body: int, brick: Brick) -> None:
        """Add a brick that the host moves."""
        self._add(body, brick, lib.b3_kinematicBody)

    def remove(self, body: int) -> None:
        """Remove a body."""
        self.body_of[self.shapes.pop(body)] = GROUND
        lib.b3DestroyBody(self.handles.pop(body))

    def restore_inertia(self, body: int, brick: Brick) -> None:
        """Set the mass and the inertia of a dynamic body unless the body is a homogeneous box.

        Box3D computes the inertia of a hull with a relative error of 2e-6, each time a body becomes dynamic.
        """
        if brick.shape == "box" and brick.moments is None:
            return
        x, y, z = moments_of(brick)
        inertia = ((x, 0.0, 0.0), (0.0, y, 0.0), (0.0, 0.0, z))
        lib.b3Body_SetMassData(self.handles[body], (brick.mass, (0.0, 0.0, 0.0), inertia))

    def handle(self, body: int) -> Any:
        """Return the handle of a body that the caller will change.

        The method sets the engine's length unit first, because a change of the body's type needs this unit.
        """
        self._set_length_unit()
        return self.handles[body]

    def join(self, pair: tuple[int, int]) -> None:
        """Join two bodies by a weld joint at the middle between their centres."""
        self._set_length_unit()
        first, second = (self.handles[body] for body in pair)
        places = [lib.b3Body_GetPosition(handle) for handle in (first, second)]
        middle = tuple(sum(getattr(place, axis) for place in places) / 2 for axis in "xyz")
        definition = lib.b3DefaultWeldJointDef()
        base = definition.base
        base.constraintHertz = WELD_HERTZ
        base.bodyIdA, base.bodyIdB, base.collideConnected = first, second, True
        for frame, handle in ((base.localFrameA, first), (base.localFrameB, second)):
            frame.p = lib.b3Body_GetLocalPoint(handle, middle)
            turn = lib.b3Body_GetRotation(handle)
            frame.q = (-turn.v.x, -turn.v.y, -turn.v.z), turn.s
        self._joints[pair] = lib.b3CreateWeldJoint(self.world, ffi.addressof(definition))

    def part(self, pair: tuple[int, int]) -> None:
        """Remove the joint of two bodies, and wake both."""
        lib.b3DestroyJoint(self._joints.pop(pair), True)

    def read_knobs(self) -> dict[str, KnobValue]:
        """Return the present values of the profile's knobs that the engine's interface reports."""
        self._set_length_unit()
        shown = {
            "lengthUnitsPerMeter": float(lib.b3GetLengthUnitsPerMeter()),
            "contactRecycleDistance": float(lib.b3World_GetContactRecycleDistance(self.world)),
        }
        return {name: value for name, value in shown.items() if name in self._knobs}

    def set_gravity(self, gravity: Vector) -> None:
        """Set the gravity [m/s2] of the steps that follow."""
        lib.b3World_SetGravity(self.world, gravity)

    def step(self, seconds: float, iterations: int) -> None:
        """Make one step of ``seconds`` [s] unless the world has diverged, because the engine would then not return."""
        if not self.has_diverged:
            self._set_length_unit()
            lib.b3World_Step(self.world, seconds, iterations)
            self.has_diverged = any("unstable" in message for message in _log.drain())

    def close(self) -> None:
        """Free the world."""
        lib.b3DestroyWorld(self.world)

    def _opened(self, world: World) -> Any:
        """Return an empty world of the engine with the profile's knobs."""
        self._set_length_unit()
        definition = lib.b3DefaultWorldDef()
        definition.gravity = world.gravity
        for name in filter(self._knobs.__contains__, _FIELDS):
            setattr(definition, name, self._knobs[name])
        engine = lib.b3CreateWorld(ffi.addressof(definition))
        if "contactRecycleDistance" in self._knobs:
            lib.b3World_SetContactRecycleDistance(engine, self._knobs["contactRecycleDistance"])
        return engine

    def _set_length_unit(self) -> None:
        """Set the length unit of the engine's tolerances, because all worlds of the process share the unit."""
        lib.b3SetLengthUnitsPerMeter(self._knobs["lengthUnitsPerMeter"])

    def _add(self, body: int, brick: Brick, kind: int) -> None:
        handle, self.shapes[body] = self._add_solid(body, brick, kind)
        self.handles[body] = handle
        self.raw_handles = _with_room(self.raw_handles, body)
        self.raw_handles[body] = raw_handle(handle)

    def _add_solid(self, body: int, box: Brick, kind: int) -> tuple[Any, int]:
        """Add a static, dynamic or kinematic body, with id ``body`` in contacts; return its handle and shape index."""
        self._set_length_unit()
        body_definition, shape = lib.b3DefaultBodyDef(), lib.b3DefaultShapeDef()
        body_definition.type, body_definition.position = kind, box.position
        body_definition.rotation = split(box.quaternion)
        body_definition.sleepThreshold *= float(self._knobs.get("sleepThreshold", 1.0))
        shape.density = box.mass / volume_of(box.shape, box.size)
        shape.baseMaterial.friction = friction_of(box, self._scene)
        handle = lib.b3CreateBody(self.world, ffi.addressof(body_definition))
        index = _attach_shape(handle, shape, box)
        self.body_of = _with_room(self.body_of, index)
        self.body_of[index] = body
        return handle, index


def _attach_shape(handle: Any, definition: Any, brick: Brick) -> int:
    """Create the collision shape of a body; return its index."""
    shape, defined = brick.shape, ffi.addressof(definition)
    radius, _, half_length = half_edges(brick.size)
    if isinstance(shape, Polyhedron):
        points = ffi.new("b3Vec3[]", [tuple(vertex) for vertex in shape.vertices])
        hull = lib.b3CreateHull(points, len(shape.vertices), len(shape.vertices))
        index = lib.b3CreateHullShape(handle, defined, hull).index1
        lib.b3DestroyHull(hull)  # Box3D has copied it
        return int(index)
    if shape == "sphere":
        sphere = ffi.new("b3Sphere *", ((0.0, 0.0, 0.0), radius))
        return int(lib.b3CreateSphereShape(handle, defined, sphere).index1)
    if shape == "capsule":
        end = half_length - radius
        capsule = ffi.new("b3Capsule *", ((0.0, 0.0, -end), (0.0, 0.0, end), radius))
        return int(lib.b3CreateCapsuleShape(handle, defined, capsule).index1)
    box = lib.b3MakeBoxHull(*half_edges(brick.size))
    return int(lib.b3CreateHullShape(handle, defined, ffi.addressof(box, "base")).index1)


def set_velocity(handle: Any, linear: Vector = _STILL, angular: Vector = _STILL) -> None:
    """Set the linear [m/s] and angular [rad/s] velocity of a body. The defaults stop the body."""
    lib.b3Body_SetLinearVelocity(handle, linear)
    lib.b3Body_SetAngularVelocity(handle, angular)


def split(quaternion: Quaternion) -> tuple[Vector, float]:
    """Return the vector and the scalar part of a quaternion (w, x, y, z), in the order of Box3D's ``b3Quat``."""
    w, x, y, z = quaternion
    return (x, y, z), w


def _with_room(array: IntArray | npt.NDArray[np.uint64], index: int) -> Any:
    """Return the array, enlarged if ``index`` lies beyond its end."""
    return array if index < len(array) else np.resize(array, 2 * index)
