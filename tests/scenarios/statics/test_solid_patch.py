"""Where convex solids touch: hand-worked patches of each kind, and the gaps by an independent conic solver."""

import math
from itertools import product

import clarabel
import numpy as np
import pytest
from scipy.sparse import csc_matrix

from scenarios.geometry import Boxes, rotation
from scenarios.model import Brick
from scenarios.statics.contact_patch import PLANNED, RIDGE_GAP, contact_patches
from scenarios.statics.convex_solids import DISK_CORNERS, capsule, cylinder, polyhedron, sphere
from scenarios.statics.solid_patch import OverlapError, solids_touch

EXACT = 1e-9
"""m: rounding of a sum of a few lengths below 1 m, and of the search along a rim."""
X, Y, Z = np.eye(3)


def touch(first, second, *, gap=1e-7, **options):
    return solids_touch(first, second, gap=gap, ridge_gap=0.0, parallel=PLANNED.parallel, **options)


def block(size, position, turn=(1.0, 0.0, 0.0, 0.0)):
    return polyhedron(Boxes.at([size], [position], [turn]).corners[0])


def prism(sides, radius, height, bottom=0.0, *, center=(0.0, 0.0)):
    angles = np.arange(sides) * 2 * math.pi / sides
    ring = np.column_stack([radius * np.cos(angles) + center[0], radius * np.sin(angles) + center[1]])
    return polyhedron(np.vstack([np.column_stack([ring, np.full(sides, z)]) for z in (bottom, bottom + height)]))


def extent(points):
    return np.ptp(points, axis=0)


# -- patches of each kind ----------------------------------------------------------------------------------------------


def test_hexagonal_drums_share_their_hexagon():
    points, normal = touch(prism(6, 0.1, 0.05), prism(6, 0.1, 0.05, 0.05))
    assert normal == pytest.approx(Z)
    assert len(np.unique(points.round(9), axis=0)) == 6
    assert extent(points) == pytest.approx([0.2, 0.1 * math.sqrt(3), 0], abs=EXACT)


def test_a_triangle_on_a_square_is_clipped():
    points, normal = touch(block((0.1, 0.1, 0.02), (0, 0, -0.01)), prism(3, 0.06, 0.03, center=(0.03, 0.0)))
    assert normal == pytest.approx(Z)
    assert points[:, 0].max() == pytest.approx(0.05)  # the corner at x = 0.09 m is cut off
    assert points[:, 0].min() == pytest.approx(0.0, abs=EXACT)


def test_a_roof_carries_a_block_on_its_edge():
    roof = polyhedron(
        np.array([[x, y, 0.0] for x in (-0.05, 0.05) for y in (-0.1, 0.1)] + [[0, -0.1, 0.05], [0, 0.1, 0.05]])
    )
    points, normal = touch(roof, block((0.3, 0.1, 0.02), (0.0, 0.0, 0.06)))
    assert normal == pytest.approx(Z)
    assert extent(points) == pytest.approx([0, 0.1, 0], abs=EXACT)
    assert points[:, 2] == pytest.approx([0.05, 0.05])


def test_roofs_that_cross_touch_in_a_point():
    ridge = np.array([[x, y, 0.0] for x in (-0.05, 0.05) for y in (-0.1, 0.1)] + [[0, -0.1, 0.05], [0, 0.1, 0.05]])
    upper = ridge[:, [1, 0, 2]] * [1, 1, -1] + [0.02, 0.03, 0.1]
    points, normal = touch(polyhedron(ridge), polyhedron(upper))
    assert normal == pytest.approx(Z)
    assert points == pytest.approx(np.array([[0.0, 0.03, 0.05]]))


def test_a_tip_stands_on_a_face_and_two_tips_only_graze():
    cone = np.array([[math.cos(t), math.sin(t), 1.0] for t in np.arange(5)] + [[0, 0, 0]]) * 0.05
    points, normal = touch(block((0.1, 0.1, 0.02), (0.01, 0, -0.01)), polyhedron(cone))
    assert (points, normal) == (pytest.approx(np.zeros((1, 3)), abs=EXACT), pytest.approx(Z))
    assert touch(polyhedron(-cone), polyhedron(cone)) is None


