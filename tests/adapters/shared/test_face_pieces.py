"""Pieces of convex polyhedra: they fill the polyhedron, and their outer faces have few vertices."""

import numpy as np
import pytest

from adapters.shared.face_pieces import MOST_PIECES, face_pieces
from scenarios.polyhedra import faces, mass_properties, own_frame

EXACT = 1e-9


def prism(corners: int, upper: float = 1.0):
    """Return a prism, or a frustum whose upper face has the radius ``upper`` [m]; the lower face has 1 m."""
    angle = np.arange(corners) * 2 * np.pi / corners
    ring = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(corners)])
    return own_frame(np.vstack([ring, ring * upper + (0.0, 0.0, 1.0)])).polyhedron


def outer_corners(whole, piece):
    """Return the numbers of vertices of the faces of ``piece`` that lie on the surface of ``whole``."""
    found = []
    for loop in faces(whole):
        a, b, c = whole.array[list(loop[:3])]
        normal = np.cross(b - a, c - a)
        normal /= np.linalg.norm(normal)
        found += [len(own) for own in faces(piece) if np.abs((piece.array[list(own)] - a) @ normal).max() < 1e-7]
    return found


@pytest.mark.parametrize(
    ("whole", "most"),
    [(prism(5), 4), (prism(6), 4), (prism(6), 3), (prism(12), 4), (prism(6, 0.7), 4), (prism(8, 1.2), 5)],
)
def test_the_pieces_fill_the_polyhedron_and_have_small_outer_faces(whole, most):
    pieces = face_pieces(whole, most)
    assert 1 < len(pieces) <= MOST_PIECES
    volumes = [mass_properties(piece).volume for piece in pieces]
    assert sum(volumes) == pytest.approx(mass_properties(whole).volume, rel=EXACT)
    assert max(max(outer_corners(whole, piece)) for piece in pieces) <= most


@pytest.mark.parametrize("whole", [prism(3), prism(4)])
def test_small_faces_need_no_pieces(whole):
    assert face_pieces(whole, 4) == (whole,)


def test_a_face_of_too_many_vertices_stays_whole():
    """A prism of 48 sides would need 23 pieces."""
    whole = prism(48)
    assert face_pieces(whole, 4) == (whole,)
