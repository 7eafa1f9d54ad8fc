"""Convex shapes of Rapier's bodies, and the frames of their colliders."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
import rapier3d

from stability_core.port import FloatArray
from stability_core.ports.shared.shapes import HALF_SPACE, NO_AXIS, Solid, box_vertices, cylinder_vertices
from stability_core.ports.shared.vectors import rotate

Frame: TypeAlias = tuple[FloatArray, FloatArray]
"""Position (3,) [m] and quaternion (w, x, y, z), shape (4,), of a frame in another frame."""
IDENTITY: Frame = (np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))
_FROM_Z_TO_Y = np.array([[np.sqrt(0.5), -np.sqrt(0.5), 0.0, 0.0]])
"""Turn from the axis of ``cylinder_vertices`` to the axis of Rapier's cylinder."""


def frames_of(collider: rapier3d.Collider) -> list[Frame]:
    """Return the frames, in the frame of the body, in which Rapier gives the points of a collider.

    Returns:
        A frame for each shape of a compound collider, otherwise one frame; no frame if the frame of the collider is the
        frame of the body.
    """
    placed = collider.position_wrt_parent or rapier3d.Isometry3.identity()  # None without a body
    compound = collider.shape.as_compound()
    if compound is not None:
        return [_frame_of(placed * position) for position, _ in compound.shapes()]
    return [] if placed == rapier3d.Isometry3.identity() else [_frame_of(placed)]


def solid_of(colliders: list[rapier3d.Collider], center: FloatArray) -> Solid | None:
    """Return the shape of a body relative to its centre of mass, in the orientation of its frame.

    Args:
        colliders: the colliders of the body.
        center: centre of mass in the frame of the body [m], shape (3,).

    Returns:
        None if the shape is round, concave or compound, or the body has no collider. The port then adds no corners.
    """
    if len(colliders) != 1:
        return None
    (collider,) = colliders
    shape, axis = collider.shape, NO_AXIS
    if shape.shape_type == rapier3d.ShapeType.HALFSPACE:
        return Solid(HALF_SPACE)
    if (box := shape.as_cuboid()) is not None:
        vertices = box_vertices(np.array(box.half_extents.to_tuple()))
    elif (cylinder := shape.as_cylinder()) is not None:
        upright = cylinder_vertices(cylinder.radius, 2 * cylinder.half_height)
        vertices, axis = rotate(_FROM_Z_TO_Y.repeat(len(upright), axis=0), upright), np.array([0.0, 1.0, 0.0])
    elif (polyhedron := shape.as_convex_polyhedron()) is not None:
        vertices = np.array(polyhedron.points, np.float64)
    else:
        return None
    position, quaternion = (frames_of(collider) or [IDENTITY])[0]
    turn = quaternion[None]
    return Solid(position + rotate(turn.repeat(len(vertices), axis=0), vertices) - center, rotate(turn, axis[None])[0])


def in_bodies(local: FloatArray, frames_a: list[Frame], frames_b: list[Frame]) -> FloatArray:
    """Return normals and points (n, 9) in the frames of bodies, from their values in n frames of colliders."""
    if not len(local):
        return local
    (at_a, turn_a), (at_b, turn_b) = (map(np.array, zip(*frames, strict=True)) for frames in (frames_a, frames_b))
    normal, point_a, point_b = local[:, :3], local[:, 3:6], local[:, 6:]
    return np.hstack([rotate(turn_a, normal), at_a + rotate(turn_a, point_a), at_b + rotate(turn_b, point_b)])


def _frame_of(position: rapier3d.Isometry3) -> Frame:
    x, y, z, w = position.rotation.to_tuple()
    return np.array(position.translation.to_tuple()), np.array([w, x, y, z])
