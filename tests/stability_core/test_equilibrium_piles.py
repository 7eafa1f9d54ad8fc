"""Random piles, level and leaning, against linear programmes by HiGHS: code of another kind and by other people.

A pyramid inscribed in the cone proves that a pile stands, one circumscribed that it falls; 32 sides leave half a
percent of friction between the two, where either verdict may be right.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy import sparse
from scipy.optimize import linprog

from stability_core import Contacts, Masses, solve_equilibrium
from tests.stability_core.piles import LENGTH, jostled_pile, level_pile, roofed_pair

SIDES = 32


def least_imbalance(contacts: Contacts, masses: Masses, gravity: np.ndarray, stretch: float) -> float:
    """Least sum of unbalanced forces and moments, over all weight; pyramids of mu ``stretch`` times the cone's."""
    n, m = len(masses.body), len(contacts)
    aside = np.eye(3)[np.argmin(np.abs(contacts.normal), axis=1)]
    first = np.cross(contacts.normal, aside)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    second = np.cross(contacts.normal, first)
    around = 2 * np.pi * np.arange(SIDES) / SIDES
    tangent = np.cos(around)[:, None, None] * first + np.sin(around)[:, None, None] * second
    edge = (contacts.normal + stretch * contacts.friction[:, None] * tangent).reshape(-1, 3)
    balance = sparse.lil_matrix((6 * n, SIDES * m))
    for sign, bodies in ((-1.0, contacts.body_a), (1.0, contacts.body_b)):
        for body in masses.body:
            columns = np.flatnonzero(np.tile(bodies == body, SIDES))
            lever = np.tile(contacts.point, (SIDES, 1))[columns] - masses.center_of_mass[body]
            part = sign * np.hstack([edge[columns], np.cross(lever, edge[columns]) / LENGTH])
            balance[6 * body : 6 * body + 6, columns] += part.T
    wanted = np.hstack([-masses.mass[:, None] * gravity, np.zeros((n, 3))]).ravel()
    wanted /= np.abs(wanted).sum()
    slack = sparse.identity(6 * n)
    return linprog(
        np.concatenate([np.zeros(SIDES * m), np.ones(12 * n)]),
        A_eq=sparse.hstack([balance, slack, -slack], format="csc"),
        b_eq=wanted,
        method="highs",
    ).fun


@pytest.mark.parametrize("make", [level_pile, jostled_pile, roofed_pair])
@pytest.mark.parametrize("slope", [0.0, 0.25])
def test_no_verdict_contradicts_the_linear_programmes(make, slope):
    """20 piles of a kind, in any orientation, on the level and on slopes; only a jam of friction may be a doubt."""
    for seed in range(20):
        random = np.random.default_rng([seed, int(100 * slope)])
        pile = make(random)
        turn, _ = np.linalg.qr(random.normal(size=(3, 3)))
        turn *= np.linalg.det(turn)
        angle, azimuth = random.uniform(0, slope), random.uniform(0, 2 * np.pi)
        fall = np.array([np.sin(angle) * np.cos(azimuth), np.sin(angle) * np.sin(azimuth), -np.cos(angle)])
        contacts, masses = pile.world(turn)
        found = solve_equilibrium(contacts, masses, 9.81 * turn @ fall)
        case = f"{make.__name__} {seed}: {found.verdict}, residual {found.residual:.1e}"
        if found.forces is None:
            assert found.verdict == "unstable", case
            outer = least_imbalance(contacts, masses, turn @ fall, 1 / np.cos(np.pi / SIDES))
            inner = outer if outer > 1e-6 else least_imbalance(contacts, masses, turn @ fall, 1.0)
            assert inner > 1e-6, case
        else:
            assert least_imbalance(contacts, masses, turn @ fall, 1 / np.cos(np.pi / SIDES)) < 1e-6, case
