"""The contact problem in scaled velocities states the mechanics of the bodies that it was made from."""

from __future__ import annotations

import numpy as np

from adapters.reference.boxes import FIXED, LIVE, MOVED, BoxArrays
from adapters.reference.contact_rows import EARTH, contact_rows, set_velocities
from adapters.reference.detector import BoxDetector, FoundContacts
from adapters.reference.impulse_matching import moved_to
from adapters.reference.motion import advance
from scenarios.model import Brick

SEED = 20081
STEP = 1 / 60
GRAVITY = np.array([0.3, -0.2, -9.0])
PLANK = (0.117, 0.0234, 0.0078)


def scattered() -> tuple[BoxArrays, FoundContacts]:
    """Return ten boxes that overlap at random, moving: one is fixed, and the host moves another."""
    draws = np.random.default_rng(SEED)
    boxes = BoxArrays(0)
    for body in range(10):
        w, x, y, z = (turn := draws.normal(size=4)) / np.linalg.norm(turn)
        px, py, pz = draws.uniform(-0.02, 0.02, 3)
        boxes.add(body, Brick(PLANK, float(draws.uniform(0.5, 2.0)), (px, py, pz), (w, x, y, z)), LIVE)
    boxes.set_state(3, FIXED)
    boxes.set_state(5, MOVED)
    for body in (0, 1, 2, 4, 5, 6, 7, 8, 9):
        boxes.velocity[body + 1], boxes.spin[body + 1] = draws.normal(size=3), draws.normal(size=3)
    return boxes, BoxDetector(1.0).find(boxes, GRAVITY, STEP)


def velocity_at(boxes: BoxArrays, row: int, point: np.ndarray) -> np.ndarray:
    return boxes.velocity[row] + np.cross(boxes.spin[row], point - boxes.position[row])


def test_rows_give_the_relative_velocity_at_each_point() -> None:
    boxes, found = scattered()
    unit = EARTH * STEP
    problem = contact_rows(boxes, found, np.zeros(3), STEP, unit)
    assert {3, 5} <= {int(row) - 1 for row in np.concatenate([found.row_a, found.row_b])}
    for c in range(len(found)):
        of_rows = problem.drive[c].copy()
        for side in range(2):
            if problem.body[c, side] >= 0:
                of_rows += problem.jacobian[c, :, side] @ problem.start[problem.body[c, side]]
        a, b, point = int(found.row_a[c]), int(found.row_b[c]), found.point[c]
        relative = velocity_at(boxes, b, point) - velocity_at(boxes, a, point)
        np.testing.assert_allclose(of_rows * unit, problem.axes[c] @ relative, atol=1e-12)
        np.testing.assert_allclose(problem.axes[c] @ problem.axes[c].T, np.eye(3), atol=1e-12)


def test_scaled_velocities_hold_the_kinetic_energy_and_come_back() -> None:
    boxes, found = scattered()
    problem = contact_rows(boxes, found, np.zeros(3), STEP, EARTH * STEP)
    linear = float((boxes.mass[problem.rows, None] * boxes.velocity[problem.rows] ** 2).sum())
    before = boxes.velocity[problem.rows].copy(), boxes.spin[problem.rows].copy()
    boxes.spin[problem.rows] = 0.0
    resting = contact_rows(boxes, found, np.zeros(3), STEP, EARTH * STEP)
    unit = resting.impulse_unit * resting.velocity_unit
    np.testing.assert_allclose((resting.start**2).sum() * unit, linear, rtol=1e-12)
    boxes.velocity[:] = 0.0
    set_velocities(boxes, problem, problem.start)
    np.testing.assert_allclose(boxes.velocity[problem.rows], before[0], atol=1e-12)
    np.testing.assert_allclose(boxes.spin[problem.rows], before[1], atol=1e-12)


