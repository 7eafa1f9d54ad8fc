"""Shapes: volume, inertia, farthest points, and the own frame of a polyhedron."""

from __future__ import annotations

import math

import numpy as np
import pytest
import trimesh

from scenarios import shapes
from scenarios.geometry import rotation
from scenarios.model import Brick, Quaternion, World
from scenarios.polyhedra import check_polyhedron, faces, own_frame, triangles
from scenarios.shapes import Polyhedron
from scenarios.solids import (
    capsule,
    check_solid,
    cylinder,
    enlarged,
    friction_of,
    moments_of,
    of_pair,
    polyhedron,
    sphere,
    volume_of,
)

HERE = (0.0, 0.0, 0.0)
WEDGE = [(0, 0, 0), (0.3, 0, 0), (0, 0, 0.2), (0, 0.1, 0), (0.3, 0.1, 0), (0, 0.1, 0.2)]
"""A right triangular prism: edges of 0.3, 0.1 and 0.2 m."""
TURN: Quaternion = (0.5, -0.5, 0.1, math.sqrt(0.49))


def mesh_of(brick: Brick) -> trimesh.Trimesh:
    """Return a fine mesh of a round brick, made by trimesh."""
    x, _, z = brick.size
    if brick.shape == "cylinder":
        return trimesh.creation.cylinder(x / 2, z, sections=512)
    if brick.shape == "capsule":
        return trimesh.creation.capsule(z - x, x / 2, count=(256, 256))
    return trimesh.creation.uv_sphere(x / 2, count=(256, 256))


@pytest.mark.parametrize(
    "brick",
    [
        cylinder(0.1, 0.3, position=HERE, mass=2.0),
        capsule(0.1, 0.3, position=HERE, mass=2.0),
        sphere(0.1, position=HERE, mass=2.0),
    ],
    ids=["cylinder", "capsule", "sphere"],
)
def test_a_round_shape_has_the_volume_and_the_inertia_of_its_fine_mesh(brick: Brick) -> None:
    mesh = mesh_of(brick)
    mesh.density = brick.mass / mesh.volume
    # a mesh of 512 or 256 segments lies inside the shape by up to 8e-5 of the radius
    assert volume_of(brick.shape, brick.size) == pytest.approx(mesh.volume, rel=5e-4)
    assert moments_of(brick) == pytest.approx(np.diag(mesh.moment_inertia), rel=1e-3)


def test_a_box_of_eight_vertices_has_the_mass_properties_of_a_box() -> None:
    edges = (0.1, 0.2, 0.3)
    corners = [(i, j, k) for i in (0, edges[0]) for j in (0, edges[1]) for k in (0, edges[2])]
    brick = polyhedron(corners, position=(1.0, 2.0, 3.0), density=600.0)
    box = Brick(edges, 600.0 * math.prod(edges), (1.05, 2.1, 3.15))
    assert (*brick.size, brick.mass, *brick.position) == pytest.approx((*box.size, box.mass, *box.position))
    assert brick.quaternion == box.quaternion
    assert moments_of(brick) == pytest.approx(moments_of(box))
    assert len(faces(own_frame(corners).polyhedron)) == 6


def test_a_polyhedron_keeps_its_place_when_it_gets_its_own_frame() -> None:
    brick = polyhedron(WEDGE, position=(3.0, 1.0, 2.0), quaternion=TURN, mass=1.0)
    check_solid(brick)
    assert isinstance(brick.shape, Polyhedron)
    own = brick.shape.array @ rotation(np.array([brick.quaternion]))[0].T + brick.position
    given = np.array(WEDGE) @ rotation(np.array([TURN]))[0].T + (3.0, 1.0, 2.0)
    assert sorted(np.round(own, 9).tolist()) == sorted(np.round(given, 9).tolist())
    # the centroid of the triangle and, of the prism, half its height: closed form
    center = rotation(np.array([TURN]))[0] @ (0.1, 0.05, 0.2 / 3) + (3.0, 1.0, 2.0)
    assert brick.position == pytest.approx(center, abs=1e-12)
    # I_yy of a right triangle's prism about its centre is m (a^2 + b^2) / 18; y is a principal axis
    assert moments_of(brick)[1] == pytest.approx((0.3**2 + 0.2**2) / 18, rel=1e-12)
    assert volume_of(brick.shape, brick.size) == pytest.approx(0.3 * 0.2 * 0.1 / 2, rel=1e-12)


def test_the_axes_of_a_hexagonal_column_stay_as_given_although_two_moments_are_equal() -> None:
    hexagon = [(math.cos(k * math.pi / 3), math.sin(k * math.pi / 3), z) for k in range(6) for z in (0.0, 0.5)]
    frame = own_frame(hexagon)
    assert np.array_equal(frame.axes, np.eye(3))
    loops = faces(frame.polyhedron)
    assert sorted(map(len, loops)) == [4] * 6 + [6] * 2
    assert len(triangles(frame.polyhedron)) == 6 * 2 + 2 * 4
    for loop in loops:  # counter-clockwise from outside, where the origin is inside
        first, second, third = (frame.polyhedron.array[index] for index in loop[:3])
        assert np.cross(second - first, third - second) @ first > 0


