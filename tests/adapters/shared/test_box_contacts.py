"""What nearly touches, by geometry alone: boxes of 2 x 1 x 0.2 m, for which 1.9 mm is a hair."""

from __future__ import annotations

import math

import numpy as np
import pytest

from adapters.shared import box_contacts
from adapters.shared.contact_completion import BoxTable
from stability_core.port import GROUND, Contacts

HALF = (1.0, 0.5, 0.1)
NEAR = box_contacts.NEAR * math.hypot(*HALF) / box_contacts.PLANK
"""Gap [m] up to which two of these boxes nearly touch."""
UP = (0.0, 0.0, 1.0)


def box(center, yaw=0.0, pitch=0.0, half=HALF):
    c, s, cp, sp = math.cos(yaw / 2), math.sin(yaw / 2), math.cos(pitch / 2), math.sin(pitch / 2)
    return center, (c * cp, -s * sp, c * sp, s * cp), tuple(2 * edge for edge in half)  # pitch about y, yaw about z


def table_of(boxes: dict):
    table = BoxTable()
    for body, (center, quaternion, size) in boxes.items():
        table.add(body, size)
        table.place(np.array([body]), np.array([center]), np.array([quaternion]))
    return table


def touch(*points, a=0, b=1, normal=UP):
    n = len(points)
    return Contacts(
        np.full(n, a), np.full(n, b), np.array(points, float), np.tile(normal, (n, 1)), np.full(n, -1e-5),
        np.tile((0.0, 0.0, -0.3), (n, 1)), np.full(n, 0.45),
    )  # fmt: skip


def added(contacts, *boxes, bodies=(0, 1)):
    whole = table_of(dict(zip(bodies, boxes, strict=True))).with_missing_corners(contacts)
    n = len(contacts)
    assert (whole.point[:n] == contacts.point).all(), "what the engine listed stays as it is"
    return whole, {tuple(np.round(point, 6).tolist()) for point in whole.point[n:]}


def test_three_listed_corners_get_their_fourth():
    contacts = touch((-0.5, -0.5, 0.1), (1.0, -0.5, 0.1), (1.0, 0.5, 0.1))
    whole, corners = added(contacts, box((0, 0, 0)), box((0.5, 0, 0.2)))
    assert corners == {(-0.5, 0.5, 0.1)}
    assert whole.normal[-1] == pytest.approx(UP)
    assert whole.relative_velocity[-1] == pytest.approx((0, 0, -0.3))
    assert whole.friction[-1] == 0.45
    assert whole.separation[-1] == pytest.approx(0, abs=1e-12)


def test_crossed_planks_touch_in_a_square():
    contacts = touch((0.5, 0.5, 0.1))
    _, corners = added(contacts, box((0, 0, 0)), box((0, 0, 0.2), yaw=math.pi / 2))
    assert corners == {(0.5, -0.5, 0.1), (-0.5, 0.5, 0.1), (-0.5, -0.5, 0.1)}


def test_a_face_at_an_angle_is_clipped_to_the_true_overlap():
    """A square turned by 45 degrees over a strip's end: the overlap is a hexagon or less, never beyond the strip."""
    contacts = touch((0.0, 0.0, 0.1))
    _, corners = added(contacts, box((0, 0, 0)), box((0, 0, 0.2), yaw=math.pi / 4, half=(0.6, 0.6, 0.1)))
    assert len(corners) == 6
    assert all(abs(x) <= 1.0 + 1e-9 and abs(y) <= 0.5 + 1e-9 for x, y, _ in corners)


@pytest.mark.parametrize(("rise", "count"), [(0.5 * NEAR, 2), (1.5 * NEAR, 0)])
def test_only_corners_within_a_hair_are_added(rise, count):
    """The upper box touches along one edge; its other end is ``rise`` above the lower one."""
    pitch = -math.asin(rise / 2)
    center = (math.cos(pitch) - 1 + math.sin(pitch) * 0.1, 0.0, 0.1 + rise / 2 + 0.1 * math.cos(pitch))
    contacts = touch((-1.0, -0.5, 0.1), (-1.0, 0.5, 0.1))
    whole, corners = added(contacts, box((0, 0, 0)), box(center, pitch=pitch))
    assert len(corners) == count
    assert whole.separation[2:] == pytest.approx([rise] * count, rel=1e-3)


