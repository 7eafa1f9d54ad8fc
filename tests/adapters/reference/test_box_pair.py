"""The reference engines' detector against linear programs and boxes at known distances."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import linprog

from adapters.reference.boxes import FIXED, LIVE, BoxArrays
from adapters.reference.detector import SLACK, BoxDetector, FoundContacts
from scenarios.model import Brick, Quaternion, Vector

SEED = 20080
NO_GRAVITY = np.zeros(3)
PLANK = (0.117, 0.0234, 0.0078)


def boxes_of(*bricks: Brick) -> BoxArrays:
    boxes = BoxArrays(0)
    for body, brick in enumerate(bricks):
        boxes.add(body, brick, LIVE)
    return boxes


def found(*bricks: Brick) -> FoundContacts:
    return BoxDetector(1.0).find(boxes_of(*bricks), NO_GRAVITY, 0.0)


def about(axis: Vector, degrees: float) -> Quaternion:
    half = math.radians(degrees) / 2
    x, y, z = np.array(axis) / np.linalg.norm(axis) * math.sin(half)
    return math.cos(half), float(x), float(y), float(z)


def random_brick(draws: np.random.Generator) -> Brick:
    w, x, y, z = draws.normal(size=4)
    length = math.sqrt(w * w + x * x + y * y + z * z)
    px, py, pz = draws.uniform(-0.5, 0.5, 3)
    sx, sy, sz = draws.uniform(0.1, 0.6, 3)
    return Brick((sx, sy, sz), 1.0, (px, py, pz), (w / length, x / length, y / length, z / length))


def half_spaces(brick: Brick) -> tuple[np.ndarray, np.ndarray]:
    w, x, y, z = brick.quaternion
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
    normals = np.vstack([turn.T, -turn.T])
    return normals, normals @ np.array(brick.position) + np.tile(np.array(brick.size) / 2, 2)


def common_depth(a: Brick, b: Brick) -> float:
    """Return the radius of the largest ball in both boxes; negative if the boxes are disjoint."""
    (normals_a, limits_a), (normals_b, limits_b) = half_spaces(a), half_spaces(b)
    matrix = np.column_stack([np.vstack([normals_a, normals_b]), np.ones(12)])
    program = linprog([0, 0, 0, -1], A_ub=matrix, b_ub=np.concatenate([limits_a, limits_b]), bounds=(None, None))
    return float(program.x[3])


def test_boxes_overlap_if_and_only_if_a_linear_program_finds_a_common_point() -> None:
    draws = np.random.default_rng(SEED)
    seen = set()
    for _ in range(60):
        a, b = random_brick(draws), random_brick(draws)
        contacts = found(a, b)
        overlaps = common_depth(a, b) > 0
        assert bool((contacts.gap < 0).any()) == overlaps
        np.testing.assert_allclose(np.linalg.norm(contacts.normal, axis=1), 1.0, atol=1e-12)
        seen.add(overlaps)
    assert seen == {True, False}


@pytest.mark.parametrize("gap", [-0.2e-3, 0.0, 0.05e-3])
def test_a_face_on_a_face_has_the_corners_of_their_common_area(gap: float) -> None:
    lower = Brick(PLANK, 1.0, (0.0, 0.0, 0.0))
    upper = Brick(PLANK, 1.0, (0.05, 0.0, PLANK[2] + gap), about((0, 0, 1), 90.0))
    contacts = found(lower, upper)
    np.testing.assert_allclose(contacts.gap, gap, atol=1e-12)
    np.testing.assert_allclose(contacts.normal, [[0.0, 0.0, 1.0]] * len(contacts), atol=1e-12)
    right = min(0.05 + PLANK[1] / 2, PLANK[0] / 2)
    corners = {(round(x, 9), round(y, 9)) for x, y, _ in contacts.point}
    wanted = {(round(x, 9), round(y, 9)) for x in (0.05 - PLANK[1] / 2, right) for y in (-PLANK[1] / 2, PLANK[1] / 2)}
    assert corners == wanted


def test_crossing_edges_have_one_point_between_them() -> None:
    """Both boxes stand on edge, crossed at right angles, 0.05 mm apart."""
    size, rise, gap = (0.1, 0.02, 0.02), 0.02 * math.sqrt(0.5), 0.05e-3
    lower = Brick(size, 1.0, (0.0, 0.0, 0.0), about((1, 0, 0), 45.0))
    w, x, _, _ = about((1, 0, 0), 45.0)
    root = math.sqrt(0.5)
    upper = Brick(size, 1.0, (0.01, 0.005, 2 * rise + gap), (root * w, root * x, root * x, root * w))
    contacts = found(lower, upper)
    assert len(contacts) == 1
    assert contacts.gap[0] == pytest.approx(gap, abs=1e-12)
    np.testing.assert_allclose(contacts.point[0], (0.01, 0.0, rise + gap / 2), atol=1e-9)
    np.testing.assert_allclose(contacts.normal[0], (0.0, 0.0, 1.0), atol=1e-9)


def test_the_ridge_of_a_v_has_the_normal_of_a_face() -> None:
    """Two planks lean at 72 degrees and touch along their upper inner edges: ideal edges would touch horizontally."""
    lean = math.radians(72.0)
    height = (PLANK[0] * math.sin(lean) + PLANK[2] * math.cos(lean)) / 2
    reach = (PLANK[0] * math.cos(lean) + PLANK[2] * math.sin(lean)) / 2
    left = Brick(PLANK, 1.0, (-reach, 0.0, height), about((0, 1, 0), -72.0))
    right = Brick(PLANK, 1.0, (reach, 0.0, height), about((0, 1, 0), 72.0))
    contacts = found(left, right)
    near = np.flatnonzero(np.abs(contacts.gap) < 1e-9)
    assert len(near) == 2
    tilt = np.degrees(np.arccos(np.abs(contacts.normal[near, 0])))
    np.testing.assert_allclose(tilt, 90.0 - 72.0, atol=1e-6)


def test_the_sweep_finds_every_pair_with_a_live_box() -> None:
    draws = np.random.default_rng(SEED + 1)
    bricks = [random_brick(draws) for _ in range(14)]
    boxes = boxes_of(*bricks)
    for body in range(0, 14, 3):
        boxes.set_state(body, FIXED)
    boxes.remove(7)
    contacts = BoxDetector(1.0).find(boxes, NO_GRAVITY, 0.0)
    listed = set(zip(contacts.row_a.tolist(), contacts.row_b.tolist(), strict=True))
    wanted = {
        (a + 1, b + 1)
        for a in range(14)
        for b in range(a + 1, 14)
        if 7 not in (a, b) and not (a % 3 == 0 and b % 3 == 0) and common_depth(bricks[a], bricks[b]) > 0
    }
    assert wanted
    assert wanted <= listed
    assert all(common_depth(bricks[a - 1], bricks[b - 1]) > -SLACK for a, b in listed)


def test_a_step_lists_what_will_touch_before_its_end() -> None:
    """A box 3 mm above another falls at 0.2 m/s: it touches within 1/60 s, with gravity at 0.1 m/s too, and not at rest
    beside the other box."""
    lower, upper = Brick(PLANK, 1.0, (0.0, 0.0, 0.0)), Brick(PLANK, 1.0, (0.0, 0.0, PLANK[2] + 3e-3))
    boxes = boxes_of(lower, upper)
    detector = BoxDetector(1.0)
    assert len(detector.find(boxes, NO_GRAVITY, 1 / 60)) == 0
    boxes.velocity[2] = 0.0, 0.0, -0.2
    assert len(detector.find(boxes, NO_GRAVITY, 1 / 60)) == 4
    boxes.velocity[2] = 0.0, 0.0, -0.1
    assert len(detector.find(boxes, NO_GRAVITY, 1 / 60)) == 0
    assert len(detector.find(boxes, np.array([0.0, 0.0, -9.81]), 1 / 60)) == 4