def test_random_polyhedra_lie_in_their_own_frame_wherever_they_are_given() -> None:
    rng = np.random.default_rng(2026)
    for _ in range(5):
        points = rng.normal(size=(30, 3)) * (0.05, 0.02, 0.01) + rng.normal(size=3)
        frame = own_frame(points)
        check_polyhedron(frame.polyhedron)
        assert np.linalg.det(frame.axes) == pytest.approx(1.0)


@pytest.mark.parametrize("shape", ["box", "cylinder", "capsule", "sphere"])
def test_the_farthest_point_is_in_the_shape_and_beats_every_other(shape: shapes.SimpleShape) -> None:
    size = {"box": (0.2, 0.1, 0.3), "cylinder": (0.2, 0.2, 0.3), "capsule": (0.2, 0.2, 0.5), "sphere": (0.2, 0.2, 0.2)}[
        shape
    ]
    directions = np.vstack([np.eye(3), -np.eye(3), np.random.default_rng(5).normal(size=(50, 3))])
    points = shapes.support_points(shape, size, directions)
    heights = directions @ points.T
    assert np.allclose(heights.max(axis=1), np.diag(heights))
    assert np.linalg.norm(points, axis=1).max() <= shapes.reach(shape, size) * (1 + 1e-12)
    assert (np.abs(points) <= shapes.half_extents(shape, size) * (1 + 1e-12)).all()


def test_an_enlarged_brick_keeps_mass_and_pose_and_scales_its_inertia() -> None:
    brick = polyhedron(WEDGE, position=(1.0, 0.0, 0.5), mass=2.0)
    large = enlarged(brick, 10.0)
    check_solid(large)
    assert (large.mass, large.position) == (brick.mass, brick.position)
    assert moments_of(large) == pytest.approx([100 * moment for moment in moments_of(brick)])


def test_a_pair_has_the_geometric_mean_of_both_frictions() -> None:
    world = World(friction=0.4)
    brick = cylinder(0.1, 0.1, position=HERE, mass=1.0)
    assert friction_of(brick, world) == 0.4
    assert of_pair(0.4, 0.1) == pytest.approx(0.2)
    assert of_pair(0.45, 0.45) == 0.45  # not the root of the square, which may differ in the last bit


@pytest.mark.parametrize(
    ("brick", "fix"),
    [
        (Brick((0.1, 0.2, 0.3), 1.0, HERE, shape="cylinder"), "scenarios.solids.cylinder"),
        (Brick((0.1, 0.1, 0.3), 1.0, HERE, shape="sphere"), "scenarios.solids.sphere"),
        (Brick((0.2, 0.2, 0.1), 1.0, HERE, shape="capsule"), "use a sphere"),
        (Brick((0.1, 0.1, 0.1), 1.0, HERE, shape="cone"), "one of box, cylinder, capsule or sphere"),  # type: ignore[arg-type]
        (Brick((0.1, 0.1, 0.1), 1.0, HERE, friction=-0.1), "friction"),
        (Brick((0.1, 0.1, 0.1), 1.0, HERE, restitution=1.5), "restitution"),
        (Brick((0.1, 0.1, 0.1), 1.0, HERE, moments=(1.0, 1.0, 2.5)), "no body has"),
        (Brick((0.1, 0.1, 0.1), 1.0, HERE, moments=(1.0, 1.0, float("nan"))), "three positive"),
        (Brick((0.3, 0.1, 0.2), 1.0, HERE, shape=Polyhedron(tuple(WEDGE))), "relative to the centre of mass"),
        (Brick((0.3, 0.1, 0.2), 1.0, HERE, shape=Polyhedron((*WEDGE, (0.05, 0.05, 0.05)))), "inside the convex hull"),
        (Brick((9.0, 0.1, 0.2), 1.0, HERE, shape=own_frame(WEDGE).polyhedron), "extents of its vertices"),
    ],
)
def test_a_wrong_shape_is_refused_with_its_fix(brick: Brick, fix: str) -> None:
    with pytest.raises(ValueError, match=fix):
        check_solid(brick)


@pytest.mark.parametrize(
    ("points", "what"),
    [
        ([(0, 0, 0), (1, 0, 0), (0, 1, 0)], "at least 4 vertices"),
        ([(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)], "0 m thick and at most 1 m long"),
        ([(0, 0, 0)] * 5, "enclose a volume|0 m thick"),
        ([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1e-4)], "thickness is at least"),
    ],
)
def test_points_without_a_volume_are_refused(points: list[tuple[float, float, float]], what: str) -> None:
    with pytest.raises(ValueError, match=what):
        polyhedron(points, position=HERE, mass=1.0)


def test_mass_and_density_are_alternatives() -> None:
    with pytest.raises(ValueError, match="either mass or density"):
        sphere(0.1, position=HERE)
    assert sphere(0.1, position=HERE, density=3.0).mass == pytest.approx(3.0 * 4 / 3 * math.pi * 1e-3)