def test_an_impulse_changes_momentum_by_itself() -> None:
    """A unit impulse along a row changes the momentum of b by the row's direction, and that of a by the opposite."""
    boxes, found = scattered()
    problem = contact_rows(boxes, found, GRAVITY, STEP, EARTH * STEP)
    boxes.velocity[:] = 0.0
    boxes.spin[:] = 0.0
    contact = next(c for c in range(len(found)) if (problem.body[c] >= 0).all())
    scaled = np.zeros_like(problem.start)
    for side in range(2):
        scaled[problem.body[contact, side]] = problem.jacobian[contact, 1, side]
    set_velocities(boxes, problem, scaled)
    for row, sign in ((int(found.row_a[contact]), -1.0), (int(found.row_b[contact]), 1.0)):
        momentum = boxes.mass[row] * boxes.velocity[row] / problem.impulse_unit
        np.testing.assert_allclose(momentum, sign * problem.axes[contact, 1], atol=1e-12)


def test_the_first_tangent_follows_what_slides_or_would_slide() -> None:
    boxes = BoxArrays(0)
    boxes.add(0, Brick(PLANK, 1.0, (0.0, 0.0, 0.0)), FIXED)
    boxes.add(1, Brick(PLANK, 1.0, (0.0, 0.0, PLANK[2])), LIVE)
    found = BoxDetector(1.0).find(boxes, GRAVITY, STEP)
    pulled = contact_rows(boxes, found, GRAVITY, STEP, EARTH * STEP).axes[:, 1]
    np.testing.assert_allclose(pulled, [np.array([0.3, -0.2, 0.0]) / np.hypot(0.3, 0.2)] * 4, atol=1e-12)
    boxes.velocity[2] = -3.0, 4.0, 0.0
    sliding = contact_rows(boxes, found, np.array([0.0, 0.0, -9.81]), STEP, EARTH * STEP).axes[:, 1]
    np.testing.assert_allclose(sliding, [(-0.6, 0.8, 0.0)] * 4, atol=1e-12)


def test_a_body_in_free_flight_keeps_its_angular_momentum_and_never_gains_energy() -> None:
    """A plank spins at 10 rad/s about no principal axis, for two seconds."""
    boxes = BoxArrays(0)
    boxes.add(0, Brick(PLANK, 1.0, (0.0, 0.0, 0.0)), LIVE)
    boxes.spin[1] = 6.0, 7.0, 4.0
    energies, momenta = [], []
    for _ in range(120):
        rows = np.array([1])
        problem = contact_rows(boxes, BoxDetector(1.0).find(boxes, np.zeros(3), STEP), np.zeros(3), STEP, 1.0)
        energies.append(float((problem.start**2).sum()))
        w, x, y, z = boxes.quaternion[rows[0]]
        turn = np.array(
            [
                [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
            ]
        )
        momenta.append(turn @ (boxes.inertia[1] * (turn.T @ boxes.spin[1])))
        advance(boxes, STEP)
    assert np.all(np.diff(energies) <= 1e-12 * energies[0])
    directions = np.array(momenta) / np.linalg.norm(momenta, axis=1)[:, None]
    np.testing.assert_allclose(directions, [directions[0]] * 120, atol=1e-9)


def test_impulses_move_to_the_nearest_point_of_their_pair_and_keep_their_sum() -> None:
    _, found = scattered()
    values = np.random.default_rng(SEED).normal(size=(len(found), 3))
    np.testing.assert_array_equal(moved_to(found, found, values), values)
    fewer = FoundContacts(*(column[::2] for column in (found.row_a, found.row_b, found.point, found.normal, found.gap)))
    moved = moved_to(fewer, found, values)
    for pair in {(int(a), int(b)) for a, b in zip(fewer.row_a, fewer.row_b, strict=True)}:
        of_pair = (found.row_a == pair[0]) & (found.row_b == pair[1])
        kept = (fewer.row_a == pair[0]) & (fewer.row_b == pair[1])
        np.testing.assert_allclose(moved[kept].sum(axis=0), values[of_pair].sum(axis=0), atol=1e-12)
