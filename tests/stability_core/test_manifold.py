"""A patch is the hull of its contact points: in plan if it bears load, else in its own plane; few vertices stay."""

import math

import numpy as np
import pytest

from stability_core.manifold import ENOUGH_VERTICES, NEGLIGIBLE, shape_patch
from stability_core.stack import LEAN, MAX_VERTICES, PATCH, SUPPORT

LENGTH, WIDTH, Z = 0.117, 0.0234, 0.0078
RECTANGLE = np.array([(x, y, Z) for x in (0, LENGTH) for y in (0, WIDTH)], float)


def shaped(points, kind=SUPPORT, normal=(0.0, 0.0, 1.0)):
    """A patch of the kind and normal, with the hull of the points."""
    patch = np.zeros(1, PATCH)
    patch["kind"], patch["normal"] = kind, normal
    shape_patch(patch[0], np.asarray(points, float))
    return patch[0]


def corners(patch):
    return patch["vertex"][: patch["vertices"]]


def area(hull):
    x, y = hull[:, 0], hull[:, 1]
    return float((x * np.roll(y, -1) - np.roll(x, -1) * y).sum() / 2)


def test_points_inside_the_hull_and_seen_twice_do_not_count():
    inner = np.add(RECTANGLE.mean(axis=0), [[0.001, 0.002, 0.0], [-0.01, 0.001, 0.0]])
    patch = shaped(np.vstack([inner, RECTANGLE, RECTANGLE]))
    assert sorted(map(tuple, corners(patch).tolist())) == sorted(map(tuple, RECTANGLE.tolist()))
    assert area(corners(patch)) == pytest.approx(LENGTH * WIDTH)
    assert patch["center"] == pytest.approx([LENGTH / 2, WIDTH / 2, Z])
    assert patch["width"] == pytest.approx(WIDTH)


@pytest.mark.parametrize("points", [RECTANGLE[:1], RECTANGLE[:2]], ids=["point", "line"])
def test_a_point_and_a_line_have_no_width(points):
    patch = shaped(points)
    assert patch["vertices"] == len(points)
    assert patch["width"] == 0.0
    assert patch["center"] == pytest.approx(points.mean(axis=0))


def test_points_that_tremble_add_no_vertices():
    trembling = RECTANGLE + np.random.default_rng(1).normal(0.0, 1e-7, size=(50, 4, 3))
    patch = shaped(trembling.reshape(-1, 3))
    assert patch["vertices"] == ENOUGH_VERTICES
    assert area(corners(patch)) == pytest.approx(LENGTH * WIDTH, rel=NEGLIGIBLE)


@pytest.mark.parametrize("count", [MAX_VERTICES, MAX_VERTICES + 1, 100])
def test_of_a_round_patch_as_many_vertices_stay_as_there_is_room_for(count):
    turn = 2 * np.pi * np.arange(count) / count
    patch = shaped(np.column_stack([np.cos(turn), np.sin(turn), np.full(count, Z)]))
    assert patch["vertices"] == MAX_VERTICES
    inscribed = MAX_VERTICES / 2 * math.sin(2 * math.pi / MAX_VERTICES)
    assert area(corners(patch)) == pytest.approx(inscribed, rel=0.05)
    assert area(corners(patch)) <= math.pi


def test_a_steep_patch_is_taken_in_its_own_plane():
    """A face that leans by 70 deg: in plan it would be a third as wide."""
    tilt = math.radians(70)
    normal = np.array([math.sin(tilt), 0.0, math.cos(tilt)])
    along, down = np.array([0.0, 1.0, 0.0]), np.array([math.cos(tilt), 0.0, -math.sin(tilt)])
    points = np.array([a * LENGTH * along + b * WIDTH * down for a in (0, 1) for b in (0, 1)])
    patch = shaped(points, LEAN, normal)
    assert patch["vertices"] == 4
    assert patch["width"] == pytest.approx(WIDTH)
    assert patch["center"] == pytest.approx(points.mean(axis=0))
    assert sorted(map(tuple, corners(patch).round(12).tolist())) == sorted(map(tuple, points.round(12).tolist()))
