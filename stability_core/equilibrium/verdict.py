"""Stable, unstable or doubt: which of the two proofs there is, and whether the forces would really arise."""

from __future__ import annotations

from typing import Literal, TypeAlias

import numpy as np

from stability_core.equilibrium.correction import correct
from stability_core.equilibrium.newton import FALLING, HELD, STRONGEST, solve
from stability_core.equilibrium.problem import (
    BoolArray,
    Problem,
    held_by_the_rest,
    joined,
    weakest_equilibrium,
    with_neighbours,
)
from stability_core.port import FloatArray

Verdict: TypeAlias = Literal["stable", "unstable", "doubt"]
Answer: TypeAlias = tuple[Verdict, FloatArray | None, FloatArray, float]

ALL_ROWS = np.arange(6)
VERTICAL_ROWS = np.array([2, 3, 4])
"""A vertical force has no part in the others: F_z, M_x, M_y."""
OTHER_ROWS = np.array([0, 1, 5])
FIRST_STEPS, MORE_STEPS = 3, 9
"""Steps of the correction, before and after a look at the neighbours of what changed. A plank more on a card house of
100 takes 1 to 5 steps, a load of 20 planks' weight off its centre 12."""
FEW = 0.25
"""Share of the bodies up to which neighbours are looked at: more would cost as much as the steps do."""
MOVES = 1e-2
"""Share of the largest unbalanced force below which a body does not take part in a mechanism."""


def takes_part(rest: FloatArray) -> BoolArray:
    """Which bodies move in a mechanism, or are left unbalanced by a failed search, (n,), from the ``rest`` (n, 6)."""
    unbalanced = np.abs(rest).max(axis=1, initial=0.0)
    moves: BoolArray = unbalanced > MOVES * unbalanced.max(initial=0.0)
    return moves


def decide(
    problem: Problem, level: BoolArray, start: FloatArray | None = None, changed: BoolArray | None = None
) -> Answer:
    """Whether what changed falls by itself; if not, correct the forces of before; only then start from scratch.

    The first is decided by the changed bodies alone. The correction takes one to four steps for nearly all that
    stands; while it goes on, what it leaves unbalanced is looked at as well: it may fall by itself. See ``correction``
    and ``newton`` for a step.

    Args:
        problem: n bodies and m contacts, z up.
        level: contacts whose cone contains the vertical, shape (m,).
        start: forces that nearly hold the bodies [N], shape (m, 3), or None.
        changed: bodies that were added, moved, or lost a neighbour since the rest was found to stand without
            self-stress, shape (n,); None for all.

    Returns:
        The verdict; forces (m, 3) that hold the bodies, or nearly if they are "unstable", or None; what vertical
        forces, or for "unstable" any forces, leave unbalanced, (n, 6): not nought for the bodies that fall, or that
        would without friction; the greatest imbalance of a body relative to the largest force on it.
    """
    if start is None:
        start = np.zeros_like(problem.normal)
    if changed is None:
        changed = np.ones(len(problem.load), np.bool_)
    falls = _falls_by_itself(problem, changed)
    if falls is not None:
        return falls
    are_vertical = level.all() and _is_vertical(problem.load)
    aim, rows = (_along(problem, level, _verticals(problem)), VERTICAL_ROWS) if are_vertical else (problem, ALL_ROWS)
    y = np.zeros_like(problem.load)
    held, force, rest, residual = correct(aim, rows, start, y, FIRST_STEPS)
    if not held:
        falls = _falls_with_neighbours(problem, changed)
        if falls is not None:
            return falls
        held, force, rest, residual = correct(aim, rows, start, y, MORE_STEPS)
    if held:
        if are_vertical or _stands_without_self_stress(problem, level, changed):
            return "stable", force, rest, residual
    else:
        falls = _falls_by_itself(problem, takes_part(rest))
        if falls is not None:
            return falls
    return _decide_from_scratch(problem, level, changed)


def _falls_with_neighbours(problem: Problem, changed: BoolArray) -> Answer | None:
    """The proof that the ``changed`` bodies, (n,), fall with those nearby, further and further out; None if none."""
    moves = changed
    while True:
        more = with_neighbours(problem, moves)
        if more.mean() > FEW or (more == moves).all():
            return None
        moves = more
        falls = _falls_by_itself(problem, moves)
        if falls is not None:
            return falls


def _falls_by_itself(problem: Problem, moves: BoolArray) -> Answer | None:
    """The proof that some of the bodies that may move, (n,), fall even if all others are fixed; None if they do not."""
    if moves.all() or not moves.any():
        return None
    part, theirs = held_by_the_rest(problem, moves)
    weaker = np.abs(problem.load).sum() / np.abs(part.load).sum()
    verdict, near, ray, residual = solve(part, ALL_ROWS, STRONGEST * weaker)
    if verdict != FALLING:
        return None
    motion, force = np.zeros_like(problem.load), np.zeros_like(problem.normal)
    motion[moves], force[theirs] = ray, near
    work = np.empty_like(force)
    if weakest_equilibrium(problem, motion, work, np.empty_like(work)) < STRONGEST:
        return None
    return "unstable", force, motion, residual


def _is_vertical(load: FloatArray) -> bool:
    """True if no load (n, 6) asks for other than vertical forces."""
    return not load[:, OTHER_ROWS].any()


def _decide_from_scratch(problem: Problem, level: BoolArray, changed: BoolArray) -> Answer:
    """Try vertical forces on level contacts first, at an eighth of the cost, then all that the cones allow."""
    verdict, force, rest, residual = solve(_along(problem, level, _verticals(problem)), VERTICAL_ROWS, STRONGEST)
    if verdict == HELD and _is_vertical(problem.load):
        forces = np.zeros((len(level), 3))
        forces[level] = force
        return "stable", forces, rest, residual
    verdict, force, ray, residual = solve(problem, ALL_ROWS, STRONGEST)
    if verdict == FALLING:
        return "unstable", force, ray, residual
    if verdict == HELD:
        natural = _stands_without_self_stress(problem, level, changed)
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


def _stands_without_self_stress(problem: Problem, level: BoolArray, changed: BoolArray) -> bool:
    """True if what does not lean would stand on forces along the normals or the vertical alone.

    A body leans if it stands on a level contact and touches something that is not level: as it begins to fall it
    presses on both, so that the forces that hold it do arise. Leaning bodies count as held here. They divide the
    others into parts, of which only those with a ``changed`` body (n,) are solved. What pushes sideways (bodies that
    fall from what stands here, no weight) is left to friction.
    """
    n = len(problem.load)
    stands, touches = np.zeros(n + 1, np.bool_), np.zeros(n + 1, np.bool_)  # the last row is the ground's
    for index, upward in ((problem.body_a, -problem.normal[:, 2]), (problem.body_b, problem.normal[:, 2])):
        stands[index[level & (upward > 0.0)]] = True
        touches[index[~level]] = True
    upright = ~(stands & touches)[:n]
    direction = np.where(level[:, None], _verticals(problem), problem.normal)
    part, theirs = held_by_the_rest(problem, joined(problem, changed, upright))
    along = _along(part, np.ones(len(part.normal), np.bool_), direction[theirs])
    along.load[:, OTHER_ROWS] = 0.0
    return solve(along, VERTICAL_ROWS if level[theirs].all() else ALL_ROWS, STRONGEST)[0] == HELD
