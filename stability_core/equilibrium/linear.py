"""One Newton step: the generalised Hessian of |P_K(z)|^2 / 2 + rho |y|^2 / 2 at a point z, and the line search.

See ``newton`` for the symbols. For the multipliers y, the point is z = A^T y, or in ``correction`` z = f0 + A^T y.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stability_core.compiled import compiled
from stability_core.equilibrium.cone import derivative, project
from stability_core.equilibrium.envelope import Envelope, envelope_of, factorize, numbering, substitute
from stability_core.equilibrium.problem import Problem, along_contacts
from stability_core.port import FloatArray, IntArray


class Workspace(NamedTuple):
    """The arrays that all steps of a problem share."""

    rows: IntArray
    """Components of force and moment that may be nonzero, shape (k,)."""
    place: IntArray
    """Place of each body in the matrix, shape (n,)."""
    envelope: Envelope
    matrix: FloatArray
    step: FloatArray
    """Right side and solution of the linear system, shape (n k,)."""
    dy: FloatArray
    """The solution as a motion, shape (n, 6)."""
    z: FloatArray
    """Start of the step: vectors whose projections are the forces, shape (m, 3)."""
    dz: FloatArray
    """A^T dy, shape (m, 3)."""
    trial: FloatArray
    """Vectors z + t dz of the line search, shape (m, 3)."""


@compiled
def workspace_for(problem: Problem, rows: IntArray) -> Workspace:
    """Return the workspace of a problem.

    The number of ``rows`` must be a multiple of three. The cost is O(n + m) and the allocation of the matrix.
    """
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
    """Write the ``rows`` of the wrench of the force ``sign`` times ``direction`` at ``lever`` to ``wrench``."""
    for k in range(len(rows)):
        row = rows[k]
        if row < 3:
            wrench[k] = sign * direction[row]
        else:
            i, j = (row + 1) % 3, (row + 2) % 3
            wrench[k] = sign * (lever[i] * direction[j] - lever[j] * direction[i])


@compiled
def _add_product(
    matrix: FloatArray, offset: IntArray, i: int, j: int, weight: float, left: FloatArray, right: FloatArray
) -> None:
    """Add weight left right^T to the block of the bodies in places i >= j, and for i = j only to the lower triangle."""
    width = len(left)
    for k in range(width):
        start = offset[i * width + k] + j * width
        row = matrix[start : start + (k + 1 if i == j else width)]
        scale = weight * left[k]
        for h in range(len(row)):
            row[h] += scale * right[h]


@compiled
def _assemble(problem: Problem, space: Workspace, rho: float) -> None:
    """Write the Hessian A D A^T + rho 1 to ``space.matrix``, with the derivative D of P_K at ``space.z``."""
    width, matrix, offset = len(space.rows), space.matrix, space.envelope.offset
    direction, weight = np.empty((3, 3)), np.empty(3)
    on_a, on_b = np.empty(width), np.empty(width)
    matrix[:] = 0.0
    for i in range(len(space.step)):
        matrix[offset[i] + i] = rho
    for c in range(len(problem.normal)):
        terms = derivative(space.z[c], problem.normal[c], problem.friction[c], direction, weight)
        a, b = problem.body_a[c], problem.body_b[c]
        for k in range(terms):
            if a >= 0:
                _wrench(direction[k], problem.lever_a[c], -1.0, space.rows, on_a)
                _add_product(matrix, offset, space.place[a], space.place[a], weight[k], on_a, on_a)
            if b >= 0:
                _wrench(direction[k], problem.lever_b[c], 1.0, space.rows, on_b)
                _add_product(matrix, offset, space.place[b], space.place[b], weight[k], on_b, on_b)
            if a >= 0 and b >= 0:
                if space.place[a] > space.place[b]:
                    _add_product(matrix, offset, space.place[a], space.place[b], weight[k], on_a, on_b)
                else:
                    _add_product(matrix, offset, space.place[b], space.place[a], weight[k], on_b, on_a)


@compiled
def factorize_at(problem: Problem, space: Workspace, rho: float) -> None:
    """Factorize the Hessian at ``space.z``: O(m) and a factorisation (see ``envelope``)."""
    _assemble(problem, space, rho)
    factorize(space.matrix, space.envelope)


@compiled
def solve_for(problem: Problem, space: Workspace, right: FloatArray) -> None:
    """Solve for a ``right`` side (n, 6) with the factor of ``factorize_at``, and write dy and dz to ``space``."""
    rows, place, step, dy = space.rows, space.place, space.step, space.dy
    width = len(rows)
    for i in range(len(right)):
        for k in range(width):
            step[place[i] * width + k] = right[i, rows[k]]
    substitute(space.matrix, space.envelope, step)
    for i in range(len(right)):
        for k in range(width):
            dy[i, rows[k]] = step[place[i] * width + k]
    along_contacts(problem, dy, space.dz)


@compiled
def _slope(problem: Problem, z: FloatArray, dz: FloatArray, t: float, work: FloatArray, force: FloatArray) -> float:
    """Return the slope of |P_K|^2 / 2 along the line z + t dz."""
    for c in range(len(z)):
        for k in range(3):
            work[c, k] = z[c, k] + t * dz[c, k]
    project(work, problem.normal, problem.friction, force)
    total = 0.0
    for c in range(len(z)):
        total += force[c, 0] * dz[c, 0] + force[c, 1] * dz[c, 1] + force[c, 2] * dz[c, 2]
    return total


@compiled
def step_length(
    problem: Problem, space: Workspace, rho: float, y: FloatArray, center: FloatArray, force: FloatArray
) -> float:
    """Return the step length from ``y`` along dy: 1, or a length with nearly zero slope if the full step overshoots.

    The search minimises |P_K(z)|^2 / 2 - w . y + rho |y - center|^2 / 2, whose slope along the line rises with the
    length. The function overwrites ``force``.
    """
    z, dz, dy, work = space.z, space.dz, space.dy, space.trial
    constant, linear = 0.0, 0.0
    for i in range(len(y)):
        for k in space.rows:
            constant += dy[i, k] * (rho * (y[i, k] - center[i, k]) - problem.load[i, k])
            linear += rho * dy[i, k] ** 2
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
