"""Contacts of the present poses of a DART world, at gaps of zero too, without a change of the world.

DART's own query lists no contact across a gap, and rounding decides whether shapes at a gap of zero touch. With DART's
detector FCL the query also changes later steps in their last bits. This module collides copies of the shapes in a
separate collision group. Copies of boxes, cylinders, spheres and capsules are slightly larger than the shapes.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any, NamedTuple

import dartpy
from dartpy import dynamics

from stability_core.ports.dart_shapes import colliding_shapes

GROWTH = 1e-5
"""Distance [m] by which the surface of a copy lies outside the shape. For a plank of 117 mm this is a fiftieth of the
greatest gap of a contact (``Settings.contact_gap``)."""


class Original(NamedTuple):
    """The original shape of a copy."""

    body: int
    """Id of the body of the shape."""
    shape: Any
    """DART's shape node."""
    growth: float
    """Distance [m] by which the surface of the copy lies outside the shape: 0 for shapes without an enlarged copy."""


@contextmanager
def present_contacts(world: Any, nodes: Mapping[int, Any]) -> Iterator[tuple[list[Any], dict[Any, Original]]]:
    """Yield the contacts among the copies, and the original of each copy's frame.

    Both values are valid within the context.

    Args:
        world: the world.
        nodes: body node of each id.
    """
    solver, result = world.getConstraintSolver(), dartpy.collision.CollisionResult()
    group = solver.getCollisionDetector().createCollisionGroup()
    originals: dict[Any, Original] = {}
    for body, node in nodes.items():
        for shape in colliding_shapes(node) if node.isCollidable() else ():
            copied, growth = _enlarged(shape.getShape())
            frame = dynamics.SimpleFrame()
            frame.setShape(copied)
            frame.setRelativeTransform(shape.getWorldTransform())
            originals[frame] = Original(body, shape, growth)
            group.addShapeFrame(frame)
    group.collide(solver.getCollisionOption(), result)
    yield result.getContacts(), originals


def _enlarged(shape: Any) -> tuple[Any, float]:
    """Return an enlarged copy of a shape and the growth on every side [m]; the shape itself and 0 for other kinds."""
    match shape:
        case dynamics.BoxShape():
            return dynamics.BoxShape(shape.getSize() + 2 * GROWTH), GROWTH
        case dynamics.CylinderShape():
            return dynamics.CylinderShape(shape.getRadius() + GROWTH, shape.getHeight() + 2 * GROWTH), GROWTH
        case dynamics.SphereShape():
            return dynamics.SphereShape(shape.getRadius() + GROWTH), GROWTH
        case dynamics.CapsuleShape():
            return dynamics.CapsuleShape(shape.getRadius() + GROWTH, shape.getHeight()), GROWTH
    return shape, 0.0
