"""Clearances between boxes, against brute force over all corners and edge crossings."""

from itertools import combinations, product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from scenarios.geometry import (
    Boxes,
    height_above_ground,
    overlap_in_plan,
    resting_shift,
    room_above_fixed,
    side_by_side,
    vertical_clearance,
)
from scenarios.model import CLEARANCE
from scenarios.planks import LENGTH, THICKNESS, WIDTH, box, lay, lean

EXACT = 1e-9  # m; rounding over slopes as steep as the strategies draw them
EDGES = np.array([(a, b) for a, b in combinations(range(8), 2) if (a ^ b).bit_count() == 1])  # corners of each edge

lengths = st.floats(0.005, 0.12)
boxes = st.builds(
    lambda size, position, turn: Boxes.at([size], [position], [turn / np.linalg.norm(turn)]),
    st.tuples(lengths, lengths, lengths),
    arrays(float, 3, elements=st.floats(-0.06, 0.06)),
    # Whole numbers make boxes level or well tilted: the oracle divides by slopes; hairs of tilt have their own test.
    arrays(float, 4, elements=st.integers(-5, 5)).filter(np.any),
)


def raised(box, dz):
    return Boxes(box.center + np.array([0.0, 0.0, dz]), box.half_axes)


def span(box, points):
    """Lowest and highest z of a box over plan points (n, 2), by the slab method; NaN where a point misses it."""
    half = np.linalg.norm(box.half_axes[0], axis=1)
    axes = box.half_axes[0] / half[:, None]
    start = np.column_stack([points, np.zeros(len(points))]) - box.center[0]
    along, slope = start @ axes.T, axes[:, 2]
    with np.errstate(divide="ignore", invalid="ignore"):
        first, second = (-half - along) / slope, (half - along) / slope
    flat = np.abs(slope) < 1e-12
    outside = (flat & (np.abs(along) > half + 1e-12)).any(axis=1)
    low = np.where(flat, -np.inf, np.minimum(first, second)).max(axis=1)
    high = np.where(flat, np.inf, np.maximum(first, second)).min(axis=1)
    missed = outside | (low > high + 1e-12)
    return np.where(missed, np.nan, low), np.where(missed, np.nan, high)


def crossings(upper, lower):
    """Plan points in which edges of the two boxes cross, seen from above."""
    p, r = upper.corners[0, EDGES[:, 0], None, :2], np.diff(upper.corners[0, EDGES, :2], axis=1)
    q, s = lower.corners[0, EDGES[:, 0], :2][None], np.swapaxes(np.diff(lower.corners[0, EDGES, :2], axis=1), 0, 1)
    turn = r[..., 0] * s[..., 1] - r[..., 1] * s[..., 0]
    parallel = np.abs(turn) < 1e-12
    t = ((q - p)[..., 0] * s[..., 1] - (q - p)[..., 1] * s[..., 0]) / np.where(parallel, np.inf, turn)
    return (p + t[..., None] * r)[~parallel & (t >= 0) & (t <= 1)]


def brute_force(upper, lower):
    points = np.concatenate([upper.corners[0, :, :2], lower.corners[0, :, :2], crossings(upper, lower)])
    between = span(upper, points)[0] - span(lower, points)[1]
    return np.inf if np.isnan(between).all() else np.nanmin(between)


def assert_touch_in_plan(upper, lower):
    """Where rounding decides: a little smaller they are apart, a little larger they overlap."""
    smaller, larger = (Boxes(upper.center, upper.half_axes * (1 + sign * 1e-6)) for sign in (-1, 1))
    assert not overlap_in_plan(smaller, lower).any()
    assert overlap_in_plan(larger, lower).all()


@settings(max_examples=150, deadline=None)
@given(boxes, boxes)
def test_clearance_is_the_least_gap_over_corners_and_edge_crossings(upper, lower):
    exact, expected = vertical_clearance(upper, lower)[0, 0], brute_force(upper, lower)
    if np.isfinite(exact) == np.isfinite(expected):
        assert exact == pytest.approx(expected, abs=EXACT)
    else:
        assert_touch_in_plan(upper, lower)


