"""Find contact forces that hold a set of bodies, or the motion in which the bodies fall, by a semismooth Newton method.

The search looks for forces f_c in their cones K_c with A f = w:

A f     force and moment that the contacts exert on each body
w       force and moment that the contacts must exert, because of gravity
f       = P_K(A^T y), the solution of least norm, where y minimises the convex function

|P_K(A^T y)|^2 / 2 - w . y + rho |y - y'|^2 / 2.

P_K is the projection onto the cones, and A K is the set of all A f with f in the cones. The last term has the weight
rho and the centre y', the latest proximal point. This term makes the search a proximal point method. This method also
solves degenerate problems.

- If forces in the cones balance w, the unbalanced rest r = w - A f = rho (y - y') tends to zero.
- If no forces in the cones balance w, r tends to the shortest vector between w and A K. This vector proves the fall
  (Farkas): r . w > 0, while A^T r lies in the polar of K. With velocities -r gravity does work, and no contact resists.

Before the limit, A^T r lies nearly in the polar. The same method, with w = 0 and y' = r, then finds the nearest
motion with A^T r in the polar, except for rounding.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stability_core.compiled import compiled
from stability_core.equilibrium.cone import project
from stability_core.equilibrium.linear import Workspace, factorize_at, solve_for, step_length, workspace_for
from stability_core.equilibrium.problem import (
    BALANCED,
    Problem,
    along_contacts,
    greatest_imbalance,
    imbalance,
    weakest_equilibrium,
)
from stability_core.port import FloatArray, IntArray

HELD, FALLING, UNDECIDED = 0, 1, 2

FIRST_RHO, LAST_RHO = 1e-3, 1e-12
"""First and last weight of the proximal term, relative to the term of the forces. The weight is large at first, so that
y stays small for a falling stack. The weight decreases tenfold at each proximal point, because tall stacks that are
almost balanced need a small weight."""
RAY_RHO = 1e-4
"""Weight of the proximal term in the search for a motion that no contact resists, over its weight in the search for
forces."""
STRONGEST = 1e6
"""Greatest ratio of a contact force to the weight of all bodies in an equilibrium that counts, because no real wedge
bears more."""
CONVERGED = 1e-14
"""Newton decrement, relative to the minimised function, up to which y counts as a proximal point."""
PROXIMAL_POINTS = 12
ROUGH_POINTS, ROUGH_STEPS, ROUGHLY_BALANCED = 2, 5, 2e-3
"""Limits for an estimate of the forces: number of proximal points, number of steps at each point, imbalance."""
NEWTON_STEPS = 60
RAY_STEPS = 40
"""Greatest numbers of steps, at one proximal point (NEWTON_STEPS) and in the search for a motion (RAY_STEPS). A stack
takes 5 to 20 steps in all, or more at its limit of stability."""


class Search(NamedTuple):
    """State of a search, which each step overwrites."""

    center: FloatArray
    """The latest proximal point y', shape (n, 6)."""
    y: FloatArray
    """Multipliers, shape (n, 6)."""
    force: FloatArray
    """Contact forces P_K(A^T y), shape (m, 3)."""
    rest: FloatArray
    """Unbalanced rest of the load, shape (n, 6)."""


@compiled
def _minimise(problem: Problem, space: Workspace, rho: float, steps: int, search: Search) -> None:
    """Move y towards the minimum of |P_K(A^T y)|^2 / 2 - w . y + rho |y - center|^2 / 2.

    The search takes at most ``steps`` steps. The search ends earlier at the minimum, or when the forces balance the
    load.
    """
    center, y, force, rest = search.center, search.y, search.force, search.rest
    along_contacts(problem, y, space.z)
    project(space.z, problem.normal, problem.friction, force)
    imbalance(problem, force, rest)
    for _ in range(steps):
        factorize_at(problem, space, rho)
        solve_for(problem, space, rest - rho * (y - center))
        decrement, size = 0.0, 0.0
        for i in range(len(y)):
            for k in space.rows:
                moved = y[i, k] - center[i, k]
                decrement += space.dy[i, k] * (rest[i, k] - rho * moved)
                size += rho * moved**2
        for c in range(len(force)):
            size += force[c, 0] ** 2 + force[c, 1] ** 2 + force[c, 2] ** 2
        y += step_length(problem, space, rho, y, center, force) * space.dy
        along_contacts(problem, y, space.z)
        project(space.z, problem.normal, problem.friction, force)
        imbalance(problem, force, rest)
        if decrement <= CONVERGED * size or greatest_imbalance(problem, force, rest) <= BALANCED:
            return


