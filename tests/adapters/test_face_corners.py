"""Corners of contact faces, by geometry alone: boxes of 2 x 1 x 0.2 m, so that a tenth of a millimetre is a hair."""

from __future__ import annotations

import math

import numpy as np
import pytest

from adapters.face_corners import NEAR, with_missing_corners
from stability_core.port import GROUND, Contacts

HALF = (1.0, 0.5, 0.1)
UP = (0.0, 0.0, 1.0)


def box(center, yaw=0.0, pitch=0.0, half=HALF):
    c, s, cp, sp = math.cos(yaw / 2), math.sin(yaw / 2), math.cos(pitch / 2), math.sin(pitch / 2)
    return [*center, c * cp, -s * sp, c * sp, s * cp, *half]  # pitch about y, then yaw about z


def touch(*points, a=0, b=1, normal=UP):
    n = len(points)
    return Contacts(
        np.full(n, a), np.full(n, b), np.array(points, float), np.tile(normal, (n, 1)), np.full(n, -1e-5),
        np.tile((0.0, 0.0, -0.3), (n, 1)), np.full(n, 0.45),
    )  # fmt: skip


def added(contacts, *boxes, bodies=(0, 1)):
    whole = with_missing_corners(contacts, np.array(bodies), np.array(boxes))
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
    ground = box((0, 0, -1), half=(100, 100, 1))
    _, corners = added(contacts, ground, box(center, pitch=-lean), bodies=(GROUND, 3))
    assert corners == set()


def test_pairs_are_told_apart_whatever_the_order_of_the_rows():
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
