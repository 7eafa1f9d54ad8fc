"""Places and convex shapes of DART's body nodes."""

from __future__ import annotations

from typing import Any

import numpy as np
from dartpy import dynamics

from stability_core.port import FloatArray
from stability_core.ports.shared.shapes import HALF_SPACE, NO_AXIS, Solid, box_vertices, cylinder_vertices

_SHIPPED_FRICTION = 1.0
"""Coefficient of friction that DART gives a shape without a dynamics aspect."""


def motion_of(node: Any) -> tuple[float, ...]:
    """Return the motion of a body node, in the columns of ``body_motions``."""
    turn = node.getTransform().quaternion()
    velocity = *node.getCOMLinearVelocity().tolist(), *node.getAngularVelocity().tolist()
    return (*node.getCOM().tolist(), turn.x(), turn.y(), turn.z(), turn.w(), *velocity)


def colliding_shapes(node: Any) -> list[Any]:
    """Return the shape nodes of a body node that collide."""
    return [shape for shape in node.getShapeNodes() if shape.hasCollisionAspect()]


def solid_of(node: Any) -> Solid | None:
    """Return the shape of a body node relative to its centre of mass, in the orientation of its frame.

    Returns:
        The solid of a plane, a box or a cylinder; None for other shapes, among them meshes, because the port reads no
        vertices of meshes; None unless exactly one shape of the body collides.
    """
    shapes = colliding_shapes(node)
    if len(shapes) != 1:
        return None
    shape, axis = shapes[0].getShape(), NO_AXIS
    if isinstance(shape, dynamics.PlaneShape):
        return Solid(HALF_SPACE)
    if isinstance(shape, dynamics.BoxShape):
        vertices = box_vertices(shape.getSize() / 2)
    elif isinstance(shape, dynamics.CylinderShape):
        vertices, axis = cylinder_vertices(shape.getRadius(), shape.getHeight()), np.array([0.0, 0.0, 1.0])
    else:
        return None
    placed = shapes[0].getRelativeTransform().matrix()
    return Solid(vertices @ placed[:3, :3].T + placed[:3, 3] - node.getLocalCOM(), placed[:3, :3] @ axis)


def box_around(node: Any) -> FloatArray:
    """Return the lower, then the upper corner [m] of the box around a body node's shapes along the world's axes, (6,).

    The function turns the bounding box of each shape, so that the result may be larger than the shapes. All six numbers
    are infinite if no shape collides.
    """
    corners = [np.full((1, 3), np.inf)]
    for shape in colliding_shapes(node):
        bounds, placed = shape.getShape().getBoundingBox(), shape.getWorldTransform().matrix()
        low, high = bounds.getMin(), bounds.getMax()
        own = (low + high) / 2 + box_vertices((high - low) / 2)
        corners.append(own @ placed[:3, :3].T + placed[:3, 3])
    every = np.concatenate(corners[1:] or corners)
    return np.concatenate([every.min(axis=0), every.max(axis=0)])


def friction_of(shape: Any) -> float:
    """Return the coefficient of friction of a shape node; DART's default for a shape without a dynamics aspect."""
    return float(shape.getDynamicsAspect().getFrictionCoeff()) if shape.hasDynamicsAspect() else _SHIPPED_FRICTION
