"""Tables of a scene's file: shapes, mass or density, and errors that name field and fix."""

from __future__ import annotations

import math

import pytest

from scenarios.scenes.shared.brick_tables import read_brick, read_fixed_body
from scenarios.solids import check_solid

AT = {"position": [0.1, 0.0, 0.05], "mass": 0.5}
DIMENSIONS = {
    "box": {"size": [0.1, 0.2, 0.3]},
    "cylinder": {"radius": 0.03, "length": 0.1},
    "capsule": {"radius": 0.03, "length": 0.1},
    "sphere": {"radius": 0.03},
    "polyhedron": {"vertices": [[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]]},
}


@pytest.mark.parametrize("shape", DIMENSIONS)
def test_every_shape_can_be_written(shape):
    table = {**AT, **DIMENSIONS[shape], "shape": shape, "friction": 0.2, "restitution": 0.1, "yaw": 90.0}
    brick = read_brick("brick[0]", table)
    check_solid(brick)
    assert (brick.mass, brick.friction, brick.restitution) == (0.5, 0.2, 0.1)
    fixed = read_fixed_body("fixed[0]", {name: value for name, value in table.items() if name != "mass"})
    assert (fixed.shape, fixed.size, fixed.friction) == (brick.shape, brick.size, 0.2)


def test_a_capsules_length_leaves_out_both_caps():
    assert read_brick("b", {**AT, "shape": "capsule", "radius": 0.03, "length": 0.1}).size == (0.06, 0.06, 0.16)


def test_vertices_are_relative_to_the_position():
    """The centroid of a tetrahedron is the mean of its corners, here turned by 90 deg about z."""
    brick = read_brick("b", {**AT, **DIMENSIONS["polyhedron"], "shape": "polyhedron", "yaw": 90.0})
    assert brick.position == pytest.approx((0.1 - 0.025, 0.025, 0.05 + 0.025))


def test_a_density_replaces_the_mass():
    table = {"position": [0.0, 0.0, 0.03], "shape": "sphere", "radius": 0.03, "density": 1000.0}
    assert read_brick("b", table).mass == pytest.approx(1000 * 4 / 3 * math.pi * 0.03**3)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"shape": "cone"}, "brick\\[0\\].shape must be one of box, cylinder, capsule, sphere or polyhedron"),
        ({"shape": "cylinder"}, "unknown field of brick\\[0\\] 'size'.*radius, length"),
        ({"radius": 0.1}, "unknown field of brick\\[0\\] 'radius'"),
        ({"density": 500.0}, "mass or density, got both"),
        ({"friction": -1}, "brick\\[0\\].friction must be a number from 0"),
        ({"restitution": 2}, "brick\\[0\\].restitution must be a number from 0 to 1"),
        ({"mass": None}, "brick\\[0\\].mass is missing"),
    ],
)
def test_a_wrong_table_is_refused_with_its_fix(change, message):
    table = {name: value for name, value in {**AT, **DIMENSIONS["box"], **change}.items() if value is not None}
    with pytest.raises((ValueError, LookupError), match=message):
        read_brick("brick[0]", table)


def test_vertices_in_a_plane_are_refused_by_name():
    flat = [[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0], [0.1, 0.1, 0]]
    with pytest.raises(
        ValueError, match=r"brick\[3\].vertices: the vertices enclose a body that is 0 m thick and at most 0.1 m long"
    ):
        read_brick("brick[3]", {**AT, "shape": "polyhedron", "vertices": flat})
