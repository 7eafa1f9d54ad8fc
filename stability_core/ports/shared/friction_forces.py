"""Friction forces for engines that report normal forces only, from the bodies' change of momentum.

Body i has the mass m_i, the velocity v_i' before a frame of length T, and the velocity v_i after the frame. f_i is the
sum of the contact forces on body i. Contact c has the normal n_c, the coefficient of friction mu, the engine's normal
force N_c, and the unknown friction t_c across n_c. With the gravity vector g:

    f_i = m_i (v_i - v_i') / T - m_i g
    sum over c of +-t_c = f_i - sum over c of +-N_c n_c      for every live body i
    minimise  sum over c of |t_c|^2 / (mu N_c),              then  |t_c| <= mu N_c

with + if body i is body b of contact c, and - if body i is body a.

In a column the balance determines the friction of each pair of bodies. For a body on several supports the balance does
not determine the friction. The minimum then shares friction in proportion to the loads. The module neglects torques
about the normal, and forces that the host applies. The module starts conjugate gradients for least squares (CGLS)
from zero, because this start leads to the solution of smallest norm.
"""

from __future__ import annotations

import math

import numba
import numpy as np

from stability_core.port import FloatArray, IntArray

MOST_ROUNDS = 100
"""Greatest number of iterations of the conjugate gradients, because a column of 25 bricks needs about 50."""
PRECISION = 1e-4
"""Ratio of the gradient's norm to the norm of the first gradient at which the iteration ends."""


def with_friction(
    pairs: tuple[IntArray, IntArray],
    normal: FloatArray,
    force: FloatArray,
    friction: FloatArray,
    bodies: IntArray,
    borne: FloatArray,
) -> FloatArray:
    """Return the sum (n, 3) [N] of normal and friction forces on bodies b.

    Args:
        pairs: bodies a and b of each contact, each of shape (n,).
        normal: unit normals from a to b, shape (n, 3).
        force: normal forces [N] on b, shape (n, 3).
        friction: coefficients of friction, shape (n,).
        bodies: ids of the live bodies, in rising order, shape (m,).
        borne: sum of the contact forces [N] on each live body, shape (m, 3).
    """
    whole = force.copy()
    if len(bodies) and len(force):
        rows_a, rows_b = (_rows_of(ids, bodies) for ids in pairs)
        _add_friction(rows_a, rows_b, normal, friction, borne.copy(), whole)
    return whole


def _rows_of(ids: IntArray, bodies: IntArray) -> IntArray:
    """Return the row of each id (n,) in ``bodies`` (m,), or -1 for an id outside ``bodies``; ids rise, m >= 1."""
    place = np.minimum(np.searchsorted(bodies, ids), len(bodies) - 1)
    rows: IntArray = np.where(bodies[place] == ids, place, -1)
    return rows


@numba.njit(cache=True)
def _gather(row_a: int, row_b: int, vectors: FloatArray, normal: FloatArray, weight: float, out: FloatArray) -> None:
    """Write the weighted tangential part of the difference of two bodies' vectors (b - a) into ``out`` (3,).

    The vector of a body with a negative row counts as zero.
    """
    for k in range(3):
        out[k] = 0.0
        if row_b >= 0:
            out[k] += vectors[row_b, k]
        if row_a >= 0:
            out[k] -= vectors[row_a, k]
    along = out[0] * normal[0] + out[1] * normal[1] + out[2] * normal[2]
    for k in range(3):
        out[k] = weight * (out[k] - along * normal[k])


@numba.njit(cache=True)
def _scatter(row_a: int, row_b: int, vector: FloatArray, weight: float, sums: FloatArray) -> None:
    """Add a contact's weighted ``vector`` (3,) to the sum of body b, and subtract it from the sum of body a.

    The function skips a body with a negative row.
    """
    for k in range(3):
        if row_b >= 0:
            sums[row_b, k] += weight * vector[k]
        if row_a >= 0:
            sums[row_a, k] -= weight * vector[k]


@numba.njit("(int64[:], int64[:], float64[:, :], float64[:], float64[:, :], float64[:, :])", cache=True)
def _add_friction(
    rows_a: IntArray,
    rows_b: IntArray,
    normal: FloatArray,
    friction: FloatArray,
    left: FloatArray,
    force: FloatArray,
) -> None:
    """Add friction to the normal forces in ``force`` (n, 3) [N].

    ``left`` (m, 3) [N] is the sum of contact forces on each live body. The function overwrites ``left`` by the
    residual.
    """
    n = len(force)
    weight, bound = np.empty(n), np.empty(n)
    for c in range(n):
        pressed = force[c, 0] * normal[c, 0] + force[c, 1] * normal[c, 1] + force[c, 2] * normal[c, 2]
        bound[c] = friction[c] * max(pressed, 0.0)
        weight[c] = math.sqrt(bound[c])
        _scatter(rows_a[c], rows_b[c], force[c], -1.0, left)
    answer, gradient = np.zeros((n, 3)), np.zeros((n, 3))
    for c in range(n):
        _gather(rows_a[c], rows_b[c], left, normal[c], weight[c], gradient[c])
    direction = gradient.copy()
    size = first = (gradient * gradient).sum()
    for _ in range(MOST_ROUNDS):
        if size <= PRECISION * PRECISION * first:
            break
        change = np.zeros_like(left)
        for c in range(n):
            _scatter(rows_a[c], rows_b[c], direction[c], weight[c], change)
        step = size / (change * change).sum()
        answer += step * direction
        left -= step * change
        for c in range(n):
            _gather(rows_a[c], rows_b[c], left, normal[c], weight[c], gradient[c])
        before, size = size, (gradient * gradient).sum()
        direction = gradient + size / before * direction
    for c in range(n):
        length = weight[c] * math.sqrt((answer[c] * answer[c]).sum())
        share = weight[c] * (1.0 if length <= bound[c] else bound[c] / length)
        force[c] += share * answer[c]
