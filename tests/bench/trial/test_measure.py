"""Is it still standing? Every limit is tried just inside and just outside, on cases worked by hand."""

import math

import numpy as np
import pytest

from bench.trial import measure
from bench.trial.measure import Plan
from scenarios.planks import THICKNESS, box, lay, lean
from scenarios.statics import falling

TOWER = [lay(0.0, level=level) for level in (1, 2, 3)]
PLAN = Plan.of(TOWER)


def turned(degrees: float, axis: tuple[float, float, float]) -> np.ndarray:
    half = math.radians(degrees) / 2
    return np.array([math.cos(half), *(math.sin(half) * np.array(axis))])


def with_row(array: np.ndarray, row: int, value: np.ndarray) -> np.ndarray:
    changed = array.copy()
    changed[row] = value
    return changed


def test_a_tower_as_planned_is_intact() -> None:
    assert measure.intact(PLAN, PLAN.position, PLAN.quaternion)
    assert measure.faults(PLAN, PLAN.position, PLAN.quaternion).kind is None


@pytest.mark.parametrize("axis", [(1, 0, 0), (0, 1, 0), (0.6, 0.8, 0)])
def test_a_brick_topples_at_15_degrees(axis: tuple[float, float, float]) -> None:
    def kind(degrees: float) -> str | None:
        return measure.faults(PLAN, PLAN.position, with_row(PLAN.quaternion, 1, turned(degrees, axis))).kind

    assert kind(14.9) is None
    assert kind(15.1) == "topple"


def test_yaw_is_no_tilt() -> None:
    yawed = with_row(PLAN.quaternion, 1, turned(80, (0, 0, 1)))
    assert measure.tilt(PLAN, yawed) == pytest.approx(0, abs=1e-7)  # arcsin of a rounding error


def test_tilt_of_a_leaning_plank_is_measured_from_its_plan_and_either_sign_of_its_quaternion() -> None:
    plank = lean(0.0, theta=math.radians(72), toward=1, level=1)
    slipped = lean(0.0, theta=math.radians(60), toward=1, level=1)
    for sign in (1, -1):
        actual = sign * np.array([slipped.quaternion])
        assert np.degrees(measure.tilt(Plan.of([plank]), actual)) == pytest.approx([12.0])


def test_a_brick_slides_at_a_thickness_sideways_in_any_direction() -> None:
    for direction in ((1, 0, 0), (0, 1, 0), (0.6, -0.8, 0)):
        for share, kind in ((0.99, None), (1.01, "slide")):
            moved = PLAN.position + share * THICKNESS * np.array(direction)
            assert measure.faults(PLAN, moved, PLAN.quaternion).kind == kind


def test_sink_is_measured_between_neighbouring_levels() -> None:
    """Three levels that sink by 0.4 thicknesses each lie 1.2 below their plan at the top, and none has sunk in."""
    steps = -0.4 * THICKNESS * np.array([1, 2, 3])
    spread = PLAN.position + np.column_stack([np.zeros(3), np.zeros(3), steps])
    assert measure.relative_sink(PLAN, spread) == pytest.approx(0.4 * THICKNESS)
    assert measure.intact(PLAN, spread, PLAN.quaternion)

    into_the_second = PLAN.position + np.array([[0, 0, 0], [0, 0, 0], [0, 0, -0.51 * THICKNESS]])
    faults = measure.faults(PLAN, into_the_second, PLAN.quaternion)
    assert faults.kind == "sink"
    assert faults.any.tolist() == [False, False, True]


def test_the_first_level_sinks_into_the_ground() -> None:
    sunk = PLAN.position - [0, 0, 0.51 * THICKNESS]
    assert measure.faults(PLAN, sunk, PLAN.quaternion).sink.tolist() == [True, False, False]


def test_a_tower_that_leans_as_one_has_not_sunk() -> None:
    """Two piers under a deck, turned by 8 degrees: one pier drops by 7 mm, which is a lean and not a sink."""
    piers = Plan.of([lay(-0.05, level=1), lay(0.05, level=1), lay(0.0, level=2)])
    angle = math.radians(8)
    cos, sin = math.cos(angle), math.sin(angle)
    turn = np.array([[cos, 0, sin], [0, 1, 0], [-sin, 0, cos]])
    assert not measure.faults(piers, piers.position @ turn.T, piers.quaternion).sink.any()


def test_a_removed_level_leaves_the_next_to_be_compared_with_what_is_left() -> None:
    rest = Plan.of([TOWER[0], TOWER[2]])
    assert measure.relative_sink(rest, rest.position - [0, 0, 1e-3]) == pytest.approx([1e-3, 0])


def test_levels_stand_up_to_the_first_that_is_out_of_place() -> None:
    out = np.array([False, True, False])
    assert measure.levels_standing(PLAN, out, landed=(1, 2, 3)) == 1
    assert measure.levels_standing(PLAN, np.zeros(3, bool), landed=(1, 2)) == 2  # the third has not landed yet
    assert measure.levels_standing(PLAN, np.array([True, False, False]), landed=(1, 2, 3)) == 0


def test_top_of_a_leaning_plank_is_its_highest_corner() -> None:
    plank = lean(0.0, theta=math.radians(72), toward=1, level=1)
    length, _, thickness = plank.size
    highest = length * math.sin(math.radians(72)) + thickness * math.cos(math.radians(72))
    plan = Plan.of([plank])
    assert measure.top(plan, plan.position, plan.quaternion, 1) == pytest.approx(highest)


def test_sink_of_a_level_is_the_mean_over_its_bricks() -> None:
    pair = Plan.of([lay(-0.07, level=1), lay(0.07, level=1)])
    assert measure.sink(pair, pair.position - [[0, 0, 1e-3], [0, 0, 3e-3]], 1) == pytest.approx(2e-3)


def test_the_fastest_mean_motion_is_that_of_the_brick_that_moved_farthest() -> None:
    after = PLAN.position + np.array([[0, 0, 0], [3e-3, 0, -4e-3], [1e-3, 0, 0]])
    assert measure.fastest(PLAN.position, after, 5.0) == pytest.approx(1e-3)


def test_the_limits_are_those_that_the_time_of_a_fall_is_worked_out_for() -> None:
    """A tower of 39 mm cubes: limits are shares of a brick's least edge, so that they grow with the bricks."""
    assert (measure.TILT_LIMIT, measure.SLIDE_LIMIT) == (falling.TILT_LIMIT, falling.SLIDE_LIMIT)
    for size in (1.0, 3.0):
        cubes = Plan.of([box((0.039 * size,) * 3, 0.0, level=n, bottom=0.039 * size * (n - 1)) for n in (1, 2)])
        for share, kind in ((0.99, None), (1.01, "slide")):
            moved = cubes.position + np.array([[0.0, 0.0, 0.0], [share * 0.039 * size, 0.0, 0.0]])
            assert measure.faults(cubes, moved, cubes.quaternion).kind == kind
        for share, kind in ((0.49, None), (0.51, "sink")):
            moved = cubes.position - np.array([[0.0, 0.0, 0.0], [0.0, 0.0, share * 0.039 * size]])
            assert measure.faults(cubes, moved, cubes.quaternion).kind == kind