@settings(max_examples=60, deadline=None)
@given(boxes, boxes)
def test_no_sampled_point_is_closer_than_the_clearance(upper, lower):
    x, y = upper.center[0, :2]
    wide, deep = upper.reach[0, :2]
    grid = np.array([(x + i * wide, y + j * deep) for i, j in product(np.linspace(-1, 1, 31), repeat=2)])
    between = span(upper, grid)[0] - span(lower, grid)[1]
    if not np.isnan(between).all():
        clearance = vertical_clearance(upper, lower)[0, 0]
        if np.isfinite(clearance):
            assert np.nanmin(between) >= clearance - EXACT
        else:  # a row of points may lie on an edge that both share in plan
            assert_touch_in_plan(upper, lower)


@settings(max_examples=60, deadline=None)
@given(boxes, boxes, st.floats(-0.1, 0.1))
def test_raising_a_box_adds_to_its_clearance(upper, lower, dz):
    before, after = vertical_clearance(upper, lower), vertical_clearance(raised(upper, dz), lower)
    assert after == pytest.approx(before + dz, abs=EXACT)


@settings(max_examples=60, deadline=None)
@given(boxes)
def test_height_above_ground_is_that_of_the_lowest_corner(box):
    assert height_above_ground(box)[0] == pytest.approx(box.corners[0, :, 2].min(), abs=EXACT)


@settings(max_examples=60, deadline=None)
@given(boxes, boxes)
def test_seen_from_above_overlap_is_mutual(first, second):
    assert overlap_in_plan(first, second)[0, 0] == overlap_in_plan(second, first)[0, 0]


def test_flat_on_flat_is_the_gap_between_faces():
    lower, upper = Boxes.of([lay(0.0, level=1)]), Boxes.of([lay(0.03, 0.01, yaw=0.7, level=4)])
    assert vertical_clearance(upper, lower)[0, 0] == pytest.approx(2 * THICKNESS, abs=1e-15)


def test_flush_neighbours_do_not_overlap():
    left, right = Boxes.of([lay(0.0, level=1)]), Boxes.of([lay(LENGTH, level=1)])
    assert not overlap_in_plan(left, right).any()


def test_crossing_tilted_edges_meet_between_their_corners():
    # Two long bars, turned 45 deg about their own length, cross at right angles: edge meets edge, over the middle.
    diagonal, quarter = 0.01 * np.sqrt(2) / 2, np.pi / 8
    lower = Boxes.at([(0.1, 0.01, 0.01)], [(0, 0, 0)], [(np.cos(quarter), np.sin(quarter), 0, 0)])
    upper = Boxes.at([(0.01, 0.1, 0.01)], [(0, 0, 0.05)], [(np.cos(quarter), 0, np.sin(quarter), 0)])
    assert vertical_clearance(upper, lower)[0, 0] == pytest.approx(0.05 - 2 * diagonal, abs=1e-15)


def test_a_hair_of_tilt_changes_the_clearance_by_a_hair():
    """Poses read from an engine are never exactly flat: nearly parallel axes must not lose precision."""
    for tilt in (1e-3, 1e-6, 1e-9, 1e-12, 1e-15):
        lower = Boxes.at([(0.117, 0.0234, 0.0078)], [(0, 0, 0)], [(1, tilt / 2, tilt / 3, tilt / 5)])
        upper = Boxes.of([lay(0.02, 0.001, level=3)])
        flat = upper.center[0, 2] - THICKNESS
        assert vertical_clearance(upper, lower)[0, 0] == pytest.approx(flat, abs=0.12 * tilt + 1e-12)


def test_a_group_hangs_above_the_first_support_that_it_meets():
    below = Boxes.of([lay(0.0, level=1), lay(0.2, level=2)])
    group = Boxes.of([lay(0.0, level=5), lay(0.2, level=5)])
    hung = raised(group, resting_shift(group, below))
    assert vertical_clearance(hung, below).min() == pytest.approx(CLEARANCE, abs=1e-15)
    assert hung.center[0, 2] - hung.center[1, 2] == 0


