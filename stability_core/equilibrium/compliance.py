"""Displace bodies on compliant contacts under their loads, by Newton's method for one value of kappa.

See ``loading`` for the symbols, the contact law and the equation. A solution exists for every kappa, because contact
forces do no positive work. Friction that grows with the pressure makes the derivative unsymmetric, so that halved steps
may end in a local minimum of the imbalance. Rounds of friction bounds continue the search from this minimum:

1. The latest forces bound each contact's friction (Tresca's law).
2. The method displaces the bodies with these bounds. Without the term NORMAL_NOISE, the solution is the minimum of a
   convex energy.
3. The search with Coulomb's law starts again from the result.

Reference: N. Kikuchi, J. T. Oden, "Contact problems in elasticity", SIAM 1988, chapter 10, for the fixed point.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stability_core.compiled import compiled
from stability_core.equilibrium.envelope import Envelope, factorize_general, substitute_general
from stability_core.equilibrium.problem import Problem, along_contacts, imbalance
from stability_core.port import FloatArray, IntArray

NORMAL_NOISE = 1e-2
"""Ratio [rad] of closure to slip, up to which a closing contact has no pressure. Engines and single precision err by
1e-3 rad in normals, and by 1e-4 m in the points of bricks of some centimetres. The value is three standard deviations
of both errors."""
COULOMB = -1.0
"""Value of ``Case.bound`` for Coulomb's law: the bound on friction is proportional to the pressure."""
CONVERGED = 1e-7
"""Imbalance of a body, over its weight, up to which displacements count as a solution. The value is a hundred times the
rounding error of the forces (see ``loading.KAPPA``)."""
NEWTON_STEPS = 40
"""Greatest number of Newton steps from zero displacement, because standing stacks take 3 to 20 steps, and an arch of
200 blocks takes 30 steps."""
ROUNDS = 20
"""Greatest number of rounds of friction bounds for one value of kappa. Courses of touching bricks for which Newton's
method fails take 1 to 4 rounds from the last kappa with a solution."""
STALLS = 20
"""Greatest number of consecutive steps of the shortest length. The search for an arch of 200 blocks takes ten of these
steps before longer steps succeed again."""
SHORTEST_STEP = 1e-3
ENOUGH = 0.1
"""Least relative reduction of the imbalance by a step, over the step length (Armijo's rule)."""
ROLLING = 1e3
"""Inverse of the rotation at which the whole slack of a rolling body resists. This rotation is a thousandth of the
displacement of one contact under the mean weight."""
TINY = 1e-300
"""Value that replaces a displacement of zero in a division."""
ROTATIONAL = 1.0 / 3.0
"""Ratio of a body's moment of inertia to its mass times its size squared, as for a rod about its middle. The verdict
does not depend on this value."""


class Case(NamedTuple):
    """A problem of displacement, with one ratio of stiffnesses."""

    problem: Problem
    """The problem, with loads in units of their mean."""
    stiffness: float
    """Ratio of the tangential to the normal stiffness of the contacts."""
    bound: FloatArray
    """Bound on the friction of each contact [unit of load], independent of the pressure, shape (m,). A negative value
    stands for Coulomb's law."""
    place: IntArray
    """Place of each body in the matrix, shape (n,)."""
    envelope: Envelope


@compiled
def contact_law(case: Case, v: FloatArray, force: FloatArray, tangent: FloatArray) -> None:
    """Evaluate the contact law: the force on the second body at each contact, and its derivative.

    Args:
        case: a case with m contacts.
        v: relative displacements of the second body against the first, shape (m, 3).
        force: output, the forces, shape (m, 3).
        tangent: output, C = -d force / d v, shape (m, 3, 3). A contact with zero pressure and zero slip
            counts as sticking.
    """
    problem, stiffness = case.problem, case.stiffness
    e, row, column = np.empty(3), np.empty(3), np.empty(3)
    for c in range(len(v)):
        n, is_bound = problem.normal[c], case.bound[c] >= 0.0
        mu = 0.0 if is_bound else problem.friction[c]  # growth of friction with the pressure
        along = v[c, 0] * n[0] + v[c, 1] * n[1] + v[c, 2] * n[2]
        slip = 0.0
        for k in range(3):
            e[k] = v[c, k] - along * n[k]
            slip += e[k] ** 2
        slip = np.sqrt(slip)
        pressed = -along - NORMAL_NOISE * slip
        if pressed < 0.0:
            force[c] = 0.0
            tangent[c] = 0.0
            continue
        for k in range(3):
            e[k] = e[k] / slip if slip > 0.0 else 0.0
            row[k] = n[k] + NORMAL_NOISE * e[k]  # d pressed = -row . dv
        most = case.bound[c] if is_bound else mu * pressed
        sticks = stiffness * slip <= most
        drag = stiffness * slip if sticks else most
        across = stiffness if sticks else most / slip
        for k in range(3):
            force[c, k] = pressed * n[k] - drag * e[k]
            column[k] = n[k] if sticks else n[k] - mu * e[k]
        for k in range(3):
            for h in range(3):
                flat = (1.0 if k == h else 0.0) - n[k] * n[h]
                if not sticks:
                    flat -= e[k] * e[h]
                tangent[c, k, h] = column[k] * row[h] + across * flat


