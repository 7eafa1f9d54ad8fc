"""The two quadratic programs of a staggered step, in the scaled units of ``reference.contact_rows``.

Symbols:

- w: scaled velocities of the live bodies; w0: the velocities before a program;
- N, D: rows along normals and tangents; drive: velocities of driven bodies along these rows;
- g: gaps (as velocities over the step); mu: coefficient of friction; beta: friction impulses;
- K(r): the box or the disc of half width r in the plane of a contact.

Programs:

    impact:    min 1/2 |w - w0|^2    subject to  N w + drive_n >= -max(g, 0);   alpha are the multipliers
    friction:  min 1/2 |w|^2 + drive_t . beta   subject to  w = w0 + D^T beta,  beta in K(mu alpha)

The impact program projects w0 on the velocities without penetration. The friction program finds the friction of
greatest dissipation. The variables of both programs include the bodies' velocities, because the matrices are then
sparse and the mass matrix is the unit matrix.

The solver PIQP solves the programs. PIQP takes the upper triangle of the quadratic term, and infinite bounds as
infinities. With ``cone = "disc"`` the solver Clarabel solves the friction program instead, because a disc of radius mu
alpha is a second-order cone.
"""

from __future__ import annotations

from typing import NamedTuple

import clarabel
import numba
import numpy as np
import numpy.typing as npt
import piqp
from scipy import sparse

from adapters.reference.contact_rows import ContactRows
from stability_core.port import FloatArray, IntArray

ACCURACY = 1e-9
"""Residual of a quadratic program, in the scaled units: a thousandth of ``CLEAR_BOUND``."""
CLEAR_BOUND = 1e-6
"""Bound mu alpha, in units of the impulse of a mean body's weight in a step, above which the friction program contains
a contact. Friction of a smaller bound changes the velocity of a mean body by less than a millionth of the change by
gravity in a step."""
STIFF = 1e6
"""Ratio of the cost of a remaining approach to the cost of a change of velocity. The ratio counts if no velocities
avoid penetration, for example of a body between two boxes that approach each other."""

_SOLVED = (piqp.PIQP_SOLVED, piqp.PIQP_MAX_ITER_REACHED)


IndexArray = npt.NDArray[np.int32]


class Impact(NamedTuple):
    """Solution of the impact program."""

    velocity: FloatArray
    """Scaled velocities, shape (6 m,)."""
    alpha: FloatArray
    """Normal impulses, shape (n,)."""


class Friction(NamedTuple):
    """Solution of the friction program."""

    velocity: FloatArray
    """Scaled velocities, shape (6 m,)."""
    beta: FloatArray
    """Impulses along both tangents, shape (n, 2)."""


def normal_rows(problem: ContactRows) -> sparse.csc_matrix:
    """Return the rows N as a sparse matrix, shape (n, 6 m)."""
    data, indices, pointers = _columns(problem.body, problem.jacobian[:, 0], len(problem.start))
    return sparse.csc_matrix((data, indices, pointers), shape=(len(problem), problem.start.size))


def impact(normals: sparse.csc_matrix, before: FloatArray, least: FloatArray) -> Impact:
    """Return the velocities w nearest to ``before`` with N w >= ``least``, and the normal impulses.

    If no velocities satisfy this condition, the remaining approach has the cost ``STIFF``.

    Args:
        normals: the rows N, shape (n, 6 m).
        before: velocities w0, shape (6 m,).
        least: least values of N w, shape (n,).
    """
    size, n = len(before), len(least)
    solver = _solver()
    solver.setup(_diagonal(np.ones(size)), -before, None, None, normals, least, np.full(n, np.inf))
    if solver.solve() in _SOLVED and np.isfinite(solver.result.x).all():
        return Impact(np.array(solver.result.x), np.array(solver.result.z_l))
    yielding = sparse.hstack([normals, _diagonal(np.ones(n))], format="csc")
    cost = _diagonal(np.concatenate([np.ones(size), np.full(n, STIFF)]))
    solver = _solver()
    solver.setup(cost, np.concatenate([-before, np.zeros(n)]), None, None, yielding, least, np.full(n, np.inf))
    solver.solve()
    return Impact(np.array(solver.result.x[:size]), np.array(solver.result.z_l))


def friction_in_box(problem: ContactRows, before: FloatArray, bound: FloatArray) -> Friction:
    """Return the friction of greatest dissipation with |beta| <= bound along each tangent.

    Contacts with a bound of at most ``CLEAR_BOUND`` have no friction.

    Args:
        problem: the contacts.
        before: velocities w0, shape (6 m,).
        bound: bound mu alpha of the friction (see the module docstring), shape (n,).
    """
    loaded = np.flatnonzero(bound > CLEAR_BOUND)
    size, n = len(before), 2 * len(loaded)
    if not n:
        return Friction(before, np.zeros((len(bound), 2)))
    cost, linear, balance = _friction_program(problem, loaded, size)
    free, bounds = np.full(size, np.inf), np.repeat(bound[loaded], 2)
    solver = _solver()
    solver.setup(cost, linear, balance, before, None, None, None, np.concatenate([-free, -bounds]),
                 np.concatenate([free, bounds]))  # fmt: skip
    solver.solve()
    return _friction(solver.result.x, loaded, size, len(bound))


