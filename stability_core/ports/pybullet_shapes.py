"""Convex shapes of PyBullet's bodies."""

from __future__ import annotations

from typing import Any

import numpy as np
import pybullet

from stability_core.port import FloatArray
from stability_core.ports.shared.shapes import HALF_SPACE, NO_AXIS, Solid, box_vertices, cylinder_vertices
from stability_core.ports.shared.vectors import rotate

_BASE = -1
_BODY_TYPE, _MAXIMAL = 10, 1
"""Column of getDynamicsInfo, and its value for a body in maximal coordinates."""
_INERTIA_FITS = 0.02
"""Greatest relative difference of moments of inertia of the same shape. Bullet computes the moments in single or double
precision."""


def solid_of(body: int, client: int, *, is_hull: bool) -> Solid | None:
    """Return the shape of a body's base in the frame of its centre of mass.

    Args:
        body: PyBullet's body id.
        client: PyBullet's client id.
        is_hull: True if a mesh collides as its convex hull, as meshes of free bodies do.

    Returns:
        None if the shape is round, concave, compound or unknown. The port then adds no corners.
    """
    shapes = _shapes_of(body, client)
    if len(shapes) != 1:
        return None
    shape = shapes[0]
    kind, size = shape[2], np.array(shape[3], np.float64)
    if kind == pybullet.GEOM_PLANE:
        return Solid(HALF_SPACE)
    axis = NO_AXIS
    if kind == pybullet.GEOM_BOX:
        vertices = box_vertices(size / 2)
    elif kind == pybullet.GEOM_CYLINDER:
        height, radius, _ = size
        vertices, axis = cylinder_vertices(float(radius), float(height)), np.array([0.0, 0.0, 1.0])
    elif kind == pybullet.GEOM_MESH and is_hull:
        vertices = np.array(pybullet.getMeshData(body, _BASE, collisionShapeIndex=0, physicsClientId=client)[1])
        return Solid(vertices.reshape(-1, 3)) if len(vertices) >= 4 else None
    else:
        return None
    x, y, z, w = shape[6]
    turn = np.array([[w, x, y, z]])
    placed = np.array(shape[5]) + rotate(np.tile(turn, (len(vertices), 1)), vertices)
    return Solid(placed, rotate(turn, axis[None])[0])


def _shapes_of(body: int, client: int) -> tuple[tuple[Any, ...], ...]:
    """Return PyBullet's rows of the collision shapes of a body's base; empty if the collision shapes are unknown.

    PyBullet does not report the collision shape of a body in maximal coordinates. The visual shape counts
    instead if the body's moments of inertia, which Bullet computes from the collision shape, fit the visual shape.
    """
    info = pybullet.getDynamicsInfo(body, _BASE, client)
    if info[_BODY_TYPE] != _MAXIMAL:
        return tuple(pybullet.getCollisionShapeData(body, _BASE, client))
    shown = tuple(pybullet.getVisualShapeData(body, physicsClientId=client))
    fits = len(shown) == 1 and np.allclose(_inertia(shown[0], info[0]), info[2], rtol=_INERTIA_FITS, atol=0.0)
    return shown if fits else ()


def _inertia(shape: tuple[Any, ...], mass: float) -> FloatArray:
    """Return the moments of inertia (3,) [kg m2] of a box or a cylinder; NaN for another shape."""
    if shape[2] == pybullet.GEOM_BOX:
        x, y, z = np.array(shape[3]) ** 2
        return mass / 12 * np.array([y + z, x + z, x + y])
    if shape[2] == pybullet.GEOM_CYLINDER:
        height, radius, _ = shape[3]
        across = mass / 12 * (3 * radius**2 + height**2)
        return np.array([across, across, mass * radius**2 / 2])
    return np.full(3, np.nan)
