"""Pass vertical forces from the top down: each body passes its load to its supports.

For stacks on load-bearing contacts, one sweep of O(contacts) finds an equilibrium. A joint solve of all bodies from
zero takes several factorisations. The sweep chooses the balancing forces f_c below each body, at x_c and y_c from the
body's centre, with the least norm:

    minimise sum f_c^2,    sum f_c = W,    sum y_c f_c = M_x,    -sum x_c f_c = M_y,    f_c >= 0.

W is the force, and (M_x, M_y) the moment, of the body's weight and of all loads from above. The sweep fails, and proves
nothing, if a body such as a counterweight must press differently to hold a body below.
"""

from __future__ import annotations

import numpy as np

from stability_core.compiled import compiled
from stability_core.equilibrium.problem import BALANCED, Problem, add_wrench, greatest_imbalance, imbalance
from stability_core.port import BoolArray, FloatArray, IntArray

REFINEMENTS = 2
"""Number of corrections of a body's forces for rounding, because the normal equations lose half of the digits."""
ALONG_A_LINE = 1e-12
"""Ratio of the regularisation to the trace of the matrix, because contacts along a line leave one moment free."""


@compiled
def _solve_three(matrix: FloatArray, right: FloatArray) -> None:
    """Replace ``right`` (3,) by the solution of a positive definite system, and overwrite ``matrix`` (3, 3)."""
    for j in range(3):
        for k in range(j):
            matrix[j, j] -= matrix[j, k] ** 2
        matrix[j, j] = np.sqrt(max(matrix[j, j], 1e-300))
        for i in range(j + 1, 3):
            for k in range(j):
                matrix[i, j] -= matrix[i, k] * matrix[j, k]
            matrix[i, j] /= matrix[j, j]
    for i in range(3):
        for k in range(i):
            right[i] -= matrix[i, k] * right[k]
        right[i] /= matrix[i, i]
    for i in range(2, -1, -1):
        for k in range(i + 1, 3):
            right[i] -= matrix[k, i] * right[k]
        right[i] /= matrix[i, i]


@compiled
def _add_least(row: FloatArray, missing: FloatArray, active: BoolArray, force: FloatArray) -> None:
    """Add to ``force`` (k,) the least ``active`` forces whose products with ``row`` (k, 3) sum to ``missing`` (3,)."""
    matrix, right = np.zeros((3, 3)), missing.copy()
    for c in range(len(row)):
        if active[c]:
            for i in range(3):
                for j in range(3):
                    matrix[i, j] += row[c, i] * row[c, j]
    trace = matrix[0, 0] + matrix[1, 1] + matrix[2, 2]
    for i in range(3):
        matrix[i, i] += ALONG_A_LINE * trace
    _solve_three(matrix, right)
    for c in range(len(row)):
        if active[c]:
            force[c] += row[c, 0] * right[0] + row[c, 1] * right[1] + row[c, 2] * right[2]


@compiled
def _share(row: FloatArray, wanted: FloatArray, force: FloatArray) -> None:
    """Write to ``force`` (k,) small non-negative forces whose products with ``row`` (k, 3) sum to ``wanted`` (3,).

    The function starts from the least forces, and excludes contacts with pulling forces, the strongest pull first. If
    the remaining contacts cannot bear ``wanted``, the forces miss ``wanted`` or pull, and the caller must check both.
    """
    active, missing = np.ones(len(row), np.bool_), np.empty(3)
    for _ in range(len(row)):
        force[:] = 0.0
        for _ in range(1 + REFINEMENTS):
            missing[:] = wanted
            for c in range(len(row)):
                missing -= row[c] * force[c]
            _add_least(row, missing, active, force)
        worst = np.argmin(force)
        if force[worst] >= 0.0:
            return
        active[worst] = False


