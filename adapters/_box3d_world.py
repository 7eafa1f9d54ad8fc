"""Definitions of Box3D's worlds and bodies, which the C API takes by address."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from robox3d._ffi import ffi, lib

from adapters.shared.vectors import half_edges
from scenarios.model import Brick, Quaternion, Vector, World

Value = float | int | str | bool

_FIELDS = ("contactHertz", "enableSleep")
"""Knobs that are fields of ``b3WorldDef``."""
WORLD_KNOBS = (*_FIELDS, "lengthUnitsPerMeter", "contactRecycleDistance")
_STILL: Vector = (0.0, 0.0, 0.0)


def open_world(world: World, knobs: Mapping[str, Value]) -> Any:
    """Open an empty world."""
    lib.b3SetLengthUnitsPerMeter(knobs["lengthUnitsPerMeter"])
    definition = lib.b3DefaultWorldDef()
    definition.gravity = world.gravity
    for name in filter(knobs.__contains__, _FIELDS):
        setattr(definition, name, knobs[name])
    engine = lib.b3CreateWorld(ffi.addressof(definition))
    if "contactRecycleDistance" in knobs:
        lib.b3World_SetContactRecycleDistance(engine, knobs["contactRecycleDistance"])
    return engine


def add_box(engine: Any, brick: Brick, kind: int, friction: float, sleep_threshold: Value) -> tuple[Any, int]:
    """Add a box to a world; returns its handle and the index of its shape.

    Args:
        engine: the world, whose unit of length is the latest one set.
        brick: size, pose and mass.
        kind: ``b3_dynamicBody``, ``b3_kinematicBody`` or ``b3_staticBody``.
        friction: coefficient of the box.
        sleep_threshold: over the shipped one.
    """
    x, y, z = brick.size
    body, shape = lib.b3DefaultBodyDef(), lib.b3DefaultShapeDef()
    body.type, body.position, body.rotation = kind, brick.position, split(brick.quaternion)
    body.sleepThreshold *= float(sleep_threshold)
    shape.density, shape.baseMaterial.friction = brick.mass / (x * y * z), friction
    handle = lib.b3CreateBody(engine, ffi.addressof(body))
    hull = lib.b3MakeBoxHull(*half_edges(brick.size))
    return handle, int(lib.b3CreateHullShape(handle, ffi.addressof(shape), ffi.addressof(hull, "base")).index1)


def set_velocity(handle: Any, linear: Vector = _STILL, angular: Vector = _STILL) -> None:
    """Set both velocities of a body; without arguments it stops."""
    lib.b3Body_SetLinearVelocity(handle, linear)
    lib.b3Body_SetAngularVelocity(handle, angular)


def split(quaternion: Quaternion) -> tuple[Vector, float]:
    """Return vector and scalar part, as Box3D's ``b3Quat`` has them."""
    w, x, y, z = quaternion
    return (x, y, z), w