@compiled
def _wrenches(lever: FloatArray, matrix: FloatArray, right: FloatArray) -> None:
    """Write ``matrix`` (3, 3) times W (3, 6) to ``right`` (3, 6).

    For a body with velocity v and angular velocity w, W (v, w) = v + w x ``lever`` is the velocity of the contact.
    """
    for k in range(3):
        right[k, 0], right[k, 1], right[k, 2] = matrix[k, 0], matrix[k, 1], matrix[k, 2]
        right[k, 3] = matrix[k, 2] * lever[1] - matrix[k, 1] * lever[2]
        right[k, 4] = matrix[k, 0] * lever[2] - matrix[k, 2] * lever[0]
        right[k, 5] = matrix[k, 1] * lever[0] - matrix[k, 0] * lever[1]


@compiled
def _add_block(
    lower: FloatArray,
    upper: FloatArray,
    offset: IntArray,
    i: int,
    j: int,
    sign: float,
    lever: FloatArray,
    right: FloatArray,
) -> None:
    """Add sign W^T right (6, 6) to the block of the bodies in places i and j, with W as in ``_wrenches``."""
    for h in range(6):
        x, y, z = right[0, h], right[1, h], right[2, h]
        moment = (lever[1] * z - lever[2] * y, lever[2] * x - lever[0] * z, lever[0] * y - lever[1] * x)
        column = 6 * j + h
        for k in range(6):
            value = sign * (right[k, h] if k < 3 else moment[k - 3])
            row = 6 * i + k
            if column <= row:
                lower[offset[row] + column] += value
            if row <= column:
                upper[offset[column] + row] += value


@compiled
def _assemble(
    case: Case, tangent: FloatArray, inertia: FloatArray, u: FloatArray, lower: FloatArray, upper: FloatArray
) -> None:
    """Assemble A C A^T + M / kappa in ``lower`` by rows and in ``upper`` by columns, with the diagonal in both.

    ``inertia`` (n, 6) is the diagonal M / kappa. The slack of a rolling body adds stiffness until the body has turned
    by 1 / ``ROLLING``.
    """
    problem, place, offset = case.problem, case.place, case.envelope.offset
    lower[:] = 0.0
    upper[:] = 0.0
    for i in range(len(inertia)):
        for k in range(6):
            at = offset[6 * place[i] + k] + 6 * place[i] + k
            lower[at] = inertia[i, k]
            if k > 2 and np.sqrt(u[i, 3] ** 2 + u[i, 4] ** 2 + u[i, 5] ** 2) < 1.0 / ROLLING:
                lower[at] += ROLLING * problem.slack[i]
            upper[at] = lower[at]
    right = np.empty((3, 6))
    for c in range(len(tangent)):
        a, b = problem.body_a[c], problem.body_b[c]
        if b >= 0:
            _wrenches(problem.lever_b[c], tangent[c], right)
            _add_block(lower, upper, offset, place[b], place[b], 1.0, problem.lever_b[c], right)
            if a >= 0:
                _add_block(lower, upper, offset, place[a], place[b], -1.0, problem.lever_a[c], right)
        if a >= 0:
            _wrenches(problem.lever_a[c], tangent[c], right)
            _add_block(lower, upper, offset, place[a], place[a], 1.0, problem.lever_a[c], right)
            if b >= 0:
                _add_block(lower, upper, offset, place[b], place[a], -1.0, problem.lever_b[c], right)


@compiled
def _unbalanced(problem: Problem, inertia: FloatArray, u: FloatArray, force: FloatArray, rest: FloatArray) -> float:
    """Write the imbalance of each body to ``rest`` (n, 6), and return its norm, times kappa over the weights.

    The imbalance is A f - w - M u / kappa. For a rolling body, the imbalance also contains the moment with which the
    slack of the body resists its rotation.
    """
    imbalance(problem, force, rest)
    total = 0.0
    for i in range(len(rest)):
        if problem.slack[i] > 0.0:
            turn = np.sqrt(u[i, 3] ** 2 + u[i, 4] ** 2 + u[i, 5] ** 2)
            share = problem.slack[i] * min(ROLLING, 1.0 / max(turn, TINY))
            for k in range(3, 6):
                rest[i, k] += share * u[i, k]
        for k in range(6):
            rest[i, k] = -rest[i, k] - inertia[i, k] * u[i, k]
            total += (rest[i, k] / inertia[i, 0]) ** 2
    return float(np.sqrt(total))


@compiled
def _solve(
    lower: FloatArray, upper: FloatArray, envelope: Envelope, place: IntArray, right: FloatArray, step: FloatArray
) -> None:
    """Replace the right side ``right`` (n, 6) by the solution, with the factors ``lower`` and ``upper``.

    The function overwrites ``step`` (6 n,).
    """
    for i in range(len(right)):
        for k in range(6):
            step[6 * place[i] + k] = right[i, k]
    substitute_general(lower, upper, envelope, step)
    for i in range(len(right)):
        for k in range(6):
            right[i, k] = step[6 * place[i] + k]


