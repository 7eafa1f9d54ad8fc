"""Where ideal boxes touch: hand-worked patches of each kind."""

import math

import numpy as np
import pytest

from scenarios.model import Brick
from scenarios.planks import GAP, LENGTH, THICKNESS, WIDTH, lay, lean
from scenarios.statics.contact_patch import GROUND, RIDGE_GAP, TOUCH, contact_patches

EXACT = 1e-12  # m


def between(patches, first, second):
    found = [patch for patch in patches if (patch.first, patch.second) == (first, second)]
    assert len(found) <= 1
    return found[0] if found else None


def extent(points):
    return points.max(axis=0) - points.min(axis=0)


def cube(position, edge=0.1, quaternion=(1.0, 0.0, 0.0, 0.0)):
    return Brick((edge, edge, edge), 1.0, position, quaternion)


def test_a_plank_lies_on_the_ground_with_its_whole_face():
    (patch,) = contact_patches([lay(0.0, level=1, yaw=0.3)])
    assert (patch.first, patch.second) == (GROUND, 0)
    assert len(patch.points) == 4
    assert patch.normal.tolist() == [0, 0, 1]


def test_planks_share_the_overlap_of_their_faces():
    patch = between(contact_patches([lay(0.0, level=1), lay(0.05, 0.01, level=2)]), 0, 1)
    assert extent(patch.points) == pytest.approx([LENGTH - 0.05, WIDTH - 0.01, 0], abs=EXACT)
    assert patch.points.mean(axis=0) == pytest.approx([0.025, 0.005, THICKNESS], abs=EXACT)
    assert patch.normal == pytest.approx([0, 0, 1])


def test_crossed_planks_share_a_square():
    patch = between(contact_patches([lay(0.0, level=1), lay(0.0, level=2, yaw=math.pi / 2)]), 0, 1)
    assert extent(patch.points) == pytest.approx([WIDTH, WIDTH, 0], abs=EXACT)


def test_a_turned_face_is_clipped_to_an_octagon():
    """Two equal squares, one turned by 45 deg: eight corners, at edge / (2 cos 22.5 deg) from the middle."""
    turned = cube((0, 0, 0.15), quaternion=(math.cos(math.pi / 8), 0, 0, math.sin(math.pi / 8)))
    points = between(contact_patches([cube((0, 0, 0.05)), turned]), 0, 1).points
    corners = np.unique(points.round(9), axis=0)
    assert len(corners) == 8
    assert np.linalg.norm(corners[:, :2], axis=1) == pytest.approx(0.05 / math.cos(math.pi / 8))


def test_neighbours_with_the_plans_gap_do_not_touch_and_flush_ones_do():
    apart, flush = (lay(LENGTH + gap, level=1) for gap in (GAP, 0.0))
    assert between(contact_patches([lay(0.0, level=1), apart]), 0, 1) is None
    patch = between(contact_patches([lay(0.0, level=1), flush]), 0, 1)
    assert patch.normal == pytest.approx([1, 0, 0])
    assert extent(patch.points) == pytest.approx([0, WIDTH, THICKNESS], abs=EXACT)


def test_planks_that_meet_in_an_edge_only_graze():
    """Shifted by its whole length, a plank has lost its support: there is no area left."""
    assert between(contact_patches([lay(0.0, level=1), lay(LENGTH, level=2)]), 0, 1) is None


def test_a_leaning_plank_stands_on_its_edge():
    (patch,) = contact_patches([lean(0.03, theta=1.2, toward=1, level=1)])
    assert patch.points[:, 0] == pytest.approx([0.03, 0.03], abs=EXACT)
    assert extent(patch.points) == pytest.approx([0, WIDTH, 0], abs=EXACT)


def test_a_roof_on_an_edge_takes_the_roofs_normal():
    theta = 1.2
    plank = lean(0.0, theta=theta, toward=1, level=1)
    top = LENGTH * math.sin(theta) + THICKNESS * math.cos(theta)
    patch = between(contact_patches([plank, lay(0.03, level=2, bottom=top)]), 0, 1)
    assert patch.normal == pytest.approx([0, 0, 1])
    assert extent(patch.points) == pytest.approx([0, WIDTH, 0], abs=EXACT)


