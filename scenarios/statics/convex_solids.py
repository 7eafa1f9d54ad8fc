"""Convex solids for statics: a core of straight edges, rounded by a ball or widened by a disk.

A solid is the Minkowski sum of a core and of a ball or a disk:

- convex polyhedron: the core alone;
- sphere: a point and a ball;
- capsule: a segment and a ball;
- cylinder: a segment and a disk perpendicular to the segment.

The support function gives the greatest coordinate of a solid along a unit vector n, and is exact for each shape:

    h(n) = max over core vertices v of (v . n)  +  ball radius  +  disk radius * |n - (n . a) a|     (a: axis)

The *feature* of a solid along n is the set of its points with the coordinate h(n): a point, a segment or a polygon. The
end face of a cylinder is no polygon. A polygon of ``DISK_CORNERS`` points on its rim replaces the end face.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import numpy.typing as npt
from scipy.spatial import ConvexHull

from scenarios.geometry import FloatArray

DISK_CORNERS = 32
"""Number of corners of the polygon inscribed in the end face of a cylinder. The polygon's least radius is 0.5 % smaller
than the cylinder's radius, so that a cylinder does not stand longer in statics than in reality. Two corners lie on each
of the first two directions perpendicular to the axis, in which tests tilt cylinders."""
_SAME_PLANE = 1e-7
"""Greatest distance of two facets' unit normals that lie in one face, because a convex hull consists of triangles."""
_DIRECTIONS = np.vstack([np.eye(3), -np.eye(3)])


@dataclass(frozen=True)
class Solid:
    """A convex solid in its pose."""

    core: FloatArray
    """Vertices of the core [m], shape (v, 3)."""
    edges: npt.NDArray[np.int64]
    """Indices of both vertices of each edge of the core, shape (e, 2)."""
    face_normals: FloatArray
    """Outward unit normals of the core's faces, shape (f, 3)."""
    ball: float = 0.0
    """Radius of the ball [m]."""
    disk: float = 0.0
    """Radius of the disk [m]."""
    axis: FloatArray = field(default_factory=lambda: np.array([0.0, 0.0, 1.0]))
    """Unit vector perpendicular to the disk, shape (3,)."""

    @cached_property
    def middle(self) -> FloatArray:
        """Return the mean of the core's vertices [m], shape (3,): a point inside the solid."""
        middle: FloatArray = self.core.mean(axis=0)
        return middle

    @cached_property
    def thinnest(self) -> float:
        """Return the least width [m]: across faces, along or across a cylinder's axis, or across a ball."""
        if self.ball:
            return 2 * self.ball
        normals = self.axis[None] if self.disk else self.face_normals
        widths = self.support(normals) + self.support(-normals)
        return float(min(widths.min(), 2 * self.disk if self.disk else np.inf))

    @cached_property
    def bounds(self) -> FloatArray:
        """Return the lower and the upper corner [m] of the axis-aligned bounding box, shape (2, 3)."""
        reach = self.support(_DIRECTIONS)
        return np.array([-reach[3:], reach[:3]])

    def support(self, directions: FloatArray) -> FloatArray:
        """Return the greatest coordinate [m] along each unit vector (k, 3), shape (k,)."""
        reach: FloatArray = (directions @ self.core.T).max(axis=1) + self.ball
        if self.disk:
            reach = reach + self.disk * np.sqrt(np.maximum(0.0, 1.0 - (directions @ self.axis) ** 2))
        return reach

    def feature(self, direction: FloatArray, depth: float) -> FloatArray:
        """Return the corners (k, 3) [m] of the feature along a unit vector.

        Args:
            direction: the unit vector, shape (3,).
            depth: greatest distance [m] of a vertex of the feature below the greatest coordinate.
        """
        heights = self.core @ direction
        if not self.disk:
            vertices: FloatArray = self.core[heights >= heights.max() - depth] + self.ball * direction
            return vertices
        rise = float(direction @ self.axis)
        across = direction - rise * self.axis
        lean = float(np.linalg.norm(across))
        if 2 * self.disk * lean <= depth:
            return self.rim(self.core[heights.argmax()])
        side: FloatArray = self.core[heights >= heights.max() - depth] + self.disk * across / lean
        return side

    def rim(self, end: FloatArray) -> FloatArray:
        """Return the corners (``DISK_CORNERS``, 3) [m] of the polygon in the end face with the centre ``end``."""
        angles = np.arange(DISK_CORNERS) * (2 * np.pi / DISK_CORNERS)
        around: FloatArray = np.column_stack([np.cos(angles), np.sin(angles)]) @ perpendicular(self.axis)
        return end + self.disk * around


def perpendicular(axis: FloatArray) -> FloatArray:
    """Return two unit vectors perpendicular to a unit vector (3,) and to each other, shape (2, 3)."""
    first = np.cross(np.eye(3)[np.abs(axis).argmin()], axis)
    first /= np.linalg.norm(first)
    return np.array([first, np.cross(axis, first)])


def polyhedron(vertices: FloatArray) -> Solid:
    """Return the convex hull of vertices (v, 3) [m], which must not lie in one plane."""
    hull = ConvexHull(vertices)
    core = vertices[hull.vertices]
    normals: list[FloatArray] = []
    pairs: set[tuple[int, int]] = set()
    for normal in hull.equations[:, :3]:
        if any(np.abs(normal - known).max() <= _SAME_PLANE for known in normals):
            continue
        normals.append(normal)
        heights = core @ normal
        size = np.ptp(heights)
        corners = np.flatnonzero(heights >= heights.max() - _SAME_PLANE * size)
        flat = (core[corners] - core[corners[0]]) @ perpendicular(normal).T
        around = flat - flat.mean(axis=0)
        loop = corners[np.argsort(np.arctan2(around[:, 1], around[:, 0]))].tolist()
        pairs |= {(min(a, b), max(a, b)) for a, b in zip(loop, loop[1:] + loop[:1], strict=True)}
    return Solid(core, np.array(sorted(pairs)), np.array(normals))


def sphere(center: FloatArray, radius: float) -> Solid:
    """Return a sphere with the ``center`` (3,) [m] and the ``radius`` [m]."""
    return Solid(center[None], np.empty((0, 2), np.int64), np.empty((0, 3)), ball=radius)


def capsule(center: FloatArray, axis: FloatArray, length: float, radius: float) -> Solid:
    """Return a capsule with the ``center`` (3,) [m], along the unit vector ``axis`` (3,).

    The ``length`` [m] excludes both caps.
    """
    ends = center + np.outer([-length / 2, length / 2], axis)
    return Solid(ends, np.array([[0, 1]]), np.empty((0, 3)), ball=radius)


def cylinder(center: FloatArray, axis: FloatArray, length: float, radius: float) -> Solid:
    """Return a cylinder with the ``center`` (3,) [m] and the ``length`` [m], along the unit vector ``axis`` (3,)."""
    ends = center + np.outer([-length / 2, length / 2], axis)
    return Solid(ends, np.array([[0, 1]]), np.empty((0, 3)), disk=radius, axis=axis)
