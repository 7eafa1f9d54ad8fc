"""Scenes for the systems of the related work: geometry and known answers, worked out apart from the builders."""

import math

import numpy as np
import pytest

from scenarios.geometry import Boxes, height_above_ground, rotation, vertical_clearance
from scenarios.model import Place, Push, Remove
from scenarios.planks import LENGTH
from scenarios.registry import build

# -- growing column ----------------------------------------------------------------------------------------------------


def offsets_of_centres(cubes):
    """How far [half edges] the centre of mass of all above each joint lies from the middle of the cube below it."""
    x = np.array([cube.position[0] for cube in cubes])
    mass = np.array([cube.mass for cube in cubes])
    return [(mass[k:] @ x[k:] / mass[k:].sum() - x[k - 1]) / (cubes[k - 1].size[0] / 2) for k in range(1, len(cubes))]


@pytest.mark.parametrize(("levels", "ratio"), [(2, 1.0), (5, 2.0), (20, 1.0), (6, 8.0)])
@pytest.mark.parametrize("aside", [0.7, 1.3])
def test_a_growing_column_tips_at_its_weakest_joint(levels, ratio, aside):
    scene = build("growing_column", levels=levels, ratio=ratio, aside=aside)
    assert max(offsets_of_centres(scene.bricks)) == pytest.approx(aside)
    assert scene.expectation.outcome == ("stand" if aside < 1 else "fall")
    masses = [cube.mass for cube in scene.bricks]
    assert np.array(masses[1:]) / masses[:-1] == pytest.approx(ratio)


def test_a_growing_column_stands_face_on_face():
    cubes = build("growing_column", levels=6, ratio=3.0).bricks
    tops = [cube.position[2] + cube.size[2] / 2 for cube in cubes]
    bottoms = [cube.position[2] - cube.size[2] / 2 for cube in cubes]
    assert bottoms == pytest.approx([0.0, *tops[:-1]])


# -- incline along a diagonal ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("heading", "turn"), [(45.0, 0.0), (0.0, 45.0), (30.0, 20.0)])
def test_a_turned_incline_lies_flat_on_its_ramp_and_rises_along_its_heading(heading, turn):
    scene = build("incline", theta=25.0, heading=heading, turn=turn)
    _, slab, tile = scene.bricks
    upward = rotation(np.array([slab.quaternion]))[0][:, 2]
    assert rotation(np.array([tile.quaternion]))[0][:, 2] == pytest.approx(upward, abs=1e-12)
    assert math.degrees(math.acos(upward[2])) == pytest.approx(25.0)
    assert math.degrees(math.atan2(-upward[1], -upward[0])) == pytest.approx(heading)
    apart = (np.array(tile.position) - slab.position) @ upward
    assert apart == pytest.approx((slab.size[2] + tile.size[2]) / 2)
    along_tile, along_slab = (rotation(np.array([one.quaternion]))[0][:, 0] for one in (tile, slab))
    assert math.degrees(math.acos(along_tile @ along_slab)) == pytest.approx(turn, abs=1e-6)
    assert not scene.planar


# -- thin cards --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("slenderness", "friction", "storeys"), [(88.0, 0.8, 2), (200.0, 0.7, 5)])
def test_houses_of_thin_cards_stand_at_the_angle_of_published_ones(slenderness, friction, storeys):
    """65 deg: cot(65 deg) = 0.466 is enough friction for either normal at a ridge."""
    scene = build("card_house", storeys=storeys, theta=65.0, friction=friction, slenderness=slenderness)
    assert {round(max(brick.size) / min(brick.size)) for brick in scene.bricks if max(brick.size) == LENGTH} == {
        round(slenderness)
    }
    assert scene.expectation.outcome == "stand"
    assert build("card_house", theta=65.0, friction=0.2, slenderness=slenderness).expectation.level == 1


# -- pouring -----------------------------------------------------------------------------------------------------------


def test_bricks_poured_along_a_line_spread_along_it_alone():
    """Uniform over 10 brick lengths of 39 mm, and 29 mm about the line: the deviations are 116 and 29 mm."""
    x, y, _ = np.array([brick.position for brick in build("poured_pile", bricks=300, line=10.0).bricks]).T
    assert x.std() == pytest.approx(0.39 / math.sqrt(12), rel=0.15)
    assert y.std() == pytest.approx(LENGTH / 4, rel=0.15)


def test_the_pace_of_a_pour_changes_its_times_alone():
    slow, fast = (build("poured_pile", bricks=9, pace=pace) for pace in (1.0, 16.0))
    assert slow.bricks == fast.bricks
    assert [action.time for action in fast.actions] == pytest.approx(np.arange(9) / 16)


# -- mould -------------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def struck():
    return build("mould", bricks=40, strike=2.0)


def test_the_walls_of_a_mould_come_first_and_leave_together(struck):
    walls = struck.actions[0]
    assert isinstance(walls, Place)
    assert len(walls.bricks) == 4
    removals = [action for action in struck.actions if isinstance(action, Remove)]
    assert {action.brick for action in removals} == {0, 1, 2, 3}
    assert len({action.time for action in removals}) == 1
    last = max(action.time for action in struck.actions if isinstance(action, Place))
    assert removals[0].time == last + 5.0


def test_a_strike_gives_a_brick_inside_the_block_the_speed_after_the_walls_are_gone(struck):
    push = struck.actions[-1]
    assert isinstance(push, Push)
    assert push.impulse[0] / struck.bricks[push.brick].mass == pytest.approx(2.0)
    assert 4 <= push.brick < len(struck.bricks)
    assert not any(isinstance(action, Push) for action in build("mould", bricks=40).actions)


def test_bricks_of_a_mould_fall_between_its_walls_without_touching_them(struck):
    """No two walls overlap, and every brick, however it is turned, keeps clear of the walls."""
    boxes = Boxes.of(struck.bricks)
    walls, poured = Boxes(boxes.center[:4], boxes.half_axes[:4]), Boxes(boxes.center[4:], boxes.half_axes[4:])
    inside = np.abs(boxes.center[:4, :2]).max() - 0.015
    assert (np.abs(poured.center[:, :2]) + poured.reach[:, :2]).max() < inside
    low, high = walls.center - walls.reach, walls.center + walls.reach
    for i in range(4):
        for j in range(i):
            gap = np.maximum(low[i] - high[j], low[j] - high[i])
            assert gap.max() > 0.9e-3
    assert height_above_ground(walls) == pytest.approx(np.zeros(4), abs=1e-12)
    for n in range(1, len(poured)):
        one, before = (Boxes(poured.center[at], poured.half_axes[at]) for at in ([n], slice(n)))
        assert min(vertical_clearance(one, before).min(), height_above_ground(one)[0]) == pytest.approx(0, abs=1e-12)
