"""Surfaces for pictures: closed, facing outward, and of the shape's volume."""

from __future__ import annotations

import math
from collections import Counter

import numpy as np
import pytest

from scenarios.model import Brick
from scenarios.solids import capsule, cylinder, polyhedron, sphere, volume_of
from scenarios.surfaces import surface_of

HERE = (0.0, 0.0, 0.0)
HEXAGON = [(math.cos(k * math.pi / 3), math.sin(k * math.pi / 3), z) for k in range(6) for z in (0.0, 0.5)]


@pytest.mark.parametrize(
    "brick",
    [
        Brick((0.1, 0.2, 0.3), 1.0, HERE),
        cylinder(0.1, 0.3, position=HERE, mass=1.0),
        capsule(0.1, 0.3, position=HERE, mass=1.0),
        sphere(0.1, position=HERE, mass=1.0),
        polyhedron(HEXAGON, position=HERE, mass=1.0),
    ],
    ids=["box", "cylinder", "capsule", "sphere", "polyhedron"],
)
def test_a_surface_is_closed_faces_outward_and_has_the_shapes_volume(brick: Brick) -> None:
    surface = surface_of(brick.shape, brick.size)
    edges = Counter(
        (one, other) for face in surface.faces for one, other in zip(face, (*face[1:], face[0]), strict=True)
    )
    assert set(edges.values()) == {1}
    assert all((other, one) in edges for one, other in edges)
    a, b, c = (surface.corners[list(corner)] for corner in zip(*surface.triangles, strict=True))
    volume = np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6
    # 32 sides around a round shape enclose 0.6 % less, 8 rings of a ball 1.5 %
    assert volume == pytest.approx(volume_of(brick.shape, brick.size), rel=0.03 if surface.is_round else 1e-12)
    assert surface.corners.min(axis=0) == pytest.approx([-edge / 2 for edge in brick.size])