def test_parallel_edges_meet_by_convention():
    """Two wedges whose edges meet: the faces' normals are 30 deg to either side of x, and the bisector is x."""
    half = math.radians(30)
    wedge = np.array(
        [[0, y, 0] for y in (-1, 1)] + [[-math.cos(half), y, s * math.sin(half)] for y in (-1, 1) for s in (-1, 1)]
    )
    mirrored = wedge * [-1, 1, 1] + [0, 0.5, 0]
    pair = polyhedron(wedge), polyhedron(mirrored)
    points, normal = touch(*pair)
    assert normal == pytest.approx(X)
    assert extent(points) == pytest.approx([0, 1.5, 0], abs=EXACT)
    _, face = touch(*pair, is_bisector=False)
    assert abs(face @ X) == pytest.approx(math.cos(math.radians(60)))
    assert (pair[0].face_normals @ face).max() == pytest.approx(1.0)


def test_spheres_touch_in_a_point_between_their_centres():
    away = np.array([1.0, 2.0, 2.0]) / 3
    points, normal = touch(sphere(np.zeros(3), 0.02), sphere(0.05 * away, 0.03))
    assert (normal, points) == (pytest.approx(away), pytest.approx(0.02 * away[None]))


@pytest.mark.parametrize(
    ("center", "normal"),
    [
        ((0.01, 0.02, 0.07), Z),  # on a face
        ((0.05 + 0.02 * 0.6, 0.01, 0.05 + 0.02 * 0.8), (0.6, 0, 0.8)),  # on an edge
        ((0.05 + 0.02 / 3, 0.05 + 0.04 / 3, 0.05 + 0.04 / 3), (1 / 3, 2 / 3, 2 / 3)),  # on a corner
    ],
)
def test_a_sphere_touches_face_edge_and_corner(center, normal):
    points, found = touch(block((0.1, 0.1, 0.1), (0, 0, 0)), sphere(np.array(center), 0.02))
    assert found == pytest.approx(np.array(normal))
    assert points == pytest.approx((np.array(center) - 0.02 * np.array(normal))[None])


def test_capsules_touch_along_a_line_or_in_a_point():
    low = capsule(np.zeros(3), X, 0.2, 0.01)
    points, normal = touch(low, capsule(np.array([0.05, 0.012, 0.016]), X, 0.2, 0.01))
    assert normal == pytest.approx([0, 0.6, 0.8])
    assert np.sort(points[:, 0]) == pytest.approx([-0.05, 0.1])
    points, normal = touch(low, capsule(np.array([0.05, 0.0, 0.02]), Y, 0.2, 0.01))
    assert (normal, points) == (pytest.approx(Z), pytest.approx(np.array([[0.05, 0, 0.01]])))


def test_a_standing_cylinder_rests_on_its_end_face():
    points, normal = touch(block((1, 1, 0.1), (0, 0, -0.05)), cylinder(np.array([0, 0, 0.1]), Z, 0.2, 0.05))
    assert normal == pytest.approx(Z)
    assert len(points) == DISK_CORNERS
    assert np.linalg.norm(points, axis=1) == pytest.approx(np.full(DISK_CORNERS, 0.05))


def test_drums_that_are_offset_share_a_lens():
    """The common part of two disks of radius r at the distance d reaches r - d / 2 along it, half a chord across."""
    points, _ = touch(cylinder(np.array([0, 0, 0.1]), Z, 0.2, 0.05), cylinder(np.array([0.03, 0, 0.3]), Z, 0.2, 0.05))
    inscribed = 0.05 * (1 - math.cos(math.pi / DISK_CORNERS))
    assert extent(points)[0] == pytest.approx(0.07, abs=2 * inscribed)
    assert extent(points)[1] == pytest.approx(2 * math.sqrt(0.05**2 - 0.015**2), abs=3 * inscribed)


def test_a_lying_cylinder_touches_along_a_line():
    lying = cylinder(np.array([0, 0, 0.05]), Y, 0.2, 0.05)
    points, normal = touch(block((1, 0.1, 0.1), (0, 0, -0.05)), lying)
    assert normal == pytest.approx(Z)
    assert extent(points) == pytest.approx([0, 0.1, 0], abs=EXACT)
    upper = cylinder(np.array([0.06, 0.1, 0.13]), Y, 0.2, 0.05)
    points, normal = touch(lying, upper)
    assert normal == pytest.approx([0.6, 0, 0.8])
    assert np.sort(points[:, 1]) == pytest.approx([0.0, 0.1], abs=EXACT)
    points, normal = touch(lying, cylinder(np.array([0.02, 0.03, 0.13]), X, 0.2, 0.03))
    assert (normal, points) == (pytest.approx(Z), pytest.approx(np.array([[0, 0.03, 0.1]]), abs=EXACT))


