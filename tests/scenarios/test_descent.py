"""The straight descent of one convex body onto another, against closed forms and against the zonotope of boxes."""

from __future__ import annotations

import math

import numpy as np
import pytest

from scenarios.descent import Placed, lowest_difference
from scenarios.geometry import Boxes, height_above_ground, height_of_top, resting_shift, rotation, vertical_clearance
from scenarios.model import CLEARANCE, Quaternion
from scenarios.shapes import Point, Shape
from scenarios.solids import cylinder, polyhedron, sphere

UPRIGHT: Quaternion = (1.0, 0.0, 0.0, 0.0)
ALONG_Y: Quaternion = (math.sqrt(0.5), math.sqrt(0.5), 0.0, 0.0)
ALONG_X: Quaternion = (math.sqrt(0.5), 0.0, math.sqrt(0.5), 0.0)


def placed(shape: Shape, size: Point, center: Point, quaternion: Quaternion = UPRIGHT) -> Placed:
    return Placed(shape, size, np.array(center), rotation(np.array([quaternion]))[0])


def test_random_boxes_descend_as_their_zonotope_says() -> None:
    rng = np.random.default_rng(22)
    for case in range(300):
        sizes, turns = rng.uniform(0.02, 0.2, (2, 3)), rng.normal(size=(2, 4))
        turns /= np.linalg.norm(turns, axis=1)[:, None]
        if case % 3 == 0:
            turns[:] = UPRIGHT  # faces, edges and corners in line
        centers = rng.uniform(-0.1, 0.1, (2, 3))
        upper, lower = (Boxes.at(sizes[k], centers[k], turns[k]) for k in (0, 1))
        one, other = (Placed("box", tuple(sizes[k]), centers[k], rotation(turns[k : k + 1])[0]) for k in (0, 1))
        # both are exact but for rounding and, of the descent, the tolerance of 1e-10 m
        assert lowest_difference(one, other) == pytest.approx(vertical_clearance(upper, lower)[0, 0], abs=1e-9)


def test_spheres_meet_at_the_distance_of_their_radii() -> None:
    rng = np.random.default_rng(23)
    for _ in range(100):
        (one, other), (x, y) = rng.uniform(0.01, 0.1, 2), rng.uniform(-0.15, 0.15, 2)
        upper, lower = placed("sphere", (2 * one,) * 3, (x, y, 0.5)), placed("sphere", (2 * other,) * 3, (0, 0, 0))
        below = (one + other) ** 2 - x * x - y * y
        ideal = 0.5 - math.sqrt(below) if below > 0 else math.inf
        assert lowest_difference(upper, lower) == pytest.approx(ideal, abs=1e-8)


def test_cylinders_meet_along_a_line_and_in_a_point() -> None:
    above = placed("cylinder", (0.04, 0.04, 0.2), (0.02, 0.01, 0.3), ALONG_Y)
    along = placed("cylinder", (0.06, 0.06, 0.2), (0.0, 0.0, 0.0), ALONG_Y)
    across = placed("cylinder", (0.06, 0.06, 0.2), (0.0, 0.0, 0.0), ALONG_X)
    assert lowest_difference(above, along) == pytest.approx(0.3 - math.sqrt(0.05**2 - 0.02**2), abs=1e-9)
    assert lowest_difference(above, across) == pytest.approx(0.3 - 0.05, abs=1e-9)


def test_bodies_of_other_shapes_count_with_their_lowest_and_highest_points() -> None:
    pyramid = polyhedron([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0), (0, 0, 2)], position=(0, 0, 3), mass=1.0)
    ball = sphere(0.5, position=(0.0, 0.0, 7.0), mass=1.0)
    boxes = Boxes.of([pyramid, ball])
    assert height_above_ground(boxes) == pytest.approx([3.0, 6.5])
    assert height_of_top(boxes) == pytest.approx([5.0, 7.5])
    assert vertical_clearance(boxes.chosen(np.array([1])), boxes.chosen(np.array([0])))[0, 0] == pytest.approx(1.5)


def test_a_log_is_let_go_above_the_logs_that_it_will_touch() -> None:
    logs = [cylinder(0.02, 0.1, position=(x, 0.0, 0.02), quaternion=ALONG_Y, mass=1.0) for x in (-0.02, 0.02)]
    top = cylinder(0.02, 0.1, position=(0.0, 0.0, 1.0), quaternion=ALONG_Y, mass=1.0)
    shift = resting_shift(Boxes.of([top]), Boxes.of(logs))
    assert 1.0 + shift == pytest.approx(0.02 * (1 + math.sqrt(3)) + CLEARANCE, abs=1e-9)
