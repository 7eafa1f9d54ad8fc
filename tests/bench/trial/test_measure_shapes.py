"""A round brick that turns about its own axis has not toppled; a standing cylinder that leans has."""

from __future__ import annotations

import math

import numpy as np
import pytest

from bench.trial.measure import Plan, tilt, top
from scenarios.solids import capsule, cylinder, sphere

ALONG_Y = (math.sqrt(0.5), math.sqrt(0.5), 0.0, 0.0)


def about_y(angle: float) -> np.ndarray:
    return np.array([math.cos(angle / 2), 0.0, math.sin(angle / 2), 0.0])


def product(first: np.ndarray, second: tuple[float, ...]) -> np.ndarray:
    (a, *b), (c, *d) = first, second
    b, d = np.array(b), np.array(d)
    return np.array([a * c - b @ d, *(a * d + c * b + np.cross(b, d))])


def test_the_tilt_of_round_bricks_is_that_of_their_axis() -> None:
    bricks = [
        cylinder(0.02, 0.1, position=(0.0, 0.0, 0.02), quaternion=ALONG_Y, mass=1.0),
        capsule(0.02, 0.1, position=(0.1, 0.0, 0.02), quaternion=ALONG_Y, mass=1.0),
        sphere(0.02, position=(0.2, 0.0, 0.02), mass=1.0),
        cylinder(0.02, 0.1, position=(0.3, 0.0, 0.05), mass=1.0),
    ]
    turned = np.array([product(about_y(0.4), brick.quaternion) for brick in bricks])
    assert tilt(Plan.of(bricks), turned) == pytest.approx([0.0, 0.0, 0.0, 0.4], abs=1e-7)


def test_the_top_of_a_level_is_the_highest_point_of_its_shapes() -> None:
    bricks = [sphere(0.02, position=(0.0, 0.0, 0.02), mass=1.0), sphere(0.03, position=(0.1, 0.0, 0.03), mass=1.0)]
    plan = Plan.of(bricks)
    turn = np.tile([math.cos(0.3), math.sin(0.3), 0.0, 0.0], (2, 1))
    assert top(plan, plan.position, turn, 1) == pytest.approx(0.06)
