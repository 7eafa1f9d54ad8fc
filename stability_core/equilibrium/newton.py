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
from stability_core.equilibrium.cone import derivative, project
from stability_core.equilibrium.envelope import Envelope, envelope_of, factorize, numbering, substitute
from stability_core.equilibrium.problem import (
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
BALANCED = 1e-9
"""Imbalance, relative to the largest force on the body, that counts as none: rounding leaves about 1e-12."""
STRONGEST = 1e6
"""Equilibria are refused that need a force this many times all weight: no wedge is that stiff."""
CONVERGED = 1e-14
"""Newton's decrement, relative to what is minimised, at which a proximal point is reached."""
PROXIMAL_POINTS = 12
NEWTON_STEPS = 60
RAY_STEPS = 40
"""A pile takes 5 to 20 steps in all; one that takes more lies at the very limit."""


class Workspace(NamedTuple):
    """What the steps of one problem share."""

    rows: IntArray
    """The components of force and moment that are not nought by themselves, shape (k,)."""
    place: IntArray
    """Place of each body in the matrix, shape (n,)."""
    envelope: Envelope
    matrix: FloatArray
    step: FloatArray
    """Right side and solution of the linear system, shape (n k,)."""
    dy: FloatArray
    """The same as a motion, shape (n, 6)."""
    z: FloatArray
    """A^T y, shape (m, 3)."""
    dz: FloatArray
    """A^T dy, shape (m, 3)."""
    trial: FloatArray
    """Vectors along the line, shape (m, 3)."""


@compiled
def _workspace(problem: Problem, rows: IntArray) -> Workspace:
    n, m, width = len(problem.load), len(problem.normal), len(rows)
    place = numbering(problem.body_a, problem.body_b, n)
    envelope = envelope_of(problem.body_a, problem.body_b, place, width)
    return Workspace(
        rows,
        place,
        envelope,
        np.empty(envelope.size),
        np.empty(n * width),
        np.zeros((n, 6)),
        np.empty((m, 3)),
        np.empty((m, 3)),
        np.empty((m, 3)),
    )


@compiled
def _wrench(direction: FloatArray, lever: FloatArray, sign: float, rows: IntArray, wrench: FloatArray) -> None:
    """The ``rows`` of the force and moment that a unit force in ``direction`` exerts at ``lever``."""
    for k in range(len(rows)):
        row = rows[k]
        if row < 3:
            wrench[k] = sign * direction[row]
        else:
            i, j = (row + 1) % 3, (row + 2) % 3
            wrench[k] = sign * (lever[i] * direction[j] - lever[j] * direction[i])


@compiled
def _add_product(space: Workspace, i: int, j: int, weight: float, left: FloatArray, right: FloatArray) -> None:
    """Add weight left right^T to the block of the bodies in places i >= j; the upper half of a diagonal is left out."""
    width = len(left)
    for k in range(width):
        at = space.envelope.offset[i * width + k] + j * width
        for h in range(k + 1 if i == j else width):
            space.matrix[at + h] += weight * left[k] * right[h]


@compiled
def _assemble(problem: Problem, space: Workspace, rho: float) -> None:
    """The generalised Hessian A P_K'(z) A^T + rho 1 at ``space.z``, written to ``space.matrix``."""
    width = len(space.rows)
    direction, weight = np.empty((3, 3)), np.empty(3)
    on_a, on_b = np.empty(width), np.empty(width)
    space.matrix[:] = 0.0
    for i in range(len(space.step)):
        space.matrix[space.envelope.offset[i] + i] = rho
    for c in range(len(problem.normal)):
        terms = derivative(space.z[c], problem.normal[c], problem.friction[c], direction, weight)
        a, b = problem.body_a[c], problem.body_b[c]
        for k in range(terms):
            if a >= 0:
                _wrench(direction[k], problem.lever_a[c], -1.0, space.rows, on_a)
                _add_product(space, space.place[a], space.place[a], weight[k], on_a, on_a)
            if b >= 0:
                _wrench(direction[k], problem.lever_b[c], 1.0, space.rows, on_b)
                _add_product(space, space.place[b], space.place[b], weight[k], on_b, on_b)
            if a >= 0 and b >= 0:
                if space.place[a] > space.place[b]:
                    _add_product(space, space.place[a], space.place[b], weight[k], on_a, on_b)
                else:
                    _add_product(space, space.place[b], space.place[a], weight[k], on_b, on_a)


@compiled
def _slope(problem: Problem, z: FloatArray, dz: FloatArray, t: float, work: FloatArray, force: FloatArray) -> float:
    """Slope of |P_K|^2 / 2 along the line z + t dz."""
    for c in range(len(z)):
        for k in range(3):
            work[c, k] = z[c, k] + t * dz[c, k]
    project(work, problem.normal, problem.friction, force)
    total = 0.0
    for c in range(len(z)):
        total += force[c, 0] * dz[c, 0] + force[c, 1] * dz[c, 1] + force[c, 2] * dz[c, 2]
    return total


@compiled
def _line_search(
    problem: Problem, z: FloatArray, dz: FloatArray, constant: float, linear: float, work: FloatArray, force: FloatArray
) -> float:
    """How far to go along dz: the whole way unless that overshoots, else to where the slope has nearly vanished.

    The slope along the line, ``constant`` + ``linear`` t + that of |P_K|^2 / 2, rises with t.
    """
    low, high = 0.0, 1.0
    at_low = constant + _slope(problem, z, dz, 0.0, work, force)
    at_high = constant + linear + _slope(problem, z, dz, 1.0, work, force)
    enough = 0.1 * abs(at_low)
    if at_high <= enough:
        return 1.0
    t = 1.0
    for _ in range(30):
        t = low - at_low * (high - low) / (at_high - at_low)
        t = min(max(t, low + 0.02 * (high - low)), high - 0.02 * (high - low))
        at = constant + linear * t + _slope(problem, z, dz, t, work, force)
        if abs(at) <= enough:
            break
        if at < 0.0:
            low, at_low = t, at
        else:
            high, at_high = t, at
    return t


@compiled
def _minimise(
    problem: Problem,
    space: Workspace,
    rho: float,
    steps: int,
    center: FloatArray,
    y: FloatArray,
    force: FloatArray,
    rest: FloatArray,
) -> None:
    """Move ``y`` to the minimum of |P_K(A^T y)|^2 / 2 - w . y + rho |y - center|^2 / 2.

    Takes at most ``steps`` steps. Writes the forces P_K(A^T y) and what they leave unbalanced, and ends early when
    they are balanced.
    """
    rows, place, step, dy = space.rows, space.place, space.step, space.dy
    n, width = len(y), len(rows)
    along_contacts(problem, y, space.z)
    project(space.z, problem.normal, problem.friction, force)
    imbalance(problem, force, rest)
    for _ in range(steps):
        for i in range(n):
            for k in range(width):
                row = rows[k]
                step[place[i] * width + k] = rest[i, row] - rho * (y[i, row] - center[i, row])
        _assemble(problem, space, rho)
        factorize(space.matrix, space.envelope)
        substitute(space.matrix, space.envelope, step)
        constant, linear, decrement, size = 0.0, 0.0, 0.0, 0.0
        for i in range(n):
            for k in range(width):
                row = rows[k]
                moved = y[i, row] - center[i, row]
                dy[i, row] = step[place[i] * width + k]
                constant += dy[i, row] * (rho * moved - problem.load[i, row])
                linear += rho * dy[i, row] ** 2
                decrement += dy[i, row] * (rest[i, row] - rho * moved)
                size += rho * moved**2
        for c in range(len(force)):
            size += force[c, 0] ** 2 + force[c, 1] ** 2 + force[c, 2] ** 2
        along_contacts(problem, dy, space.dz)
        t = _line_search(problem, space.z, space.dz, constant, linear, space.trial, force)
        for i in range(n):
            for k in range(width):
                y[i, rows[k]] += t * dy[i, rows[k]]
        along_contacts(problem, y, space.z)
        project(space.z, problem.normal, problem.friction, force)
        imbalance(problem, force, rest)
        if decrement <= CONVERGED * size or greatest_imbalance(problem, force, rest) <= BALANCED:
            return


@compiled
def solve(problem: Problem, rows: IntArray) -> tuple[int, FloatArray, FloatArray, float]:
    """Forces that hold the bodies, or how they fall.

    A step costs O(m) and a factorisation (see ``envelope``).

    Args:
        problem: n bodies and m contacts.
        rows: the components of force and moment that are not nought by themselves, shape (k,): all six, or
            [2, 3, 4] where every force is vertical.

    Returns:
        HELD, FALLING or UNDECIDED; the forces on the second bodies [N], (m, 3), always in their cones; what they
        leave unbalanced, (n, 6), or the proof r if the bodies are FALLING; the greatest imbalance of a body relative
        to the largest force on it.
    """
    n, m = len(problem.load), len(problem.normal)
    space = _workspace(problem, rows)
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
    )
    before = np.inf
    for point in range(PROXIMAL_POINTS):
        rho = max(FIRST_RHO * 0.1**point, LAST_RHO)
        _minimise(problem, space, rho, NEWTON_STEPS, center, y, force, rest)
        worst = greatest_imbalance(problem, force, rest)
        if worst <= BALANCED:
            return HELD, force, rest, worst
        if worst > 0.5 * before:  # it does not shrink: perhaps there are no such forces
            ray[:] = rest
            for _ in range(RAY_STEPS):
                _minimise(without_load, space, RAY_RHO * rho, 1, rest, ray, resisted, unresisted)
                if weakest_equilibrium(problem, ray, space.trial, resisted) >= STRONGEST:
                    return FALLING, force, ray, worst
        before = worst
        center[:] = y
    return UNDECIDED, force, rest, before