def friction_in_disc(problem: ContactRows, before: FloatArray, bound: FloatArray) -> Friction:
    """Return the friction of greatest dissipation with |beta| <= bound in the plane of the contact.

    For the arguments and for small bounds, see ``friction_in_box``.
    """
    loaded = np.flatnonzero(bound > CLEAR_BOUND)
    size, n = len(before), len(loaded)
    if not n:
        return Friction(before, np.zeros((len(bound), 2)))
    cost, linear, balance = _friction_program(problem, loaded, size)
    rows = np.arange(3 * n).reshape(n, 3)[:, 1:].ravel()
    discs = sparse.csc_matrix((-np.ones(2 * n), (rows, size + np.arange(2 * n))), shape=(3 * n, size + 2 * n))
    radius = np.zeros((n, 3))
    radius[:, 0] = bound[loaded]
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.max_threads = 1
    cones = [clarabel.ZeroConeT(size), *(clarabel.SecondOrderConeT(3) for _ in range(n))]
    limits = sparse.vstack([balance, discs], format="csc")
    solver = clarabel.DefaultSolver(cost, linear, limits, np.concatenate([before, radius.ravel()]), cones, settings)
    return _friction(np.array(solver.solve().x), loaded, size, len(bound))


def _friction(solution: FloatArray, loaded: IntArray, size: int, n: int) -> Friction:
    beta = np.zeros((n, 2))
    beta[loaded] = np.asarray(solution[size:]).reshape(-1, 2)
    return Friction(np.array(solution[:size]), beta)


def _friction_program(
    problem: ContactRows, loaded: IntArray, size: int
) -> tuple[sparse.csc_matrix, FloatArray, sparse.csc_matrix]:
    """Return the quadratic and the linear cost of (w, beta), and the matrix of w - D^T beta = w0."""
    n = 2 * len(loaded)
    cost = _diagonal(np.concatenate([np.ones(size), np.zeros(n)]))
    linear = np.concatenate([np.zeros(size), problem.drive[loaded, 1:].ravel()])
    data, indices, pointers = _balance(problem.body[loaded], problem.jacobian[loaded, 1:], size)
    return cost, linear, sparse.csc_matrix((data, indices, pointers), shape=(size, size + n))


def _solver() -> piqp.SparseSolver:
    solver = piqp.SparseSolver()
    solver.settings.eps_abs = solver.settings.eps_rel = ACCURACY
    solver.settings.eps_duality_gap_abs = solver.settings.eps_duality_gap_rel = ACCURACY
    return solver


def _diagonal(values: FloatArray) -> sparse.csc_matrix:
    n = len(values)
    return sparse.csc_matrix((values, np.arange(n), np.arange(n + 1)), shape=(n, n))


@numba.njit(cache=True)
def _columns(body: IntArray, rows: FloatArray, bodies: int) -> tuple[FloatArray, IndexArray, IndexArray]:
    """Return data, row indices and column pointers of a matrix with a row for each contact, shape (n, 6 bodies).

    Args:
        body: indices of the live bodies a and b of each contact, or -1, shape (n, 2).
        rows: entries of bodies a and b, shape (n, 2, 6).
        bodies: number of the live bodies.
    """
    counts = np.zeros(bodies + 1, np.int64)
    for c in range(len(body)):
        for side in range(2):
            if body[c, side] >= 0:
                counts[body[c, side] + 1] += 1
    first = np.cumsum(counts)
    pointers = np.empty(6 * bodies + 1, np.int32)
    for i in range(bodies):
        for k in range(6):
            pointers[6 * i + k] = 6 * first[i] + k * counts[i + 1]
    pointers[6 * bodies] = 6 * first[bodies]
    data, indices = np.empty(6 * first[bodies]), np.empty(6 * first[bodies], np.int32)
    filled = np.zeros(bodies, np.int64)
    for c in range(len(body)):
        for side in range(2):
            i = body[c, side]
            if i < 0:
                continue
            for k in range(6):
                place = pointers[6 * i + k] + filled[i]
                data[place], indices[place] = rows[c, side, k], c
            filled[i] += 1
    return data, indices, pointers


@numba.njit(cache=True)
def _balance(body: IntArray, rows: FloatArray, size: int) -> tuple[FloatArray, IndexArray, IndexArray]:
    """Return data, row indices and column pointers of the matrix [1, -D^T], shape (size, size + 2 n).

    Args:
        body: indices of the live bodies a and b of each contact, or -1, shape (n, 2).
        rows: rows of both tangents, shape (n, 2, 2, 6).
        size: 6 times the number of live bodies.
    """
    n = len(body)
    data, indices = np.ones(size + 24 * n), np.empty(size + 24 * n, np.int32)
    pointers = np.empty(size + 2 * n + 1, np.int32)
    for i in range(size):
        indices[i] = pointers[i] = i
    end = size
    for c in range(n):
        for tangent in range(2):
            pointers[size + 2 * c + tangent] = end
            for side in range(2):
                if body[c, side] >= 0:
                    for k in range(6):
                        data[end], indices[end] = -rows[c, tangent, side, k], 6 * body[c, side] + k
                        end += 1
    pointers[size + 2 * n] = end
    return data[:end], indices[:end], pointers