def test_a_lying_cylinder_touches_an_edge_along_and_across():
    edge = np.array([0.03, 0.0, 0.0])
    lying = cylinder(edge + 0.05 * np.array([0.6, 0, 0.8]), Y, 0.2, 0.05)
    points, normal = touch(block((0.1, 0.1, 0.1), (-0.02, 0, -0.05)), lying)
    assert normal == pytest.approx([0.6, 0, 0.8])
    assert extent(points) == pytest.approx([0, 0.1, 0], abs=EXACT)


def test_a_tilted_cylinder_stands_on_its_rim():
    """On a face in a point; on an edge the normal is perpendicular to the edge and to the rim's tangent."""
    tilt = math.radians(20)
    axis = np.array([math.sin(tilt), 0, math.cos(tilt)])
    lowest = -0.1 * axis + 0.05 * np.array([math.cos(tilt), 0, -math.sin(tilt)])
    points, normal = touch(block((1, 1, 0.1), (0, 0, -0.05)), cylinder(-lowest, axis, 0.2, 0.05))
    assert (normal, points) == (pytest.approx(Z), pytest.approx(np.zeros((1, 3)), abs=EXACT))
    # A bar of square section on its edge, along y, and a cylinder whose rim lies across this edge: the rim's tangent at
    # its lowest point is y too, so the bar along x touches it instead.
    ridge = np.array([[x, 0, 0] for x in (-1, 1)] + [[x, s * 0.05, -0.05] for x in (-1, 1) for s in (-1, 1)])
    points, normal = touch(polyhedron(ridge), cylinder(-lowest, axis, 0.2, 0.05))
    assert (normal, points) == (pytest.approx(Z), pytest.approx(np.zeros((1, 3)), abs=1e-8))


def test_a_sphere_touches_side_end_and_rim_of_a_cylinder():
    drum = cylinder(np.zeros(3), Z, 0.2, 0.05)
    for normal, at in (
        ((0.6, 0.8, 0.0), (0.03, 0.04, 0.02)),
        ((0.0, 0.0, 1.0), (0.01, 0.02, 0.1)),
        ((0.48, 0.64, 0.6), (0.03, 0.04, 0.1)),
    ):
        points, found = touch(drum, sphere(np.array(at) + 0.02 * np.array(normal), 0.02))
        assert found == pytest.approx(np.array(normal), abs=1e-7)
        assert points == pytest.approx(np.array([at]), abs=EXACT)


def test_overlap_gives_its_depth():
    with pytest.raises(OverlapError, match=r"overlap of 0\.001 m: move the bodies apart") as error:
        touch(cylinder(np.array([0, 0, 0.099]), Z, 0.2, 0.05), block((1, 1, 0.1), (0, 0, -0.05)))
    assert error.value.depth == pytest.approx(0.001)
    with pytest.raises(OverlapError, match=r"overlap of 0\.002 m"):
        touch(sphere(np.zeros(3), 0.05), sphere(np.array([0, 0, 0.098]), 0.05))


# -- against other code ------------------------------------------------------------------------------------------------


def test_boxes_as_polyhedra_have_the_patches_of_boxes():
    """For random boxes that touch, the general method gives the patch that the method of boxes gives."""
    random = np.random.default_rng(2201)
    compared = 0
    for _ in range(40):
        sizes = random.uniform(0.05, 0.2, (2, 3))
        yaw = random.uniform(0, math.pi)
        tip = random.choice([0.0, 0.4])
        turns = [
            (1.0, 0, 0, 0),
            (math.cos(tip / 2) * math.cos(yaw / 2), math.sin(tip / 2), 0, math.cos(tip / 2) * math.sin(yaw / 2)),
        ]
        turns[1] = tuple(np.array(turns[1]) / np.linalg.norm(turns[1]))
        boxes = Boxes.at(sizes, np.zeros((2, 3)), turns)
        shift = random.uniform(-0.8, 0.8, 2) * sizes[0, :2] / 2
        low = boxes.corners[1][:, 2].min()
        positions = [(0.0, 0.0, sizes[0, 2] / 2), (*shift, sizes[0, 2] - low)]
        bricks = [Brick(tuple(s), 1.0, tuple(p), tuple(t)) for s, p, t in zip(sizes, positions, turns, strict=True)]
        patch = [p for p in contact_patches(bricks) if p.first == 0]
        solids = [block(s, p, t) for s, p, t in zip(sizes, positions, turns, strict=True)]
        found = solids_touch(*solids, gap=1e-7, ridge_gap=RIDGE_GAP * 0.05, parallel=PLANNED.parallel)
        if not patch:
            assert found is None
            continue
        compared += 1
        assert found[1] == pytest.approx(patch[0].normal, abs=EXACT)
        ours, theirs = (np.unique(points.round(9), axis=0) for points in (found[0], patch[0].points))
        assert len(ours) == len(theirs)
        assert ours == pytest.approx(theirs, abs=2e-9)
    assert compared == 25


