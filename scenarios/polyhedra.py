"""Convex polyhedra: hull, faces, volume and inertia by trimesh, and a polyhedron's own frame.

Import this module only for a polyhedron, because trimesh takes a second to import.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np
import numpy.typing as npt
import trimesh
from scipy.spatial import QhullError

from scenarios.shapes import FloatArray, Polyhedron

FLATNESS = 1e-3
"""Least ratio of a polyhedron's thickness to its extent, because a thinner body is an error in units or a flat face."""
MOST_VERTICES = 255
"""Greatest number of vertices, because PhysX accepts no more."""
CENTRED = 1e-9
"""Greatest distance of the centre of mass from the origin, relative to the extent, and greatest product of inertia
relative to the largest moment. Rounding of the vertices leaves about 1e-15."""
COPLANAR = 1e-9
"""Greatest difference between unit normals of triangles in one face. Rounding leaves about 1e-15 in a face as wide as
the polyhedron, and 1e-12 in a face of a thousandth of its width."""
EQUAL_MOMENTS = 1e-6
"""Relative difference below which two principal moments count as equal, so that every direction in their plane is a
principal axis."""


@dataclass(frozen=True, slots=True)
class MassProperties:
    """Mass properties of a homogeneous polyhedron of any density."""

    volume: float
    """Volume [m3]."""
    center: FloatArray
    """Centre of mass [m], shape (3,), in the frame of the vertices."""
    gyration: FloatArray
    """Inertia over the mass about the centre of mass [m2], shape (3, 3), along the axes of that frame."""


@dataclass(frozen=True, slots=True)
class OwnFrame:
    """A polyhedron in its own frame, and the pose of this frame in the frame of the given points."""

    polyhedron: Polyhedron
    center: FloatArray
    """Centre of mass [m], shape (3,), in the frame of the points."""
    axes: FloatArray
    """Rotation matrix from the own frame to the frame of the points, shape (3, 3)."""
    volume: float
    """Volume [m3]."""


def own_frame(points: npt.ArrayLike) -> OwnFrame:
    """Return the convex hull of ``points`` [m], shape (n, 3), in its own frame.

    If the axes of the given frame are principal axes, the function keeps these axes. Otherwise the function chooses the
    principal axes nearest to the axes of the given frame.

    Raises:
        ValueError: if a point is not finite, the points enclose no volume, or the hull has more than ``MOST_VERTICES``
            vertices; the message names the fix.
    """
    hull = _hull(np.asarray(points, np.float64).reshape(-1, 3))
    properties = _properties(hull)
    axes = _nearest_principal_axes(properties.gyration)
    vertices = (np.asarray(hull.vertices) - properties.center) @ axes
    polyhedron = Polyhedron(tuple((x, y, z) for x, y, z in vertices.tolist()))
    return OwnFrame(polyhedron, properties.center, axes, properties.volume)


@lru_cache(maxsize=512)
def mass_properties(polyhedron: Polyhedron) -> MassProperties:
    """Return the mass properties of a polyhedron."""
    return _properties(_hull(polyhedron.array))


@lru_cache(maxsize=512)
def faces(polyhedron: Polyhedron) -> tuple[tuple[int, ...], ...]:
    """Return the faces of a polyhedron: the indices of each face's vertices, counter-clockwise seen from outside."""
    hull = _hull(polyhedron.array)
    index = {point: number for number, point in enumerate(polyhedron.vertices)}
    named = [index[x, y, z] for x, y, z in hull.vertices.tolist()]
    loops = []
    for triangles in _coplanar(np.asarray(hull.face_normals), np.asarray(hull.face_adjacency)):
        edges = {(one, other) for face in hull.faces[triangles].tolist() for one, other in _edges(face)}
        following = {one: other for one, other in edges if (other, one) not in edges}
        loop = [min(following)]
        while len(loop) < len(following):
            loop.append(following[loop[-1]])
        loops.append(tuple(named[vertex] for vertex in loop))
    return tuple(sorted(loops))


@lru_cache(maxsize=512)
def triangles(polyhedron: Polyhedron) -> tuple[tuple[int, int, int], ...]:
    """Return triangles that cover the surface: indices of vertices, counter-clockwise seen from outside."""
    return tuple((loop[0], one, other) for loop in faces(polyhedron) for one, other in pairwise(loop[1:]))


@lru_cache(maxsize=512)
def check_polyhedron(polyhedron: Polyhedron) -> None:
    """Raise ``ValueError`` unless a polyhedron is valid; the message names the fix.

    A valid polyhedron has 4 to ``MOST_VERTICES`` finite vertices, is convex and not flat, and lies in its own frame.
    """
    hull = _hull(polyhedron.array)
    extent = max(polyhedron.extents)
    depth = np.asarray(hull.triangles_center)[:, None] - polyhedron.array[None]
    inside = (np.einsum("fk,fnk->fn", np.asarray(hull.face_normals), depth).min(axis=0) > CENTRED * extent).sum()
    if inside:
        raise ValueError(
            f"each of the {len(polyhedron.vertices)} vertices of a polyhedron must be a corner of the convex hull, but "
            f"the number of vertices inside the convex hull is {inside}: make the body with "
            "scenarios.solids.polyhedron, which drops inner points"
        )
    properties = _properties(hull)
    products = np.abs(properties.gyration - np.diag(np.diag(properties.gyration))).max()
    is_centred = np.abs(properties.center).max() <= CENTRED * extent
    if not (is_centred and products <= CENTRED * np.diag(properties.gyration).max()):
        raise ValueError(
            "vertices of a polyhedron must be relative to the centre of mass, along principal axes of inertia, but the "
            f"centre of mass is at {properties.center.tolist()} m, and the greatest product of inertia is "
            f"{products / np.diag(properties.gyration).max():.3g} times the largest moment: make the body with "
            "scenarios.solids.polyhedron, which finds the centre and the axes"
        )


