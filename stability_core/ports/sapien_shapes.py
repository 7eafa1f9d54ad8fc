"""Convex shapes of SAPIEN's bodies, and copies of collision shapes."""

from __future__ import annotations

from typing import Any

import numpy as np
from sapien import physx

from stability_core.port import FloatArray
from stability_core.ports.sapien_calls import Component
from stability_core.ports.shared.shapes import HALF_SPACE, NO_AXIS, Solid, box_vertices, cylinder_vertices
from stability_core.ports.shared.vectors import rotate

_FROM_Z_TO_X = np.array([[np.sqrt(0.5), 0.0, np.sqrt(0.5), 0.0]])
"""Turn from the axis of ``cylinder_vertices`` to the axis of PhysX's cylinder."""


def center_of(component: Component) -> FloatArray:
    """Return the centre of mass of a body in its frame [m], shape (3,)."""
    if isinstance(component, physx.PhysxRigidBodyComponent):
        return np.array(component.cmass_local_pose.p, np.float64)
    return np.zeros(3)


def solid_of(component: Component) -> Solid | None:
    """Return the shape of a body relative to its centre of mass, in the orientation of its frame.

    Returns:
        None if the shape is round, concave or compound, or the body has no shape. The port then adds no corners.
    """
    shapes = component.collision_shapes
    if len(shapes) != 1:
        return None
    shape = shapes[0]
    axis = NO_AXIS
    if isinstance(shape, physx.PhysxCollisionShapePlane):
        return Solid(HALF_SPACE)
    if isinstance(shape, physx.PhysxCollisionShapeBox):
        vertices = box_vertices(np.array(shape.half_size, np.float64))
    elif isinstance(shape, physx.PhysxCollisionShapeCylinder):
        upright = cylinder_vertices(shape.radius, 2 * shape.half_length)
        vertices, axis = rotate(_FROM_Z_TO_X.repeat(len(upright), axis=0), upright), np.array([1.0, 0.0, 0.0])
    elif isinstance(shape, physx.PhysxCollisionShapeConvexMesh):
        vertices = np.array(shape.vertices, np.float64) * shape.scale
    else:
        return None
    turn = np.array([shape.local_pose.q], np.float64)
    placed = shape.local_pose.p + rotate(turn.repeat(len(vertices), axis=0), vertices)
    return Solid(placed - center_of(component), rotate(turn, axis[None])[0])


def copy_of(shape: Any) -> Any:
    """Return a copy of a collision shape, at the same place in its body."""
    material = shape.physical_material
    if isinstance(shape, physx.PhysxCollisionShapePlane):
        copied = physx.PhysxCollisionShapePlane(material)
    elif isinstance(shape, physx.PhysxCollisionShapeBox):
        copied = physx.PhysxCollisionShapeBox(shape.half_size, material)
    elif isinstance(shape, physx.PhysxCollisionShapeSphere):
        copied = physx.PhysxCollisionShapeSphere(shape.radius, material)
    elif isinstance(shape, physx.PhysxCollisionShapeCapsule):
        copied = physx.PhysxCollisionShapeCapsule(shape.radius, shape.half_length, material)
    elif isinstance(shape, physx.PhysxCollisionShapeCylinder):
        copied = physx.PhysxCollisionShapeCylinder(shape.radius, shape.half_length, material)
    elif isinstance(shape, physx.PhysxCollisionShapeConvexMesh):
        copied = physx.PhysxCollisionShapeConvexMesh(shape.vertices, shape.scale, material)
    else:
        copied = physx.PhysxCollisionShapeTriangleMesh(shape.vertices, shape.triangles, shape.scale, material)
    copied.local_pose = shape.local_pose
    copied.contact_offset, copied.rest_offset = shape.contact_offset, shape.rest_offset
    copied.set_collision_groups(shape.get_collision_groups())
    return copied
