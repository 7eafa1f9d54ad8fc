"""Contact forces that hold a set of bodies, or the motion in which they fall: one semismooth Newton method for both.

Wanted are f_c in their cones K_c with A f = w (A f: force and moment that the contacts exert on each body, w: what
gravity asks them to hold). Of all such f the one of least norm is f = P_K(A^T y), where y minimises the convex

    |P_K(A^T y)|^2 / 2 - w . y + rho |y - y'|^2 / 2.

P_K is the projection onto the cones; the last term, about the latest y', is a proximal point method, which copes with
degenerate problems. What it leaves, r = w - A f = rho (y - y'), tends to nought if there are such forces, and else to
the shortest vector between w and what the contacts can do. That vector proves it: r . w > 0, while A^T r lies in the
polar of K, so that with -r as velocities gravity does work and no contact resists (Farkas). Before the limit A^T r
lies there nearly; the same method finds the nearest motion that lies there truly (w = 0, y' = r).
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
"""Weight of the proximal term against forces of weight 1: large at first, so that a pile which falls is not thrown
far, then tenfold less at each proximal point, for tall stacks that are all but balanced."""
RAY_RHO = 1e-4
"""The same in the search for a motion that no contact resists, over the weight with which it was found."""
STRONGEST = 1e6
"""Equilibria are refused that need a force this many times all weight: no wedge is that stiff."""
CONVERGED = 1e-14
"""Newton's decrement, relative to what is minimised, at which a proximal point is reached."""
PROXIMAL_POINTS = 12
ROUGH_POINTS, ROUGH_STEPS, ROUGHLY_BALANCED = 2, 5, 2e-3
"""Proximal points, steps and imbalance where an estimate of the forces is enough."""
NEWTON_STEPS = 60
RAY_STEPS = 40
"""A pile takes 5 to 20 steps in all; one that takes more lies at the very limit."""


class Search(NamedTuple):
    """Where a search has come to: overwritten from step to step."""

    center: FloatArray
    """The latest proximal point y', shape (n, 6)."""
    y: FloatArray
    """Shape (n, 6)."""
    force: FloatArray
    """P_K(A^T y), shape (m, 3)."""
    rest: FloatArray
    """What the forces leave unbalanced, shape (n, 6)."""


@compiled
def _minimise(problem: Problem, space: Workspace, rho: float, steps: int, search: Search) -> None:
    """Move y to the minimum of |P_K(A^T y)|^2 / 2 - w . y + rho |y - center|^2 / 2.

    Takes at most ``steps`` steps, and ends early when the forces are balanced.
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
def nearest_forces(problem: Problem, rows: IntArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Forces in the cones that hold the bodies, or as much of their load as contacts can, and what they leave.

    Nothing is proven: the search ends at an imbalance of ``ROUGHLY_BALANCED``.

    Args:
        problem: n bodies and m contacts.
        rows: as for ``solve``.
        y: where the search begins, shape (n, 6): noughts, or what it came to for much the same problem; overwritten.

    Returns:
        The forces, shape (m, 3); what is left unbalanced, shape (n, 6).
    """
    n, m = len(problem.load), len(problem.normal)
    space = workspace_for(problem, rows)
    center, rest, force = y.copy(), np.zeros((n, 6)), np.zeros((m, 3))
    search = Search(center, y, force, rest)
    for point in range(ROUGH_POINTS):
        for _ in range(ROUGH_STEPS):
            _minimise(problem, space, FIRST_RHO * 0.1**point, 1, search)
            if greatest_imbalance(problem, force, rest) <= ROUGHLY_BALANCED:
                return force, rest
        center[:] = y
    return force, rest


@compiled
def solve(problem: Problem, rows: IntArray, strongest: float) -> tuple[int, FloatArray, FloatArray, float]:
    """Forces that hold the bodies, or how they fall.

    A step costs O(m) and a factorisation (see ``envelope``).

    Args:
        problem: n bodies and m contacts.
        rows: the components of force and moment that are not nought by themselves, shape (k,): all six, or
            [2, 3, 4] where every force is vertical.
        strongest: the force, over all weight, from which on an equilibrium counts as none (see ``STRONGEST``).

    Returns:
        HELD, FALLING or UNDECIDED; the forces on the second bodies [N], (m, 3), always in their cones; what they
        leave unbalanced, (n, 6), or the proof r if the bodies are FALLING; the greatest imbalance of a body relative
        to the largest force on it.
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
        if worst > 0.5 * before:  # it does not shrink: perhaps there are no such forces
            ray[:] = rest
            for _ in range(RAY_STEPS):
                _minimise(without_load, space, RAY_RHO * rho, 1, mechanism)
                if weakest_equilibrium(problem, ray, space.trial, resisted) >= strongest:
                    return FALLING, force, ray, worst
        before = worst
        center[:] = y
    return UNDECIDED, force, rest, before
