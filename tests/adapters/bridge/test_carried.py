"""Contact points move with their bodies: checked against rotations by matrices."""

import numpy as np
import pytest

from adapters.bridge.carried import carried


def quaternion(axis: np.ndarray, angle: float) -> np.ndarray:
    return np.array([np.cos(angle / 2), *(np.sin(angle / 2) * axis)])


def matrix(q: np.ndarray) -> np.ndarray:
    w, x, y, z = q
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def test_points_and_normals_move_with_their_bodies() -> None:
    random = np.random.default_rng(1)
    bodies = np.array([3, 8])
    before, after = random.normal(size=(2, 2, 13))
    for states in (before, after):
        for state in states:
            axis = random.normal(size=3)
            state[3:7] = quaternion(axis / np.linalg.norm(axis), random.uniform(0, 3))
    rows = np.zeros((3, 14))
    rows[:, :2] = [[3, 8], [8, -1], [-2, 5]]
    rows[:, 2:11] = random.normal(size=(3, 9))
    points, normals, separations = carried(rows, bodies, before, after)
    for row, (a, b) in enumerate(rows[:, :2]):
        ends = []
        for body, place in ((a, slice(2, 5)), (b, slice(5, 8))):
            end, turn = rows[row, place], np.eye(3)
            if body in bodies:
                k = int(np.flatnonzero(bodies == body)[0])
                turn = matrix(after[k, 3:7]) @ matrix(before[k, 3:7]).T
                end = after[k, :3] + turn @ (end - before[k, :3])
            ends.append(end)
            if body == a:
                normal = turn @ rows[row, 8:11]
        assert points[row] == pytest.approx((ends[0] + ends[1]) / 2)
        assert normals[row] == pytest.approx(normal)
        assert separations[row] == pytest.approx((ends[1] - ends[0]) @ normal)


def test_points_of_the_end_of_a_substep_stay() -> None:
    states = np.zeros((1, 13))
    states[0, 3] = 1.0
    row = np.array([[0, -1, 1, 2, 3, 1, 2, 2, 0, 0, -1, 0, 0, 0]], np.float64)
    points, normals, separations = carried(row, np.array([0]), states, states)
    assert points.tolist() == [[1.0, 2.0, 2.5]]
    assert normals.tolist() == [[0.0, 0.0, -1.0]]
    assert separations.tolist() == [1.0]
