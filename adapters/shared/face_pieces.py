"""Pieces of a convex polyhedron whose outer faces have few vertices, for an engine that ignores further vertices."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from scenarios.polyhedra import faces
from scenarios.shapes import FloatArray, Polyhedron

ON_PLANE = 1e-9
"""Greatest distance of a vertex from a plane through it, relative to the extent. Rounding leaves about 1e-15."""
MOST_PIECES = 16
"""Greatest number of pieces, because each pair of touching pieces costs the engine a search for contacts."""


@lru_cache(maxsize=512)
def face_pieces(polyhedron: Polyhedron, most: int) -> tuple[Polyhedron, ...]:
    """Return convex pieces of a polyhedron whose outer faces have at most ``most`` vertices each.

    A plane through the first and the last of ``most`` vertices of a face, normal to the face, cuts the polyhedron into
    two. The cuts go on until no outer face has more vertices. Faces between pieces may have any number of vertices.

    Args:
        polyhedron: the polyhedron, in its own frame.
        most: the greatest number of vertices of an outer face, at least 3.

    Returns:
        The pieces in the frame of the polyhedron; the polyhedron itself if ``MOST_PIECES`` pieces do not suffice, or if
        a piece is too thin for a hull.
    """
    tolerance = ON_PLANE * max(polyhedron.extents)
    outer = [_plane(polyhedron, loop) for loop in faces(polyhedron)]
    done: list[Polyhedron] = []
    rest = [polyhedron]
    while rest:
        piece = rest.pop()
        try:
            cut = _cut_through(piece, outer, most, tolerance)
        except ValueError:  # a piece without a volume: see ``scenarios.polyhedra.faces``
            return (polyhedron,)
        if cut is None:
            done.append(piece)
        else:
            rest += _halves(piece, *cut, tolerance)
        if len(done) + len(rest) > MOST_PIECES:
            return (polyhedron,)
    return tuple(done)


def _plane(polyhedron: Polyhedron, loop: tuple[int, ...]) -> tuple[FloatArray, float]:
    """Return the outward unit normal of a face, and its distance [m] from the origin."""
    first, second, third = polyhedron.array[list(loop[:3])]
    normal = np.cross(second - first, third - first)
    normal /= np.linalg.norm(normal)
    return normal, float(normal @ first)


def _cut_through(
    piece: Polyhedron, outer: list[tuple[FloatArray, float]], most: int, tolerance: float
) -> tuple[FloatArray, float] | None:
    """Return normal and distance of the next cut of a piece; None if its outer faces have at most ``most`` vertices."""
    for loop in faces(piece):
        if len(loop) <= most:
            continue
        corners = piece.array[list(loop)]
        for normal, distance in outer:
            if np.abs(corners @ normal - distance).max() <= tolerance:
                across = np.cross(normal, corners[most - 1] - corners[0])
                across /= np.linalg.norm(across)
                return across, float(across @ corners[0])
    return None


def _halves(piece: Polyhedron, normal: FloatArray, distance: float, tolerance: float) -> list[Polyhedron]:
    """Return both parts of a piece that a plane cuts."""
    heights = piece.array @ normal - distance
    edges = {tuple(sorted(pair)) for loop in faces(piece) for pair in zip(loop, (*loop[1:], loop[0]), strict=True)}
    crossings = [
        (heights[b] * piece.array[a] - heights[a] * piece.array[b]) / (heights[b] - heights[a])
        for a, b in sorted(edges)
        if min(heights[a], heights[b]) < -tolerance and max(heights[a], heights[b]) > tolerance
    ]
    parts = []
    for sign in (1.0, -1.0):
        corners = [*piece.array[sign * heights >= -tolerance], *crossings]
        parts.append(Polyhedron(tuple((x, y, z) for x, y, z in np.array(corners).tolist())))
    return parts