def test_a_plank_over_a_blocks_edge_takes_the_planks_normal():
    """The plank's lower face passes through the block's upper edge, whichever is named first."""
    theta, height = 0.5, 0.03
    plank = lean(0.0, theta=theta, toward=1, level=1)
    foot_to_edge = height / math.tan(theta)
    block = Brick((0.04, 0.01, height), 0.1, (foot_to_edge + 0.02, 0.0, height / 2))
    for bricks, sign in (([block, plank], 1), ([plank, block], -1)):
        patch = between(contact_patches(bricks), 0, 1)
        assert patch.normal == pytest.approx([-sign * math.sin(theta), 0, sign * math.cos(theta)])
        assert extent(patch.points) == pytest.approx([0, 0.01, 0], abs=EXACT)
        assert patch.points[:, 0] == pytest.approx([foot_to_edge] * len(patch.points))


def test_a_corner_stands_on_a_face_in_a_point():
    """A cube whose diagonal is upright: the turn by atan(sqrt 2) about (1, -1, 0) takes (1, 1, 1) to z."""
    half = math.atan(math.sqrt(2)) / 2
    tip = (math.cos(half), math.sin(half) / math.sqrt(2), -math.sin(half) / math.sqrt(2), 0.0)
    table = cube((0, 0, 0.05))
    patch = between(contact_patches([table, cube((0.01, 0.0, 0.1 + 0.05 * math.sqrt(3)), quaternion=tip)]), 0, 1)
    assert patch.points == pytest.approx(np.array([[0.01, 0.0, 0.1]]))
    assert patch.normal == pytest.approx([0, 0, 1])


def test_crossing_edges_touch_in_a_point():
    """Two bars, each turned by 45 deg about its own length, lie across each other."""
    c, s, diagonal = math.cos(math.pi / 8), math.sin(math.pi / 8), 0.01 * math.sqrt(2)
    lower = Brick((0.1, 0.01, 0.01), 1.0, (0, 0, diagonal / 2), (c, s, 0, 0))
    upper = Brick((0.01, 0.1, 0.01), 1.0, (0.02, 0.03, 3 * diagonal / 2), (c, 0, s, 0))
    patch = between(contact_patches([lower, upper]), 0, 1)
    assert patch.points == pytest.approx(np.array([[0.02, 0.0, diagonal]]))
    assert patch.normal == pytest.approx([0, 0, 1])


@pytest.mark.parametrize("gap", [0.0, 0.2e-3])
def test_the_ridges_normal_is_a_convention(gap):
    theta = 1.2
    spread = LENGTH * math.cos(theta) + gap / 2
    pair = [lean(-spread, theta=theta, toward=1, level=1), lean(spread, theta=theta, toward=-1, level=1)]
    bisector = between(contact_patches(pair, ridge="bisector"), 0, 1)
    face = between(contact_patches(pair, ridge="face"), 0, 1)
    assert bisector.normal == pytest.approx([1, 0, 0])
    assert face.normal == pytest.approx([math.sin(theta), 0, -math.cos(theta)])
    for patch in (bisector, face):
        assert patch.points.mean(axis=0) == pytest.approx([0, 0, LENGTH * math.sin(theta)])
        assert extent(patch.points) == pytest.approx([0, WIDTH, 0], abs=EXACT)


def test_a_ridge_wider_than_a_hair_is_open():
    theta = 1.2
    spread = LENGTH * math.cos(theta) + 0.51 * RIDGE_GAP * THICKNESS
    pair = [lean(-spread, theta=theta, toward=1, level=1), lean(spread, theta=theta, toward=-1, level=1)]
    assert between(contact_patches(pair), 0, 1) is None


def test_walls_stand_for_the_ground():
    wall = cube((0.1, 0, 0.05))
    patches = contact_patches([cube((0, 0, 0.05))], [wall])
    assert sorted((p.first, p.second, *p.normal.round(9)) for p in patches) == [
        (GROUND, 0, -1, 0, 0),
        (GROUND, 0, 0, 0, 1),
    ]


@pytest.mark.parametrize("scale", [0.07, 1.0, 70.0])
def test_touching_is_free_of_scale(scale):
    pair = [cube((0, 0, 0.05 * scale), 0.1 * scale), cube((0, 0, scale * (0.15 + 0.05 * TOUCH)), 0.1 * scale)]
    assert between(contact_patches(pair), 0, 1) is not None


def test_bricks_must_not_overlap():
    with pytest.raises(ValueError, match=r"brick 0 and brick 1: .* got an overlap of 0\.0001 m"):
        contact_patches([cube((0, 0, 0.05)), cube((0, 0, 0.1499))])
    with pytest.raises(ValueError, match=r"brick 0 and wall 0: .* must not overlap"):
        contact_patches([cube((0, 0, 0.05))], [cube((0.09, 0, 0.05))])
    with pytest.raises(ValueError, match=r"brick 0 must lie .* 0\.01 m below the ground"):
        contact_patches([cube((0, 0, 0.04))])