def test_a_plank_that_leans_stands_on_its_edge_only():
    lean = math.radians(70)
    contacts = touch((0.0, 0.5, 0.0), (0.0, -0.5, 0.0), a=GROUND, b=3)
    # turned so that its long axis rises at 70 degrees and its lower edge lies on the ground at x = 0
    half = np.array(HALF)
    c, s = math.cos(lean), math.sin(lean)
    center = (half[0] * c - half[2] * s, 0.0, half[0] * s + half[2] * c)
    _, corners = added(contacts, box(center, pitch=-lean), bodies=(3,))
    assert corners == set()


def test_pairs_are_distinguished_whatever_the_order_of_the_rows():
    left, right, bridge = box((-1.2, 0, 0)), box((1.2, 0, 0)), box((0, 0, 0.2))
    points = [(-1.0, -0.5, 0.1), (1.0, -0.5, 0.1), (-1.0, 0.5, 0.1), (1.0, 0.5, 0.1)]
    plain = touch(*points)
    mixed = Contacts(
        np.array([4, 6, 4, 6]), np.full(4, 9), plain.point, plain.normal, plain.separation, plain.relative_velocity,
        plain.friction,
    )  # fmt: skip
    whole, corners = added(mixed, left, right, bridge, bodies=(4, 6, 9))
    assert corners == {(x, y, 0.1) for x in (-0.2, 0.2) for y in (-0.5, 0.5)}
    assert {int(a) for a, x in zip(whole.body_a[4:], whole.point[4:, 0], strict=True) if x < 0} == {4}
    assert {int(a) for a, x in zip(whole.body_a[4:], whole.point[4:, 0], strict=True) if x > 0} == {6}


def near(boxes: dict, live, listed=None, velocities=lambda _, points: np.zeros(points.shape)):
    contacts = Contacts.empty() if listed is None else listed
    return table_of(boxes).with_near_pairs(contacts, np.array(live), 0.45, velocities)


@pytest.mark.parametrize(("gap", "count"), [(0.5 * NEAR, 4), (-0.5 * NEAR, 4), (1.5 * NEAR, 0)])
def test_a_pair_that_is_not_listed_touches_within_a_hair(gap, count):
    """Of a roof on uneven ridges an engine lists those that it penetrates; the others would carry as well."""
    whole = near({0: box((0, 0, 0)), 1: box((0.5, 0, 0.2 + gap))}, live=[1])
    assert len(whole) == count
    assert whole.separation == pytest.approx([gap] * count)
    assert set(zip(whole.body_a.tolist(), whole.body_b.tolist(), strict=True)) == ({(0, 1)} if count else set())
    for row in range(count):
        assert whole.normal[row] == pytest.approx(UP)
        assert -0.5 <= whole.point[row, 0] <= 1.0
        assert whole.friction[row] == 0.45


def test_a_pair_that_is_listed_stays_as_it_is():
    boxes = {0: box((0, 0, 0)), 1: box((0.5, 0, 0.2))}
    for listed in (touch((1.0, 0.5, 0.1)), touch((1.0, 0.5, 0.1), a=1, b=0, normal=(0.0, 0.0, -1.0))):
        assert near(boxes, live=[1], listed=listed) is listed


def test_a_pair_of_live_boxes_is_met_once_and_frozen_pairs_never():
    boxes = {0: box((0, 0, 0)), 1: box((0, 0, 0.2)), 2: box((0, 0, 0.4))}
    assert len(near(boxes, live=[1, 2])) == 8
    assert len(near(boxes, live=[2])) == 4


def test_the_ground_is_a_box_as_well():
    whole = near({7: box((30.0, 0, 0.1 + 0.5 * NEAR))}, live=[7])
    assert set(whole.body_a.tolist()) == {GROUND}
    assert whole.point[:, 2] == pytest.approx([0.5 * NEAR] * 4)


def test_a_slope_over_an_edge_touches_along_that_edge():
    """A strip tilted by one degree just above the edge of a block: two points there, none where the gap is wide."""
    pitch = math.radians(1.0)
    over = np.array((1.0, 0.0, 0.1 + 0.5 * NEAR))
    center = over + 0.1 * np.array((math.sin(pitch), 0.0, math.cos(pitch)))
    whole = near({0: box((0, 0, 0)), 1: box(center, pitch=pitch, half=(0.5, 0.5, 0.1))}, live=[1])
    # the strip falls toward +x, away from the block: it is nearest to the block's border at x = 1
    assert len(whole) == 2
    assert whole.point[:, 0] == pytest.approx([1.0, 1.0], abs=0.01)


