"""Convex shapes of bodies: their extents, volume, inertia and farthest points.

A body's own frame has its origin at the centre of mass and its axes along principal axes of inertia. The ``size`` of a
body is the edge lengths of the smallest box along these axes that holds the body:

- box: the box itself;
- cylinder: diameter, diameter and length, with the axis along z;
- capsule: diameter, diameter and overall length with both caps, with the axis along z;
- sphere: the diameter three times;
- polyhedron: the extents of its vertices. The middle of this box need not be the centre of mass.

``size`` describes every shape completely, except a polyhedron.

``scenarios.solids`` makes bodies of these shapes, and ``scenarios.polyhedra`` finds a polyhedron's own frame.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, TypeAlias, get_args

import numpy as np
import numpy.typing as npt

FloatArray: TypeAlias = npt.NDArray[np.float64]
Point: TypeAlias = tuple[float, float, float]
SimpleShape: TypeAlias = Literal["box", "cylinder", "capsule", "sphere"]

SIMPLE_SHAPES: tuple[SimpleShape, ...] = get_args(SimpleShape)
"""Shapes that ``size`` describes completely."""


@dataclass(frozen=True)
class Polyhedron:
    """A convex polyhedron in its own frame."""

    vertices: tuple[Point, ...]
    """All corners [m], relative to the centre of mass along the principal axes of inertia, in any order."""

    @cached_property
    def array(self) -> FloatArray:
        """Return the vertices [m], shape (n, 3), as a read-only array."""
        array = np.array(self.vertices, np.float64).reshape(-1, 3)
        array.flags.writeable = False
        return array

    @cached_property
    def extents(self) -> Point:
        """Return the edge lengths [m] of the smallest box along its own axes that holds all vertices."""
        x, y, z = np.ptp(self.array, axis=0).tolist()
        return x, y, z

    def scaled(self, factor: float) -> Polyhedron:
        """Return the polyhedron with all lengths times ``factor``."""
        return Polyhedron(tuple((factor * x, factor * y, factor * z) for x, y, z in self.vertices))


Shape: TypeAlias = SimpleShape | Polyhedron


def name_of(shape: Shape) -> str:
    """Return the shape's name: ``box``, ``cylinder``, ``capsule``, ``sphere`` or ``polyhedron``."""
    return "polyhedron" if isinstance(shape, Polyhedron) else shape


def half_extents(shape: Shape, size: Point) -> FloatArray:
    """Return the greatest distance [m] of a point from the centre of mass along each own axis, shape (3,)."""
    if isinstance(shape, Polyhedron):
        half: FloatArray = np.abs(shape.array).max(axis=0)
        return half
    return np.array(size) / 2


def reach(shape: Shape, size: Point) -> float:
    """Return the greatest distance [m] of a point from the centre of mass."""
    x, _, z = size
    match shape:
        case "box":
            return math.hypot(*size) / 2
        case "cylinder":
            return math.hypot(x, z) / 2
        case "capsule" | "sphere":
            return z / 2
    return float(np.sqrt((shape.array**2).sum(axis=1).max()))


def support_points(shape: Shape, size: Point, directions: FloatArray) -> FloatArray:
    """Return a farthest point [m] of the shape along each direction, shape (n, 3), in the shape's own frame.

    Args:
        shape: the shape.
        size: edge lengths [m] of the smallest box along the shape's own axes.
        directions: vectors of any length above 0, shape (n, 3), in the shape's own frame.
    """
    if isinstance(shape, Polyhedron):
        farthest: FloatArray = shape.array[(directions @ shape.array.T).argmax(axis=1)]
        return farthest
    half = np.array(size) / 2
    corner: FloatArray = np.where(directions < 0, -half, half)
    if shape == "box":
        return corner
    if shape == "cylinder":
        across = np.hypot(directions[:, 0], directions[:, 1])[:, None]
        corner[:, :2] = half[0] * directions[:, :2] / np.where(across > 0, across, 1.0)
        return corner
    point: FloatArray = half[0] * directions / np.linalg.norm(directions, axis=1)[:, None]
    point[:, 2] += np.where(directions[:, 2] < 0, -1.0, 1.0) * (half[2] - half[0])
    return point


def volume(shape: SimpleShape, size: Point) -> float:
    """Return the volume [m3] of a shape that is no polyhedron."""
    x, y, z = size
    match shape:
        case "box":
            return x * y * z
        case "cylinder":
            return math.pi / 4 * x * x * z
        case "capsule":
            return math.pi / 4 * x * x * (z - x) + math.pi / 6 * x**3
        case "sphere":
            return math.pi / 6 * x**3


def gyration(shape: SimpleShape, size: Point) -> Point:
    """Return the moments of inertia over the mass [m2], (3,), of a homogeneous shape that is no polyhedron."""
    x, y, z = size
    match shape:
        case "box":
            return (y * y + z * z) / 12, (x * x + z * z) / 12, (x * x + y * y) / 12
        case "cylinder":
            across = x * x / 16 + z * z / 12
            return across, across, x * x / 8
        case "capsule":
            return _gyration_of_capsule(x / 2, z - x)
        case "sphere":
            return x * x / 10, x * x / 10, x * x / 10


def _gyration_of_capsule(radius: float, length: float) -> Point:
    """Return the moments over the mass [m2] of a cylinder of ``length`` [m] with a half sphere at each end.

    The centre of mass of a half sphere of radius r lies 3 r / 8 from the flat face. The length is l. The cylinder has
    the share c of the mass, and both half spheres together have the share s. The moments over the mass are

        along the axis: c r^2 / 2 + s 2 r^2 / 5
        across:         c (r^2 / 4 + l^2 / 12) + s (2 r^2 / 5 + l^2 / 4 + 3 l r / 8).
    """
    sphere = 4 / 3 * radius / (length + 4 / 3 * radius)
    cylinder = 1 - sphere
    across = cylinder * (radius**2 / 4 + length**2 / 12) + sphere * (
        2 / 5 * radius**2 + length**2 / 4 + 3 / 8 * length * radius
    )
    return across, across, cylinder * radius**2 / 2 + sphere * 2 / 5 * radius**2


def symmetry(shape: Shape) -> Literal["none", "axis", "point"]:
    """Return the shape's rotational symmetry: about no axis, about its own z axis, or about every axis."""
    match shape:
        case "cylinder" | "capsule":
            return "axis"
        case "sphere":
            return "point"
    return "none"


def are_boxes(shapes: Sequence[Shape]) -> bool:
    """Return whether all shapes are boxes."""
    return all(shape == "box" for shape in shapes)