def test_without_support_a_group_hangs_above_the_ground():
    pair = Boxes.of([lean(-0.04, theta=1.2, toward=1, level=1), lean(0.04, theta=1.2, toward=-1, level=1)])
    nothing = Boxes.of([])
    hung = raised(pair, resting_shift(pair, nothing))
    assert height_above_ground(hung) == pytest.approx([CLEARANCE, CLEARANCE], abs=1e-15)


def test_a_group_planned_inside_its_support_is_raised_out_of_it():
    below = Boxes.of([lay(0.0, level=3)])
    sunk = Boxes.of([lay(0.0, level=3)])
    assert resting_shift(sunk, below) == pytest.approx(THICKNESS + CLEARANCE, abs=1e-15)


# -- neighbours and fixed boxes ----------------------------------------------------------------------------------------

PLANK = Boxes.of([lay(0.0, level=2)])  # its lower face is one thickness above the ground


@pytest.mark.parametrize(
    ("other", "expected"),
    [
        (lay(LENGTH, level=2), True),
        (lay(LENGTH + 2e-3, level=2), True),
        (box((0.05, 0.05, 0.1), LENGTH / 2 + 0.025, level=1), True),
        (lay(LENGTH, level=1), False),
        (lay(LENGTH, level=3), False),
        (lay(0.0, level=1), False),
        (lay(LENGTH - 1e-4, level=2), False),
    ],
    ids=["flush", "2 mm apart", "a tall block", "a level below", "a level above", "below it", "overlapping"],
)
def test_neighbours_are_apart_in_plan_and_share_some_height(other, expected):
    assert side_by_side(PLANK, Boxes.of([other]))[0, 0] == expected


def test_a_planned_neighbour_carries_nothing_though_it_has_moved_into_the_plank():
    """A tall block, planned flush with the plank's end, has moved by 20 um: it would lift the plank onto itself."""
    block = box((0.05, 0.05, 0.1), LENGTH / 2 + 0.025, level=1)
    planned, moved = Boxes.of([block]), Boxes.of([box((0.05, 0.05, 0.1), LENGTH / 2 + 0.025 - 2e-5, level=1)])
    lifted = resting_shift(PLANK, moved)
    assert lifted == pytest.approx(0.1 - THICKNESS + CLEARANCE)
    neighbours = side_by_side(PLANK, planned)
    assert resting_shift(PLANK, moved, neighbours=neighbours) == pytest.approx(CLEARANCE - THICKNESS)


TABLE_TOP = THICKNESS / 2


@pytest.mark.parametrize(
    ("fixed", "room"),
    [
        (box((0.2, 0.2, TABLE_TOP), 0.0, level=1), THICKNESS - TABLE_TOP),
        (box((0.2, 0.2, THICKNESS + 1e-3), 0.0, level=1), -1e-3),
        (box((0.02, 0.2, 0.1), LENGTH / 2 + 0.01, level=1), np.inf),
        (box((0.2, 0.2, 0.05), 0.0, level=1, bottom=2 * THICKNESS), np.inf),
        (box((0.2, 0.2, 0.05), 0.0, level=1, bottom=0.1), np.inf),
    ],
    ids=["table", "table that it overlaps by placement noise", "wall", "ceiling that it touches", "high ceiling"],
)
def test_only_a_fixed_box_below_carries(fixed, room):
    assert room_above_fixed(PLANK, Boxes.of([fixed])) == pytest.approx(room, abs=1e-12)
    shift = resting_shift(PLANK, Boxes.of([]), fixed=Boxes.of([fixed]))
    assert shift == pytest.approx(CLEARANCE - min(room, THICKNESS), abs=1e-12)


def test_a_group_between_walls_is_lowered_onto_the_ledge_of_one_of_them():
    ledge = box((0.01, WIDTH, 0.004), LENGTH / 2, level=1)
    walls = [box((0.02, WIDTH, 0.1), side * (LENGTH / 2 + 0.01), level=1) for side in (-1, 1)]
    assert room_above_fixed(PLANK, Boxes.of([*walls, ledge])) == pytest.approx(THICKNESS - 0.004, abs=1e-12)


def test_without_fixed_boxes_nothing_limits_the_room():
    assert room_above_fixed(PLANK, Boxes.of([])) == np.inf