def _hull(points: FloatArray) -> trimesh.Trimesh:
    finite = np.isfinite(points).all(axis=1)
    if not finite.all():
        number = int(finite.argmin())
        raise ValueError(
            f"vertices of a polyhedron must be finite, got {points[number].tolist()} m as vertex {number} (from 0): "
            "replace NaN and inf by numbers"
        )
    if len(points) < 4:
        raise ValueError(
            f"a polyhedron needs at least 4 vertices, got {len(points)}: give corners that enclose a volume"
        )
    try:
        with np.errstate(invalid="ignore", divide="ignore"):  # of a flat hull, which is refused below
            hull: trimesh.Trimesh = trimesh.convex.convex_hull(points)
    except QhullError as error:
        raise ValueError(
            f"the {len(points)} vertices of a polyhedron must enclose a volume, but do not: give at least 4 corners "
            "that do not lie in one plane"
        ) from error
    extent = float(np.ptp(points, axis=0).max())
    heights = points @ np.asarray(hull.face_normals).T
    thickness = float(np.ptp(heights, axis=0).min()) if len(hull.faces) else 0.0
    if not thickness >= FLATNESS * extent or not extent:
        raise ValueError(
            f"the vertices enclose a body that is {thickness:.3g} m thick and at most {extent:.3g} m long along the "
            f"axes x, y and z, which is too flat: give corners of a body whose thickness is at least {FLATNESS:g} "
            "times this length"
        )
    if len(hull.vertices) > MOST_VERTICES:
        raise ValueError(
            f"the convex hull of the vertices has {len(hull.vertices)} corners, more than {MOST_VERTICES}: give fewer "
            "vertices, for example those of a simpler mesh"
        )
    return hull


def _properties(hull: trimesh.Trimesh) -> MassProperties:
    """Return the mass properties of a hull.

    The function computes about the hull's middle, so that a distant origin causes no rounding error.
    """
    middle = np.asarray(hull.bounds).mean(axis=0)
    extent = float(np.ptp(hull.vertices, axis=0).max())
    unit = trimesh.triangles.mass_properties((np.asarray(hull.triangles) - middle) / extent)
    return MassProperties(
        float(unit.volume) * extent**3,
        middle + np.asarray(unit.center_mass) * extent,
        np.asarray(unit.inertia) / float(unit.mass) * extent**2,
    )


def _nearest_principal_axes(inertia: FloatArray) -> FloatArray:
    """Return the principal axes nearest to the axes of the frame, as the columns of a rotation matrix (3, 3).

    If two or three moments are equal, every direction in the space of their axes is a principal axis. In this space the
    function chooses the directions nearest to the frame's axes, by an orthogonal projection.
    """
    moments, vectors = np.linalg.eigh(inertia)
    if np.abs(inertia - np.diag(np.diag(inertia))).max() <= CENTRED * moments[-1]:
        return np.eye(3)
    axes = np.zeros((3, 3))
    free = set(range(3))
    for group in _equal_moments(moments):
        space = vectors[:, group]
        shadows = np.linalg.norm(space, axis=1)
        chosen = sorted(sorted(free, key=lambda axis: -shadows[axis])[: len(group)])
        free -= set(chosen)
        left, _, right = np.linalg.svd(space.T[:, chosen])
        axes[:, chosen] = space @ left @ right
    if np.linalg.det(axes) < 0:
        weakest = int(np.argmin(np.abs(np.diag(axes))))
        axes[:, weakest] *= -1.0
    return axes


def _equal_moments(moments: FloatArray) -> list[list[int]]:
    """Return groups of indices of equal moments; ``moments`` are in rising order."""
    groups = [[0]]
    for index in (1, 2):
        if moments[index] - moments[index - 1] <= EQUAL_MOMENTS * moments[2]:
            groups[-1].append(index)
        else:
            groups.append([index])
    return groups


def _coplanar(normals: FloatArray, adjacent: npt.NDArray[np.int64]) -> list[list[int]]:
    """Return the indices of the triangles of each flat face.

    Two triangles belong to the same face if they share an edge and a normal.
    """
    group = list(range(len(normals)))
    for one, other in adjacent.tolist():
        if np.abs(normals[one] - normals[other]).max() <= COPLANAR:
            kept, merged = group[one], group[other]
            group = [kept if label == merged else label for label in group]
    return [[index for index, label in enumerate(group) if label == kept] for kept in sorted(set(group))]


def _edges(face: list[int]) -> list[tuple[int, int]]:
    first, second, third = face
    return [(first, second), (second, third), (third, first)]