def distance_by_cones(first, second):
    """Distance of two solids: minimise |x - y| with each point as a core point plus a vector in ball or disk."""
    sizes = [len(first.core), len(second.core)]
    count = sum(sizes) + 6 + 1  # weights of vertices, two offsets, the distance
    columns = np.zeros((3, count))
    columns[:, : sizes[0]], columns[:, sizes[0] : sum(sizes)] = first.core.T, -second.core.T
    columns[:, -7:-4], columns[:, -4:-1] = np.eye(3), -np.eye(3)
    rows, right, cones = [], [], []
    sums = np.zeros((2, count))
    sums[0, : sizes[0]] = sums[1, sizes[0] : sum(sizes)] = 1.0
    rows.append(sums)
    right.append(np.ones(2))
    equalities = 2
    for index, solid in enumerate((first, second)):
        if solid.disk:
            row = np.zeros((1, count))
            row[0, -7 + 3 * index : -4 + 3 * index] = solid.axis
            rows.append(row)
            right.append(np.zeros(1))
            equalities += 1
    cones.append(clarabel.ZeroConeT(equalities))
    rows.append(-np.eye(count)[: sum(sizes)])
    right.append(np.zeros(sum(sizes)))
    cones.append(clarabel.NonnegativeConeT(sum(sizes)))
    for index, solid in enumerate((first, second)):
        part = np.zeros((4, count))
        part[1:, -7 + 3 * index : -7 + 3 * index + 3] = -np.eye(3)
        rows.append(part)
        right.append(np.array([solid.ball + solid.disk, 0, 0, 0]))
        cones.append(clarabel.SecondOrderConeT(4))
    rows.append(np.vstack([-np.eye(count)[-1:], -columns]))
    right.append(np.zeros(4))
    cones.append(clarabel.SecondOrderConeT(4))
    cost = np.zeros(count)
    cost[-1] = 1.0
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    solver = clarabel.DefaultSolver(
        csc_matrix((count, count)), cost, csc_matrix(np.vstack(rows)), np.concatenate(right), cones, settings
    )
    return float(solver.solve().obj_val)


def random_solid(random, kind):
    turn = random.normal(size=4)
    frame = rotation((turn / np.linalg.norm(turn))[None])[0]
    return {
        "polyhedron": lambda: polyhedron(random.normal(size=(9, 3)) * 0.5),
        "box": lambda: polyhedron(np.array(list(product((-0.5, 0.5), (-0.3, 0.3), (-0.2, 0.2)))) @ frame.T),
        "sphere": lambda: sphere(np.zeros(3), 0.4),
        "capsule": lambda: capsule(np.zeros(3), frame[0], 0.8, 0.2),
        "cylinder": lambda: cylinder(np.zeros(3), frame[0], 0.8, 0.3),
    }[kind]()


def moved(solid, shift):
    return type(solid)(solid.core + shift, solid.edges, solid.face_normals, solid.ball, solid.disk, solid.axis)


KINDS = ("polyhedron", "box", "sphere", "capsule", "cylinder")


@pytest.mark.parametrize("pair", [pair for pair in product(KINDS, KINDS) if pair[0] <= pair[1]])
def test_solids_that_a_conic_solver_brings_together_touch(pair):
    """The second solid moves along a line until the solver's distance is zero: there the patch is one point or more.

    The greatest gap over the candidates is the true one only if the solids neither overlap nor lie apart there; the
    gap along the normal is zero, and both solids lie on its two sides.
    """
    random = np.random.default_rng([2202, KINDS.index(pair[0]), KINDS.index(pair[1])])
    for _ in range(3):
        first, second = (random_solid(random, kind) for kind in pair)
        away = random.normal(size=3)
        away /= np.linalg.norm(away)
        low, high = 0.0, 6.0
        for _ in range(40):  # regula falsi would do; the distance is convex along the line
            far = high
            distance = distance_by_cones(first, moved(second, high * away))
            high -= max(distance, 0.0) * 0.999999
            if far - high < 1e-8:
                break
        low = high
        found = solids_touch(first, moved(second, low * away), gap=3e-6, ridge_gap=0.0, parallel=PLANNED.parallel)
        assert found is not None, (pair, low)
        points, normal = found
        second = moved(second, low * away)
        assert float(-first.support(normal[None])[0] - second.support(-normal[None])[0]) == pytest.approx(0, abs=3e-6)
        assert np.abs(points @ normal - first.support(normal[None])[0]).max() < 1e-5
