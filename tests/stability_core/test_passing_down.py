"""Vertical forces that pass from the top down: what they hold, and where they give up."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stability_core.equilibrium.passing_down import pass_down
from stability_core.equilibrium.problem import Problem, imbalance
from stability_core.equilibrium.verdict import decide

WEIGHT = 2.0


def pile(patches) -> Problem:
    """Bodies of 2 N each on level contacts: (lower or -1, upper, points relative to the centre of each)."""
    body_a, body_b, lever_a, lever_b = [], [], [], []
    for lower, upper, points in patches:
        for on_lower, on_upper in points:
            body_a.append(lower)
            body_b.append(upper)
            lever_a.append((*on_lower, 0.1))
            lever_b.append((*on_upper, -0.1))
    m, n = len(body_a), max(body_b) + 1
    load = np.zeros((n, 6))
    load[:, 2] = WEIGHT
    normal = np.tile((0.0, 0.0, 1.0), (m, 1))
    return Problem(
        *(np.array(body_a), np.array(body_b), np.array(lever_a), np.array(lever_b)),
        *(normal, np.zeros(m), load, np.zeros(n)),
    )


def face(lower: int, upper: int, low: float, high: float, at_lower: float = 0.0, at_upper: float = 0.0):
    """Four corners of a patch from ``low`` to ``high`` along x, 0.2 deep."""
    corners = [(x, y) for x in (low, high) for y in (-0.1, 0.1)]
    return lower, upper, [((x - at_lower, y), (x - at_upper, y)) for x, y in corners]


def test_a_column_presses_with_all_that_is_above():
    problem = pile([face(body - 1, body, -0.5, 0.5) for body in range(20)])
    held, force, rest, worst = pass_down(problem)
    assert held
    assert worst < 1e-12
    assert np.abs(rest).max() < 1e-11
    assert force[:, 2] == pytest.approx(np.repeat(np.arange(20, 0, -1) * WEIGHT / 4, 4))


def test_a_plank_beyond_its_edge_is_not_held():
    held, *_ = pass_down(pile([face(-1, 0, 0.01, 0.5)]))
    assert not held


def test_a_line_of_contacts_bears_what_lies_above_it():
    line = (-1, 0, [((x, 0.0), (x, 0.0)) for x in (-0.5, 0.5)])
    assert pass_down(pile([line]))[0]
    beside = (-1, 0, [((x, 0.0), (x, 0.01)) for x in (-0.5, 0.5)])
    assert not pass_down(pile([beside]))[0]


def test_a_body_that_must_press_otherwise_than_evenly_is_left_to_the_solve():
    """C lies on B's outer end and on D, which can bear all of it; evenly shared, its load tips B over its edge."""
    problem = pile(
        [
            face(-1, 0, -0.5, 0.02),
            face(-1, 1, 0.5, 1.5, at_upper=1.0),
            face(0, 2, 0.35, 0.45, at_upper=1.0),
            face(1, 2, 0.95, 1.5, at_lower=1.0, at_upper=1.0),
        ]
    )
    assert not pass_down(problem)[0]
    assert decide(problem, np.ones(len(problem.normal), np.bool_))[0] == "stable"


@given(st.integers(0, 10_000))
def test_what_is_passed_down_is_an_equilibrium_of_pressing_forces(seed: int):
    """Random walls, of which some fall."""
    random = np.random.default_rng(seed)
    rows, patches, at = 1 + random.integers(4), [], []
    for row in range(rows):
        for place in range(3):
            body, x = len(at), place + random.uniform(-0.3, 0.3)
            at.append(x)
            if row == 0:
                patches.append(face(-1, body, x - 0.5, x + 0.5, at_upper=x))
            for below in range(3 * (row - 1), 3 * row) if row else ():
                low, high = max(x, at[below]) - 0.5, min(x, at[below]) + 0.5
                if high - low > 0.02:
                    patches.append(face(below, body, low, high, at_lower=at[below], at_upper=x))
    problem = pile(patches)
    held, force, _, worst = pass_down(problem)
    if not held:
        return
    rest = np.empty((len(problem.load), 6))
    imbalance(problem, force, rest)
    assert (force[:, 2] >= 0.0).all()
    assert not force[:, :2].any()
    assert np.abs(rest).max() <= 1e-9 * np.abs(force).max() * len(at)
    assert worst <= 1e-9
