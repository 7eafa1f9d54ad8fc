"""Each scene's expectation, worked out again from the bricks that it builds."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from scenarios.geometry import Boxes
from scenarios.planks import LENGTH, THICKNESS
from scenarios.registry import build
from scenarios.scenes.card_house import RIDGE_GAP


def centre(bricks, axis=0):
    return sum(b.mass * b.position[axis] for b in bricks) / sum(b.mass for b in bricks)


def shared_length(*planks):
    """From where to where along x [m] flat planks overlap."""
    left = max(plank.position[0] - plank.size[0] / 2 for plank in planks)
    right = min(plank.position[0] + plank.size[0] / 2 for plank in planks)
    return left, right


def room_inside(tower):
    """Least distance [m], over all joints of a tower along x, from the centre of what lies above to the joint's end."""
    room = math.inf
    for index, (lower, upper) in enumerate(pairwise(tower), start=1):
        left, right = shared_length(lower, upper)
        above = centre(tower[index:])
        room = min(room, above - left, right - above)
    return room


# -- towers ----------------------------------------------------------------------------------------------------------


def test_plank_tower_stands_with_half_a_plank_to_spare():
    tower = build("plank_tower")
    assert room_inside(tower.bricks) == pytest.approx(LENGTH / 2)
    assert (tower.expectation.outcome, tower.levels) == ("stand", 26)


def test_the_papers_leaning_tower_falls_at_nine():
    tower = build("leaning_tower")
    assert room_inside(tower.bricks[:8]) == pytest.approx(3.44e-3, abs=1e-5)
    assert room_inside(tower.bricks[:9]) == pytest.approx(-3.44e-3, abs=1e-5)
    assert str(tower.expectation) == "falls at 9"


@settings(deadline=None)
@given(ratio=st.floats(1.2, 20), levels=st.integers(1, 25))
def test_a_leaning_tower_falls_where_its_centre_of_mass_leaves_the_edge(ratio, levels):
    scene = build("leaning_tower", ratio=ratio, levels=levels)
    stands = [n for n in range(1, levels + 1) if room_inside(scene.bricks[:n]) > 0]
    assume(scene.expectation.outcome != "study")
    assert stands == list(range(1, len(stands) + 1))
    assert scene.expectation.level == (len(stands) + 1 if len(stands) < levels else None)
    assert (scene.expectation.outcome == "stand") == (len(stands) == levels)


@settings(deadline=None)
@given(ratio=st.floats(1.2, 20), levels=st.integers(1, 25))
def test_towers_within_five_percent_of_the_limit_claim_no_answer(ratio, levels):
    scene = build("leaning_tower", ratio=ratio, levels=levels)
    assume(scene.expectation.outcome != "study")
    decisive = range(1, (scene.expectation.level or levels) + 1)
    assert min(abs(room_inside(scene.bricks[:n])) for n in decisive) > 0.0499 * LENGTH / 2


@pytest.mark.parametrize(
    ("ratio", "levels", "expected"),
    [(8.5, 8, "stands"), (8.5, 13, "falls at 9"), (9, 13, "study"), (3.5, 13, "falls at 4"), (30, 13, "stands")],
)
def test_leaning_towers_on_either_side_of_the_limit(ratio, levels, expected):
    assert str(build("leaning_tower", ratio=ratio, levels=levels).expectation) == expected


# -- four planks a level ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("gap", "shift", "joint"), [(2.0, 12.7e-3, 45.8e-3), (0.0, 11.7e-3, 46.8e-3)])
def test_each_side_of_the_four_stack_stands_alone(gap, shift, joint):
    """A side's planks shift by 12.7 mm left and right in turn: what lies above stays deep inside every joint."""
    scene = build("four_stack", gap=gap)
    for side in range(4):
        tower = scene.bricks[side::4]
        along, across = (1, 0) if side % 2 else (0, 1)
        assert {brick.level for brick in tower} == set(range(1, 31))
        assert np.ptp([brick.position[across] for brick in tower]) < 1e-15
        half_joint = (LENGTH - abs(tower[0].position[along] - tower[1].position[along])) / 2
        assert half_joint == pytest.approx(joint)
        for index in range(1, len(tower)):
            assert abs(centre(tower[index:], along)) < shift + 1e-5
    assert scene.expectation.outcome == "stand"


def test_every_plank_of_the_four_stack_bridges_a_joint():
    scene = build("four_stack", levels=3)
    for level in (1, 2):
        lower = Boxes.of([b for b in scene.bricks if b.level == level])
        upper = Boxes.of([b for b in scene.bricks if b.level == level + 1])
        apart = np.abs(upper.center[:, None, :2] - lower.center[None, :, :2])
        resting = (apart < upper.reach[:, None, :2] + lower.reach[None, :, :2]).all(axis=2)
        assert (resting.sum(axis=1) == 2).all()
        assert (resting.sum(axis=0) == 2).all()


