"""A world of Box3D, opened as the profile's knobs say, and its bodies.

The C API takes definitions by address: each is held while it is used, because a pointer into a temporary crashes later.
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
from stability_core.port import GROUND, IntArray

_FIELDS = ("contactHertz", "enableSleep")
"""Knobs that are fields of ``b3WorldDef``."""
KNOBS = frozenset({*_FIELDS, "lengthUnitsPerMeter", "contactRecycleDistance", "subStepCount", "sleepThreshold"})
"""Knobs that a profile may have."""

_STILL: Vector = (0.0, 0.0, 0.0)


class Box3dWorld:
    """A world, with the handles and shapes of its bodies."""

    def __init__(self, world: World, profile: Profile) -> None:
        self._knobs = profile.values
        self._friction = world.friction
        self.iterations = int(self._knobs["subStepCount"])
        """Of the solver in a step."""
        self.has_diverged = False
        self.shapes: dict[int, int] = {}
        """Index of the shape of each body."""
        self.body_of = np.full(64, GROUND)
        """Body, ground or fixed box of each shape, by the shape's index."""
        self.raw_handles = np.zeros(64, np.uint64)
        """Handle of each body as a number, by the body's id, as batch functions take them."""
        self.handles: dict[int, Any] = {}
        """Handle of each body."""
        self.world = self._opened(world)

    def add_fixed(self, body: int, box: Brick) -> None:
        """Add the ground or a fixed box, which contacts name ``body``."""
        self._add_box(body, box, lib.b3_staticBody)

    def add_live(self, body: int, brick: Brick) -> None:
        """Add a live brick, at rest."""
        self._add(body, brick, lib.b3_dynamicBody)

    def add_moved(self, body: int, brick: Brick) -> None:
        """Add a brick that the host moves."""
        self._add(body, brick, lib.b3_kinematicBody)

    def remove(self, body: int) -> None:
        """Take out a body."""
        self.body_of[self.shapes.pop(body)] = GROUND
        lib.b3DestroyBody(self.handles.pop(body))

    def handle(self, body: int) -> Any:
        """Return the handle of a body that is about to be changed, for which the engine gets this world's unit."""
        self._set_length_unit()
        return self.handles[body]

    def read_knobs(self) -> dict[str, KnobValue]:
        """Return the knobs that the engine shows."""
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
        """Make one step, unless the world has diverged: the engine would never come back."""
        if not self.has_diverged:
            self._set_length_unit()
            lib.b3World_Step(self.world, seconds, iterations)
            self.has_diverged = any("unstable" in message for message in _log.drain())

    def close(self) -> None:
        """Free the world."""
        lib.b3DestroyWorld(self.world)

    def _opened(self, world: World) -> Any:
        """Return an empty world."""
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
        """Set the unit of the engine's tolerances, which all worlds of the process share."""
        lib.b3SetLengthUnitsPerMeter(self._knobs["lengthUnitsPerMeter"])

    def _add(self, body: int, brick: Brick, kind: int) -> None:
        handle, self.shapes[body] = self._add_box(body, brick, kind)
        self.handles[body] = handle
        self.raw_handles = _with_room(self.raw_handles, body)
        self.raw_handles[body] = raw_handle(handle)

    def _add_box(self, body: int, box: Brick, kind: int) -> tuple[Any, int]:
        """Add a static, dynamic or kinematic box, which contacts name ``body``; returns its handle and its shape."""
        self._set_length_unit()
        x, y, z = box.size
        body_definition, shape = lib.b3DefaultBodyDef(), lib.b3DefaultShapeDef()
        body_definition.type, body_definition.position = kind, box.position
        body_definition.rotation = split(box.quaternion)
        body_definition.sleepThreshold *= float(self._knobs.get("sleepThreshold", 1.0))
        shape.density, shape.baseMaterial.friction = box.mass / (x * y * z), self._friction
        handle = lib.b3CreateBody(self.world, ffi.addressof(body_definition))
        hull = lib.b3MakeBoxHull(*half_edges(box.size))
        index = int(lib.b3CreateHullShape(handle, ffi.addressof(shape), ffi.addressof(hull, "base")).index1)
        self.body_of = _with_room(self.body_of, index)
        self.body_of[index] = body
        return handle, index


def set_velocity(handle: Any, linear: Vector = _STILL, angular: Vector = _STILL) -> None:
    """Set both velocities of a body; without arguments it stops."""
    lib.b3Body_SetLinearVelocity(handle, linear)
    lib.b3Body_SetAngularVelocity(handle, angular)


def split(quaternion: Quaternion) -> tuple[Vector, float]:
    """Return vector and scalar part, as Box3D's ``b3Quat`` has them."""
    w, x, y, z = quaternion
    return (x, y, z), w


def _with_room(array: IntArray | npt.NDArray[np.uint64], index: int) -> Any:
    """Return the array, longer if there is no place ``index`` in it."""
    return array if index < len(array) else np.resize(array, 2 * index)