@compiled
def _sensitivity(u: FloatArray, du: FloatArray) -> FloatArray:
    """Return the ratio of each body's largest component of ``du`` to its largest component of ``u``, shape (n,).

    ``u`` (n, 6) is the displacement, and ``du`` (n, 6) is the sensitivity d u / d ln kappa.
    """
    found = np.empty(len(u))
    for i in range(len(u)):
        found[i] = np.abs(du[i]).max() / max(np.abs(u[i]).max(), TINY)
    return found


@compiled
def _inertia(problem: Problem) -> FloatArray:
    """Return the diagonal M, shape (n, 6): each body's weight, times ``ROTATIONAL`` for rotations."""
    inertia = np.empty((len(problem.load), 6))
    for i in range(len(inertia)):
        load = problem.load[i]
        weight = np.sqrt(load[0] ** 2 + load[1] ** 2 + load[2] ** 2)
        inertia[i, :3], inertia[i, 3:] = weight, ROTATIONAL * weight
    return inertia


@compiled
def displace(case: Case, kappa: float, most: int, u: FloatArray) -> tuple[bool, FloatArray]:
    """Move the displacements ``u`` (n, 6) to the solution for ``kappa``.

    The method is semismooth Newton, and must reach the solution within ``most`` steps. The method halves each step
    until the imbalance decreases enough (see ``ENOUGH``), or the length is at most ``SHORTEST_STEP``. A step costs O(m)
    and a factorisation.

    Returns:
        Two values:

        - True if the function found the solution;
        - the ratio of each body's sensitivity to its displacement, shape (n,). Without a solution, the value is 1 for
          unbalanced bodies, and 0 for other bodies. If every body is in balance, the value is 1 for all bodies.
    """
    problem, envelope = case.problem, case.envelope
    n, m = len(problem.load), len(problem.normal)
    lower, upper = np.empty(envelope.size), np.empty(envelope.size)
    inertia = _inertia(problem) / kappa
    v, force, tangent = np.empty((m, 3)), np.empty((m, 3)), np.empty((m, 3, 3))
    rest, du, trial, step = np.empty((n, 6)), np.empty((n, 6)), np.empty((n, 6)), np.empty(6 * n)
    along_contacts(problem, u, v)
    contact_law(case, v, force, tangent)
    error = _unbalanced(problem, inertia, u, force, rest)
    enough = CONVERGED * kappa  # M / kappa is the unit of the error
    stalls = 0
    for steps in range(most + 1):
        if error > enough or steps == 0:
            _assemble(case, tangent, inertia, u, lower, upper)
            factorize_general(lower, upper, envelope)
        if error <= enough:
            du[:] = inertia * u
            _solve(lower, upper, envelope, case.place, du, step)
            return True, _sensitivity(u, du)
        du[:] = rest
        _solve(lower, upper, envelope, case.place, du, step)
        length, now = 2.0, np.inf
        while not now < (1.0 - ENOUGH * length) * error and length > SHORTEST_STEP:
            length *= 0.5
            trial[:] = u + length * du
            along_contacts(problem, trial, v)
            contact_law(case, v, force, tangent)
            now = _unbalanced(problem, inertia, trial, force, rest)
        stalls = stalls + 1 if length <= SHORTEST_STEP else 0
        if not np.isfinite(now) or stalls > STALLS:
            break
        u[:], error = trial, now
    loose = np.zeros(n)
    for i in range(n):
        if not np.abs(rest[i]).max() <= CONVERGED * kappa * inertia[i, 0]:
            loose[i] = 1.0
    if not loose.any():
        loose[:] = 1.0
    return False, loose


@compiled
def displace_in_rounds(case: Case, kappa: float, most: int, u: FloatArray) -> tuple[bool, FloatArray, int]:
    """Find the solution of ``displace`` by rounds of friction bounds, for cases in which Newton's method alone fails.

    The function returns the same two values as ``displace``, and the number of rounds, at most ``most``. Before and
    after the call, ``case.bound`` holds ``COULOMB``.
    """
    v, force = np.empty((len(case.bound), 3)), np.empty((len(case.bound), 3))
    tangent = np.empty((len(case.bound), 3, 3))
    trial, sensitivity = np.empty_like(u), np.ones(len(u))
    for number in range(most):
        along_contacts(case.problem, u, v)
        contact_law(case, v, force, tangent)
        for c in range(len(v)):
            n = case.problem.normal[c]
            pressed = force[c, 0] * n[0] + force[c, 1] * n[1] + force[c, 2] * n[2]
            case.bound[c] = case.problem.friction[c] * max(0.0, pressed)
        displace(case, kappa, NEWTON_STEPS, u)
        case.bound[:] = COULOMB
        trial[:] = u
        found, sensitivity = displace(case, kappa, NEWTON_STEPS, trial)
        if found:
            u[:] = trial
            return True, sensitivity, number + 1
    return False, sensitivity, most