@compiled
def _supports(problem: Problem) -> tuple[IntArray, IntArray, IntArray, IntArray]:
    """Return the contacts below each body, sorted by body.

    Returns:
        Four arrays:

        - upper body of each contact, negative for a fixed body, shape (m,);
        - lower body of each contact, negative for a fixed body, shape (m,);
        - start of each body's contacts in the list, shape (n + 1,);
        - the list: the contacts below each body, one body after the other.
    """
    n, m = len(problem.load), len(problem.normal)
    upper, lower = np.empty(m, np.int64), np.empty(m, np.int64)
    start = np.zeros(n + 1, np.int64)
    for c in range(m):
        is_up = problem.normal[c, 2] >= 0.0
        upper[c] = problem.body_b[c] if is_up else problem.body_a[c]
        lower[c] = problem.body_a[c] if is_up else problem.body_b[c]
        if upper[c] >= 0:
            start[upper[c] + 1] += 1
    start = np.cumsum(start)
    at, listed = start.copy(), np.empty(start[n], np.int64)
    for c in range(m):
        if upper[c] >= 0:
            listed[at[upper[c]]] = c
            at[upper[c]] += 1
    return upper, lower, start, listed


@compiled
def _bear(problem: Problem, body: int, mine: IntArray, load: FloatArray, force: FloatArray) -> None:
    """Write to ``force`` (m, 3) the forces with which the contacts ``mine`` (k,) below a ``body`` bear its load."""
    row, share, wanted = np.empty((len(mine), 3)), np.empty(len(mine)), np.empty(3)
    for at in range(len(mine)):
        c = mine[at]
        lever = problem.lever_b[c] if problem.body_b[c] == body else problem.lever_a[c]
        row[at, 0], row[at, 1], row[at, 2] = 1.0, lever[1], -lever[0]
    wanted[0], wanted[1], wanted[2] = load[body, 2], load[body, 3], load[body, 4]
    _share(row, wanted, share)
    for at in range(len(mine)):
        force[mine[at], 2] = share[at] if problem.body_b[mine[at]] == body else -share[at]


@compiled
def pass_down(problem: Problem) -> tuple[bool, FloatArray, FloatArray, float]:
    """Try to balance all bodies by vertical forces, from the top down: O(m).

    Args:
        problem: n bodies and m contacts, whose normals are all vertical.

    Returns:
        Four values:

        - True if the forces hold all bodies;
        - the forces, shape (m, 3);
        - the unbalanced rest, shape (n, 6);
        - the greatest imbalance of a body relative to the largest force on it.
    """
    n = len(problem.load)
    upper, lower, start, listed = _supports(problem)
    load, force, rest = problem.load.copy(), np.zeros(problem.normal.shape), np.empty((n, 6))
    waits_for = np.zeros(n, np.int64)
    for c in range(len(upper)):
        if lower[c] >= 0 and upper[c] >= 0:
            waits_for[lower[c]] += 1
    order: IntArray = np.flatnonzero(waits_for == 0)
    while len(order):
        freed = np.empty(n, np.int64)
        size = 0
        for body in order:
            mine = listed[start[body] : start[body + 1]]
            _bear(problem, body, mine, load, force)
            for c in mine:
                below = lower[c]
                if below < 0:
                    continue
                if problem.body_a[c] == below:
                    add_wrench(load[below], 1.0, force[c], problem.lever_a[c], 1.0)
                else:
                    add_wrench(load[below], -1.0, force[c], problem.lever_b[c], 1.0)
                waits_for[below] -= 1
                if waits_for[below] == 0:
                    freed[size] = below
                    size += 1
        order = freed[:size]
    imbalance(problem, force, rest)
    worst = greatest_imbalance(problem, force, rest)
    return bool(worst <= BALANCED and not _pulls(problem, force)), force, rest, worst


@compiled
def _pulls(problem: Problem, force: FloatArray) -> bool:
    """Return True if any force (m, 3) points against its normal."""
    pulls = False
    for c in range(len(force)):
        pulls |= force[c, 2] * problem.normal[c, 2] < 0.0
    return pulls
