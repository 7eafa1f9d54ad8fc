"""Stable, unstable or doubt: which of the two proofs there is, and whether the forces would really arise."""

from __future__ import annotations

from typing import Literal, TypeAlias

import numpy as np
import numpy.typing as npt

from stability_core.equilibrium.newton import FALLING, HELD, solve
from stability_core.equilibrium.problem import Problem
from stability_core.port import FloatArray

BoolArray: TypeAlias = npt.NDArray[np.bool_]
Verdict: TypeAlias = Literal["stable", "unstable", "doubt"]

ALL_ROWS = np.arange(6)
VERTICAL_ROWS = np.array([2, 3, 4])
"""A vertical force has no part in the others: F_z, M_x, M_y."""


def decide(problem: Problem, level: BoolArray) -> tuple[Verdict, FloatArray | None, FloatArray, float]:
    """Try vertical forces on level contacts first, at an eighth of the cost, then all that the cones allow.

    Args:
        problem: n bodies and m contacts, z up.
        level: contacts whose cone contains the vertical, shape (m,).

    Returns:
        The verdict; forces (m, 3) that hold the bodies, or None; what vertical forces, or for "unstable" any forces,
        leave unbalanced, (n, 6): not nought for the bodies that fall, or that would without friction; the greatest
        imbalance of a body relative to the largest force on it.
    """
    verdict, force, rest, residual = solve(_along(problem, level, _verticals(problem)), VERTICAL_ROWS)
    if verdict == HELD:
        forces = np.zeros((len(level), 3))
        forces[level] = force
        return "stable", forces, rest, residual
    verdict, force, ray, residual = solve(problem, ALL_ROWS)
    if verdict == FALLING:
        return "unstable", None, ray, residual
    if verdict == HELD:
        natural = _stands_without_self_stress(problem, level)
        return "stable" if natural else "doubt", force, rest, residual
    return "doubt", None, rest, residual


def _along(problem: Problem, kept: BoolArray, direction: FloatArray) -> Problem:
    """The problem with the ``kept`` contacts alone, each with forces along one direction only."""
    return Problem(
        problem.body_a[kept],
        problem.body_b[kept],
        problem.lever_a[kept],
        problem.lever_b[kept],
        direction[kept],
        np.zeros(np.count_nonzero(kept)),
        problem.load,
    )


def _verticals(problem: Problem) -> FloatArray:
    """Up or down for each contact, as its normal points, shape (m, 3)."""
    vertical = np.zeros_like(problem.normal)
    vertical[:, 2] = np.where(problem.normal[:, 2] >= 0.0, 1.0, -1.0)
    return vertical


def _stands_without_self_stress(problem: Problem, level: BoolArray) -> bool:
    """True if what does not lean would stand on forces along the normals or the vertical alone.

    A body leans if it stands on a level contact and touches something that is not level: as it begins to fall it
    presses on both, so that the forces that hold it do arise. Leaning bodies count as held here.
    """
    n = len(problem.load)
    stands, touches = np.zeros(n + 1, np.bool_), np.zeros(n + 1, np.bool_)  # the last row is the ground's
    for index, upward in ((problem.body_a, -problem.normal[:, 2]), (problem.body_b, problem.normal[:, 2])):
        stands[index[level & (upward > 0.0)]] = True
        touches[index[~level]] = True
    upright = ~(stands & touches)[:n]
    index = np.full(n + 1, -1)
    index[:n][upright] = np.arange(np.count_nonzero(upright))
    body_a, body_b = index[problem.body_a], index[problem.body_b]
    direction = np.where(level[:, None], _verticals(problem), problem.normal)
    rest = problem._replace(body_a=body_a, body_b=body_b, load=problem.load[upright])
    return solve(_along(rest, (body_a >= 0) | (body_b >= 0), direction), ALL_ROWS)[0] == HELD