def test_what_is_gone_or_beside_is_not_near():
    table = table_of({0: box((0, 0, 0)), 1: box((0, 0, 0.2)), 2: box((2.1, 0, 0.2))})
    table.remove(0)
    assert not len(table.with_near_pairs(Contacts.empty(), np.array([1]), 0.45, lambda _, points: points))


def test_a_near_point_approaches_as_its_bodies_move():
    """What has not touched has not been stopped: its velocity is that before impact."""

    def velocities(bodies, points):
        return np.where((bodies == 1)[:, None], (0.0, 0.0, -0.3), 0.0) * np.ones(points.shape)

    whole = near({0: box((0, 0, 0)), 1: box((0, 0, 0.2))}, live=[1], velocities=velocities)
    assert whole.relative_velocity == pytest.approx(np.tile((0.0, 0.0, -0.3), (4, 1)))


def exact(boxes: dict, live, listed):
    return table_of(boxes).with_exact_faces(listed, np.array(live), 0.45)


@pytest.mark.parametrize(("gap", "replaced"), [(0.0, True), (-0.5 * NEAR, True), (-3 * NEAR, False)])
def test_geometry_replaces_a_face_that_touches_and_no_deeper_one(gap, replaced):
    listed = touch((0.0, 0.0, 0.1), normal=(0.6, 0.0, 0.8))
    whole = exact({0: box((0, 0, 0)), 1: box((0.5, 0, 0.2 + gap))}, live=[1], listed=listed)
    if replaced:
        assert len(whole) == 4
        assert whole.normal == pytest.approx(np.tile(UP, (4, 1)))
        assert whole.separation == pytest.approx([gap] * 4, abs=1e-12)
    else:
        assert whole.point.tolist() == listed.point.tolist()
        assert whole.normal.tolist() == listed.normal.tolist()


@pytest.mark.parametrize("aside", [-5e-7, 0.0, 5e-7])
def test_edges_that_meet_touch_in_two_points_also_by_rounding(aside):
    """Two boxes that lean on each other's upper edge at 60 degrees, where one face is clipped away but for its edge."""
    lean = math.radians(60)
    reach = HALF[0] * math.cos(lean) + HALF[2] * math.sin(lean)
    boxes = {0: box((-reach - aside, 0, 0), pitch=-lean), 1: box((reach + aside, 0, 0), pitch=math.pi + lean)}
    whole = exact(boxes, live=[0, 1], listed=Contacts.empty())
    height = HALF[0] * math.sin(lean) - HALF[2] * math.cos(lean)
    assert len(whole) == 2
    assert sorted(whole.point[:, 1].tolist()) == pytest.approx([-0.5, 0.5], abs=1e-5)
    assert np.abs(whole.point[:, [0, 2]] - (0.0, height)).max() < 1e-5


@pytest.mark.parametrize("size", [0.1, 1.0, 100.0])
def test_lengths_follow_the_size_of_the_smaller_box_of_a_pair(size):
    """For a pair of planks the constants are metres; for others they are as much larger or smaller."""
    half = tuple(size * edge for edge in (58.5e-3, 11.7e-3, 3.9e-3))
    slab = tuple(10 * edge for edge in half)

    def corners(gap):
        upper = (0.0, 0.0, slab[2] + half[2] + gap)
        table = table_of({0: box((0, 0, 0), half=slab), 1: box(upper, half=half)})
        live, nothing = np.array([1]), Contacts.empty()
        return len(table.with_near_pairs(nothing, live, 0.45, lambda _, points: 0.0 * points))

    hair = box_contacts.NEAR * size
    assert (corners(0.9 * hair), corners(1.1 * hair)) == (4, 0)


@pytest.mark.parametrize("size", [0.1, 1.0, 100.0])
def test_a_corner_near_a_listed_one_is_distinguished_at_any_size(size):
    """Two planks that overlap by 2 mm have four corners; the engine lists two of them, on one side."""
    half = tuple(size * edge for edge in (58.5e-3, 11.7e-3, 3.9e-3))
    overlap = 2e-3 * size
    upper = (2 * half[0] - overlap, 0.0, 2 * half[2])
    listed = touch(*((half[0], y, half[2]) for y in (-half[1], half[1])))
    whole = table_of({0: box((0, 0, 0), half=half), 1: box(upper, half=half)}).with_missing_corners(listed)
    assert whole.point[2:, 0] == pytest.approx([half[0] - overlap] * 2)
