"""Convex polygons in plan, against closed forms and brute force."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from stability_core.polygon import centroid, convex_hull, inside_distance, lies_on, nearest_point, width

SQUARE = np.array([(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0)], float)
GRID = st.integers(1, 30).flatmap(lambda n: arrays(float, (n, 3), elements=st.integers(-5, 5).map(float)))
CLOUD = st.integers(3, 40).flatmap(lambda n: arrays(float, (n, 3), elements=st.floats(-1, 1, width=32)))


def turns(hull):
    a, b, c = hull, np.roll(hull, -1, axis=0), np.roll(hull, -2, axis=0)
    return (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])


@given(GRID | CLOUD)
def test_the_hull_is_convex_and_holds_every_point(points):
    hull = convex_hull(points)
    assert {tuple(vertex[:2]) for vertex in hull} <= {tuple(point[:2]) for point in points}
    if len(hull) >= 3:
        assert (turns(hull) > 0).all(), "counter-clockwise, without collinear vertices"
    for x, y, _ in points:
        assert inside_distance(hull, x, y) >= -1e-7  # float32 inputs: rounding of the cross products


ROUND = np.linspace(0.0, 2.0 * np.pi, 101)[:-1]


@pytest.mark.parametrize(
    ("x", "y", "vertices"),
    [
        (np.repeat(np.arange(50.0), 20), np.tile(np.arange(20.0), 50), 4),  # a grid
        (np.tile(np.arange(20.0), 50), np.repeat(np.arange(50.0), 20), 4),
        (np.cos(ROUND), np.sin(ROUND), 100),
        (np.arange(100.0), 2.0 * np.arange(100.0), 2),
        (np.full(100, 3.0), np.arange(100.0), 2),
        (np.full(100, 3.0), np.full(100, 4.0), 1),
    ],
)
def test_many_points_have_the_hull_of_few(x, y, vertices):
    points = np.column_stack([x, y, np.zeros(len(x))])
    hull = convex_hull(points)
    assert len(hull) == vertices
    assert all(lies_on(hull, px, py) or inside_distance(hull, px, py) >= -1e-12 for px, py, _ in points)


@pytest.mark.parametrize(
    ("points", "vertices"),
    [
        ([(1, 2, 3)], 1),
        ([(1, 2, 3), (1, 2, 5)], 1),  # same place in plan
        ([(0, 0, 0), (1, 1, 0), (3, 3, 0), (2, 2, 0)], 2),  # a line keeps its ends
        ([(0, 0, 0), (1, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (1, 1, 0)], 4),
    ],
)
def test_degenerate_and_redundant_points(points, vertices):
    assert len(convex_hull(np.array(points, float))) == vertices


@pytest.mark.parametrize(
    ("x", "y", "distance"),
    [(1, 1, 1.0), (0.25, 1, 0.25), (0, 1, 0.0), (-0.5, 1, -0.5), (3, 3, -np.sqrt(2))],
)
def test_distance_to_a_square(x, y, distance):
    assert inside_distance(SQUARE, x, y) == pytest.approx(distance, abs=1e-12)


def test_a_line_a_point_and_nothing_have_no_inside():
    assert inside_distance(SQUARE[:2], 1.0, 0.0) == 0.0
    assert inside_distance(SQUARE[:2], 1.0, 0.5) == pytest.approx(-0.5)
    assert inside_distance(SQUARE[:1], 3.0, 4.0) == pytest.approx(-5.0)
    assert inside_distance(SQUARE[:0], 0.0, 0.0) == -np.inf


@given(GRID, st.integers(-5, 5), st.integers(-5, 5))
def test_a_point_lies_on_a_hull_where_its_distance_is_not_negative(points, x, y):
    """Borders count, and a line or a point is all border. On a grid, sides are exact."""
    hull = convex_hull(points)
    assert lies_on(hull, float(x), float(y)) == (inside_distance(hull, float(x), float(y)) >= 0.0)


def test_width_is_the_least_extent():
    strip = np.array([(0, 0, 0), (1, 0, 0), (1, 0.2, 0), (0, 0.2, 0)], float)
    turn = np.array([[np.cos(0.3), -np.sin(0.3)], [np.sin(0.3), np.cos(0.3)]])
    strip[:, :2] = strip[:, :2] @ turn.T
    assert width(strip) == pytest.approx(0.2)
    assert width(strip[:2]) == 0.0


def test_centroid_of_a_triangle_and_of_a_line():
    triangle = np.array([(0, 0, 1), (3, 0, 1), (0, 3, 4)], float)
    assert centroid(triangle) == pytest.approx([1, 1, 2])
    assert centroid(triangle[:2]) == pytest.approx([1.5, 0, 1])


def test_centroid_is_that_of_the_area_and_not_of_the_vertices():
    """Many vertices on one side must not pull the centre there."""
    hull = np.array([(0, 0, 0), (4, 0, 0), (4, 2, 0), (0.5, 2, 0), (0, 1.5, 0)], float)
    square, corner = 8.0, 0.125  # the cut corner's area
    expected = (square * 2.0 - corner * (0.5 / 3)) / (square - corner)
    assert centroid(hull)[0] == pytest.approx(expected)


@pytest.mark.parametrize(
    ("point", "nearest"), [((3, 1), (2, 1)), ((-1, 5), (0, 2)), ((1, 0.5), (1, 0)), ((2, 2), (2, 2))]
)
def test_the_nearest_point_of_a_square(point, nearest):
    assert nearest_point(SQUARE, *map(float, point)) == nearest
