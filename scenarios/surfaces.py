"""Surfaces of shapes for pictures: corners and flat faces. Many flat faces replace a round surface."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np

from scenarios.shapes import FloatArray, Point, Polyhedron, Shape

SIDES = 32
"""Number of flat sides around a round shape. From the side a picture of 1000 pixels shows an error of 2."""
_RINGS = 8
"""Number of rings of faces from the equator of a ball to its pole."""


@dataclass(frozen=True, slots=True)
class Surface:
    """The surface of a shape, in the shape's own frame."""

    corners: FloatArray
    """Corners [m], shape (n, 3)."""
    faces: tuple[tuple[int, ...], ...]
    """Corners of each face, counter-clockwise seen from outside."""
    is_round: bool
    """True if the faces approach a round shape, whose edges a picture should hide."""

    @property
    def triangles(self) -> tuple[tuple[int, int, int], ...]:
        """Return triangles that cover the faces, counter-clockwise seen from outside."""
        return tuple((face[0], one, other) for face in self.faces for one, other in pairwise(face[1:]))


@lru_cache(maxsize=512)
def surface_of(shape: Shape, size: Point) -> Surface:
    """Return the surface of a shape.

    Args:
        shape: the shape.
        size: edge lengths [m] of the smallest box along the shape's own axes.
    """
    if isinstance(shape, Polyhedron):
        from scenarios.polyhedra import faces  # here, because trimesh is slow to import

        return Surface(shape.array, faces(shape), False)
    x, y, z = np.array(size) / 2
    if shape == "box":
        corners = np.array([[i, j, k] for i in (-x, x) for j in (-y, y) for k in (-z, z)])
        return Surface(
            corners, ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)), False
        )
    if shape == "cylinder":
        return _turned(np.array([[x, -z], [x, z]]), closes=False)
    angles = np.linspace(0, np.pi / 2, _RINGS + 1)[:-1]
    half = np.column_stack([x * np.cos(angles), z - x + x * np.sin(angles)])
    lower = half[::-1] * (1, -1)
    profile = np.vstack([lower[: -1 if z == x else None], half])
    return _turned(np.vstack([profile, [[0.0, z]], [[0.0, -z]]]), closes=True)


def _turned(profile: FloatArray, *, closes: bool) -> Surface:
    """Return the surface of a profile turned about z.

    Args:
        profile: radius and height [m] of each ring from below, shape (k, 2). If ``closes`` is True, the last two rows
            are the upper and the lower pole.
        closes: True for poles, False for flat ends.
    """
    rings = profile[:-2] if closes else profile
    angles = np.arange(SIDES) * 2 * np.pi / SIDES
    around = np.column_stack([np.cos(angles), np.sin(angles)])
    corners = np.vstack([np.column_stack([radius * around, np.full(SIDES, height)]) for radius, height in rings])
    faces: list[tuple[int, ...]] = []
    for ring in range(len(rings) - 1):
        low, high = ring * SIDES, (ring + 1) * SIDES
        faces += [(low + k, low + (k + 1) % SIDES, high + (k + 1) % SIDES, high + k) for k in range(SIDES)]
    top = (len(rings) - 1) * SIDES
    if not closes:
        return Surface(corners, (*faces, tuple(range(SIDES))[::-1], tuple(range(top, top + SIDES))), True)
    upper, lower = len(corners), len(corners) + 1
    faces += [(top + k, top + (k + 1) % SIDES, upper) for k in range(SIDES)]
    faces += [((k + 1) % SIDES, k, lower) for k in range(SIDES)]
    poles = np.column_stack([np.zeros((2, 2)), profile[-2:, 1]])
    return Surface(np.vstack([corners, poles]), tuple(faces), True)
