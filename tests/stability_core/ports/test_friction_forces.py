"""Friction that an engine does not report is found from what the bodies' change of momentum leaves."""

from __future__ import annotations

import numpy as np
import pytest

from stability_core.ports.shared.friction_forces import Borne, with_friction

UP = (0.0, 0.0, 1.0)


def solve(
    pairs, normals, pressed, borne: dict[int, tuple], friction: float = 0.5, *, points=None, centers=None, turning=1e9
) -> np.ndarray:
    """Return the forces on bodies b; without ``points`` every body turns, so that moments do not count."""
    body_a, body_b = np.array(pairs, np.int64).T
    normal = np.array(normals, float)
    force = normal * np.array(pressed, float)[:, None]
    bodies = np.array(sorted(borne))
    sums = np.array([borne[body] for body in bodies.tolist()], float)
    if points is None:
        points, centers = np.ones((len(force), 3)), np.zeros((len(bodies), 3))
    known = Borne(bodies, sums, np.array(centers, float), np.full(len(bodies), float(turning)))
    return with_friction((body_a, body_b), np.array(points, float), normal, force, np.full(len(force), friction), known)


def test_a_column_hands_a_push_down_to_the_ground() -> None:
    """The top one of three bricks of 10 N is pushed by 2 N: every joint bears -2 N, shared by its two points as they
    are loaded.
    """
    pairs = [(-1, 0), (-1, 0), (0, 1), (1, 2)]
    borne = {0: (0, 0, 10), 1: (0, 0, 10), 2: (-2, 0, 10)}
    force = solve(pairs, [UP] * 4, [20, 10, 20, 10], borne)
    assert force[:, 0] == pytest.approx([-4 / 3, -2 / 3, -2, -2], abs=1e-3)
    assert force[:, 1] == pytest.approx([0, 0, 0, 0], abs=1e-3)
    assert force[:, 2] == pytest.approx([20, 10, 20, 10], abs=1e-3)


def test_the_load_of_a_frozen_body_is_found_from_its_live_neighbour() -> None:
    """Body 5 is frozen and so not among those whose momentum is known; it is b here, so the force on it is +3 N."""
    force = solve([(7, 5)], [(0, 0, -1)], [10], {7: (-3, 0, 10)})
    assert force[0] == pytest.approx([3, 0, -10], abs=1e-3)


def test_friction_stays_within_its_cone() -> None:
    """A brick of 10 N that is braked by 8 N, of which friction can be 5 N: something else brakes it."""
    force = solve([(-1, 0)], [UP], [10], {0: (-8, 0, 10)})
    assert force[0] == pytest.approx([-5, 0, 10], abs=1e-3)


def test_two_supports_share_friction_as_they_are_loaded() -> None:
    force = solve(
        [(-1, 0), (-1, 1), (0, 2), (1, 2)], [UP] * 4, [13, 17, 3, 7], {0: (0, 0, 10), 1: (0, 0, 10), 2: (-2, 0, 10)}
    )
    assert force[2:, 0].sum() == pytest.approx(-2, abs=1e-3)
    assert force[0, 0] == pytest.approx(force[2, 0], abs=1e-3)


def test_a_steep_contact_has_friction_across_its_normal() -> None:
    slope = np.array([np.sin(0.3), 0, np.cos(0.3)])
    force = solve([(-1, 0)], [slope], [10 * np.cos(0.3)], {0: (0, 0, 10)})
    assert force[0] == pytest.approx([0, 0, 10], abs=1e-3)


LEANING = [(-1, 0), (-1, 1), (0, 2), (1, 2)]
"""Two cards of 4 N lean outwards, 1 across and 2 high, under a roof of 10 N."""
FEET = [(-1, 0, 0), (1, 0, 0), (-2, 0, 2), (2, 0, 2)]
CENTERS = [(-1.5, 0, 1), (1.5, 0, 1), (0, 0, 2.5)]
WEIGHTS = {0: (0, 0, 4), 1: (0, 0, 4), 2: (0, 0, 10)}


def test_the_thrust_of_leaning_cards_follows_from_the_balance_of_moments() -> None:
    """Roof and weight turn a card outwards about its foot by 5 N * 1 + 4 N * 0.5: the roof holds its top by 7 / 2 N."""
    force = solve(LEANING, [UP] * 4, [9, 9, 5, 5], WEIGHTS, points=FEET, centers=CENTERS, turning=0, friction=0.9)
    assert force[:, 0] == pytest.approx([-3.5, 3.5, -3.5, 3.5], abs=1e-2)
    assert force[:, 2] == pytest.approx([9, 9, 5, 5], abs=1e-3)


def test_the_moments_of_cards_that_turn_do_not_count() -> None:
    force = solve(LEANING, [UP] * 4, [9, 9, 5, 5], WEIGHTS, points=FEET, centers=CENTERS, turning=100, friction=0.9)
    assert force[:, 0] == pytest.approx([0, 0, 0, 0], abs=1e-3)


def test_a_brick_that_rests_unevenly_gets_no_thrust() -> None:
    """Its two points press at equal distance with 6 N and 4 N: no friction on one side of a brick can balance that."""
    force = solve(
        [(-1, 0), (-1, 0)],
        [UP] * 2,
        [6, 4],
        {0: (0, 0, 10)},
        points=[(-1, 0, 0), (1, 0, 0)],
        centers=[(0, 0, 0.05)],
        turning=0,
    )
    assert force[:, 0].sum() == pytest.approx(0, abs=0.1)


def test_nothing_is_added_where_nothing_is_known() -> None:
    assert with_friction(
        (np.array([-1]), np.array([3])),
        np.zeros((1, 3)),
        np.array([UP]),
        np.array([[0.0, 0.0, 4.0]]),
        np.array([0.5]),
        Borne(np.empty(0, np.int64), np.empty((0, 3)), np.empty((0, 3)), np.empty(0)),
    )[0] == pytest.approx([0, 0, 4])