@compiled
def nearest_forces(problem: Problem, rows: IntArray, y: FloatArray, enough: float) -> tuple[FloatArray, FloatArray]:
    """Return forces in the cones that nearly hold the bodies, or approximate the nearest forces, and the rest.

    The result proves nothing, because the search ends at an imbalance of ``ROUGHLY_BALANCED``, or after a few steps.

    Args:
        problem: n bodies and m contacts.
        rows: as for ``solve``.
        y: start of the search, shape (n, 6): zeros, or the result for a similar problem. The function overwrites ``y``.
        enough: greatest component of the rest [N] at which the search ends as well.

    Returns:
        The forces, shape (m, 3), and the unbalanced rest, shape (n, 6).
    """
    n, m = len(problem.load), len(problem.normal)
    space = workspace_for(problem, rows)
    center, rest, force = y.copy(), np.zeros((n, 6)), np.zeros((m, 3))
    search = Search(center, y, force, rest)
    for point in range(ROUGH_POINTS):
        for _ in range(ROUGH_STEPS):
            _minimise(problem, space, FIRST_RHO * 0.1**point, 1, search)
            if np.abs(rest).max() <= enough or greatest_imbalance(problem, force, rest) <= ROUGHLY_BALANCED:
                return force, rest
        center[:] = y
    return force, rest


@compiled
def solve(problem: Problem, rows: IntArray, strongest: float) -> tuple[int, FloatArray, FloatArray, float]:
    """Find forces that hold the bodies, or the motion in which the bodies fall.

    A step costs O(m) and a factorisation (see ``envelope``).

    Args:
        problem: n bodies and m contacts.
        rows: components of force and moment that may differ from zero, shape (k,): all six, or [2, 3, 4] for vertical
            forces.
        strongest: limit on the ratio of the greatest contact force to the weight of all bodies (see ``STRONGEST``).

    Returns:
        Four values:

        - HELD, FALLING or UNDECIDED;
        - the forces on the second bodies [N], in their cones, shape (m, 3);
        - the unbalanced rest, or the proof r if the bodies are FALLING, shape (n, 6);
        - the greatest imbalance of a body relative to the largest force on it.
    """
    n, m = len(problem.load), len(problem.normal)
    space = workspace_for(problem, rows)
    y, center, rest, force = np.zeros((n, 6)), np.zeros((n, 6)), np.zeros((n, 6)), np.zeros((m, 3))
    ray, resisted, unresisted = np.zeros((n, 6)), np.zeros((m, 3)), np.zeros((n, 6))
    without_load = Problem(
        problem.body_a,
        problem.body_b,
        problem.lever_a,
        problem.lever_b,
        problem.normal,
        problem.friction,
        np.zeros((n, 6)),
        problem.slack,
    )
    search, mechanism = Search(center, y, force, rest), Search(rest, ray, resisted, unresisted)
    before = np.inf
    for point in range(PROXIMAL_POINTS):
        rho = max(FIRST_RHO * 0.1**point, LAST_RHO)
        _minimise(problem, space, rho, NEWTON_STEPS, search)
        worst = greatest_imbalance(problem, force, rest)
        if worst <= BALANCED:
            return HELD, force, rest, worst
        if worst > 0.5 * before:  # no progress: perhaps no forces hold the bodies
            ray[:] = rest
            for _ in range(RAY_STEPS):
                _minimise(without_load, space, RAY_RHO * rho, 1, mechanism)
                if weakest_equilibrium(problem, ray, space.trial, resisted) >= strongest:
                    return FALLING, force, ray, worst
        before = worst
        center[:] = y
    return UNDECIDED, force, rest, before