# -- wall ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("courses", "width", "gap"), [(8, 3, 2), (30, 3, 2), (9, 6, 2), (4, 2, 2), (5, 2, 0), (8, 3, 0)]
)
def test_pressure_through_the_joints_middles_balances_the_wall(courses, width, gap):
    """Builds the forces from the top course down: two unknowns a whole plank, one a half, and none of them pulls."""
    scene = build("brick_wall", courses=courses, width=width, gap=gap)
    rows = [[b for b in scene.bricks if b.level == level] for level in range(1, courses + 1)]
    loads = {}  # by plank and joint's middle, as mass [kg]
    for lower, upper in reversed(list(pairwise(rows))):
        for brick in upper:
            x = brick.position[0]
            carriers = [b for b in lower if abs(x - b.position[0]) < (brick.size[0] + b.size[0]) / 2]
            joints = [sum(shared_length(brick, b)) / 2 for b in carriers]
            above = [(x, brick.mass)] + [(p, f) for (owner, p), f in loads.items() if owner == id(brick)]
            total, moment = sum(f for _, f in above), sum(f * (p - x) for p, f in above)
            if len(joints) == 1:
                assert moment == pytest.approx(0, abs=1e-12)  # straight above its support
                forces = [total]
            else:
                forces = np.linalg.solve([[1, 1], np.subtract(joints, x)], [total, moment])
            assert min(forces) > 0
            for carrier, joint, force in zip(carriers, joints, forces, strict=True):
                loads[id(carrier), joint] = force
    assert scene.expectation.outcome == "stand"


def test_a_wall_is_flush_and_every_joint_is_bridged():
    scene = build("brick_wall")
    for level in range(1, 9):
        course = [b for b in scene.bricks if b.level == level]
        ends = [shared_length(b) for b in course]
        assert (ends[0][0], ends[-1][1]) == pytest.approx((-0.1775, 0.1775))
        assert len(course) == (3 if level % 2 else 4)


# -- card house ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("theta", [62, 70, 72, 75, 80])
def test_a_lone_v_needs_half_of_cot_theta_less_thickness_over_length(theta):
    """Moments about the foot, from the corners of the planks as built; the ridge's force is horizontal."""
    plank = build("card_house", theta=theta).bricks[0]
    corners = Boxes.of([plank]).corners[0]
    foot, ridge = corners[corners[:, 2].argmin()], corners[corners[:, 0].argmax()]
    push_over_weight = (plank.position[0] - foot[0]) / (ridge[2] - foot[2])
    angle = math.radians(theta)
    assert foot[2] == pytest.approx(0, abs=1e-15)
    assert push_over_weight == pytest.approx((1 / math.tan(angle) - THICKNESS / LENGTH) / 2)
    assert ridge[0] == pytest.approx(-RIDGE_GAP / 2)


@pytest.mark.parametrize(("theta", "ideal", "face"), [(70, 0.149, 0.364), (75, 0.101, 0.268)])
def test_an_answer_is_claimed_only_where_both_ridge_normals_agree(theta, ideal, face):
    """Least friction of a V with a horizontal force at the ridge, and with a plank's face as the normal there."""
    outcomes = [
        build("card_house", theta=theta, friction=mu).expectation.outcome
        for mu in (0.9 * ideal, 1.01 * ideal, 0.99 * face, 1.1 * face)
    ]
    assert outcomes == ["fall", "study", "study", "stand"]


@pytest.mark.parametrize("storeys", [1, 2, 3])
def test_standard_card_houses_stand(storeys):
    scene = build("card_house", storeys=storeys)
    assert scene.expectation.outcome == "stand"
    assert scene.levels == 2 * storeys - 1
    assert len(scene.bricks) == {1: 2, 2: 7, 3: 15}[storeys]


def test_a_v_on_too_little_friction_falls_at_once():
    assert str(build("card_house", storeys=2, friction=0.1).expectation) == "falls at 1"


@pytest.mark.parametrize("theta", [70, 72, 78, 85])
def test_roofs_cover_the_edges_that_carry_them_and_feet_stand_inside_roofs(theta):
    """With more to spare than two laid in error, each by 0.9 mm."""
    scene = build("card_house", storeys=3, theta=theta)
    for level in (2, 4):
        roofs = [b for b in scene.bricks if b.level == level]
        ridges, standing = (Boxes.of([b for b in scene.bricks if b.level == k]).corners for k in (level - 1, level + 1))
        reach = [(b.position[0] - LENGTH / 2 + 1.8e-3, b.position[0] + LENGTH / 2 - 1.8e-3) for b in roofs]
        tops = ridges[ridges[..., 2] > ridges[..., 2].max() - 1e-9][:, 0]
        feet = standing[standing[..., 2] < standing[..., 2].min() + 1e-9][:, 0]
        for x in (*tops, *feet):
            assert sum(left < x < right for left, right in reach) == 1
        for left, right in reach:
            carriers = [x for x in tops if left < x < right]
            assert min(carriers) < (left + right) / 2 < max(carriers)  # it does not tip before its load comes
            assert all(min(carriers) < x < max(carriers) for x in feet if left < x < right)


def test_both_sides_of_a_card_house_load_a_v_alike():
    """From the first roof on, what comes together is its own mirror image."""
    scene = build("card_house", storeys=3)
    for action in scene.actions[3:]:
        xs = sorted(b.position[0] for b in action.bricks)
        assert xs == pytest.approx([-x for x in reversed(xs)], abs=1e-12)
