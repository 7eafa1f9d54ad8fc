"""Friction forces for engines that report normal forces only, from the bodies' change of momentum.

Body i has the mass m_i, the velocity v_i' before a frame of length T, and the velocity v_i after the frame. f_i is the
sum of the contact forces on body i. Contact c has the normal n_c, the coefficient of friction mu, the engine's normal
force N_c, the lever r_c from the centre of mass, and the unknown friction t_c across n_c. With the gravity vector g:

    f_i = m_i (v_i - v_i') / T - m_i g
    sum over c of +-t_c           = f_i - sum over c of +-N_c n_c            for every live body i
    sum over c of +-(r_c x t_c)   = -sum over c of +-(r_c x N_c n_c)         for every live body i that hardly turns
    minimise  sum over c of |t_c|^2 / (mu N_c),              then  |t_c| <= mu N_c

with + if body i is body b of contact c, and - if body i is body a. The moments count over the longest lever of the
body, as forces. A body turns if its angular acceleration takes a moment of more than ``TURNS``; its moments then do not
count, because the port need not know its moments of inertia.

In a column the balance of forces determines the friction of each pair of bodies. In a card house or an arch the thrust
follows from the balance of moments only. Where both do not determine the friction, the minimum shares friction in
proportion to the loads. The module neglects forces that the host applies. The module starts conjugate gradients for
least squares (CGLS) from zero, because this start leads to the solution of smallest norm.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numba
import numpy as np

from stability_core.port import FloatArray, IntArray

MOST_ROUNDS = 100
"""Greatest number of iterations of the conjugate gradients, because a column of 25 bricks needs about 50."""
PRECISION = 1e-4
"""Ratio of the gradient's norm to the norm of the first gradient at which the iteration ends."""


TURNS = 0.05
"""Ratio of the moment of an angular acceleration to the moment of the contact forces at the longest lever, above which
a body turns. Below it, the neglected moment is no larger than the fluctuation of an engine's forces at rest."""


class Borne(NamedTuple):
    """What the contacts of m live bodies bear."""

    body: IntArray
    """Ids of the bodies, in rising order, shape (m,)."""
    force: FloatArray
    """Sum of the contact forces [N] on each body, shape (m, 3)."""
    center: FloatArray
    """Centres of mass [m], shape (m, 3)."""
    turning: FloatArray
    """Mass times angular acceleration [kg rad/s2] of each body, shape (m,)."""


def with_friction(
    pairs: tuple[IntArray, IntArray],
    point: FloatArray,
    normal: FloatArray,
    force: FloatArray,
    friction: FloatArray,
    borne: Borne,
) -> FloatArray:
    """Return the sum (n, 3) [N] of normal and friction forces on bodies b.

    Args:
        pairs: bodies a and b of each contact, each of shape (n,).
        point: contact points [m], shape (n, 3).
        normal: unit normals from a to b, shape (n, 3).
        force: normal forces [N] on b, shape (n, 3).
        friction: coefficients of friction, shape (n,).
        borne: what the contacts of the live bodies bear.
    """
    whole = force.copy()
    if len(borne.body) and len(force):
        lever = np.empty((2, *point.shape))
        rows = np.empty((2, len(point)), np.int64)
        for side, ids in enumerate(pairs):
            rows[side] = _rows_of(ids, borne.body)
            lever[side] = point - borne.center[rows[side]]
        _scale_levers(rows, lever, borne.force, borne.turning)
        left = np.hstack((borne.force, np.zeros_like(borne.force)))
        _add_friction(rows, lever, normal, friction, left, whole)
    return whole


def _rows_of(ids: IntArray, bodies: IntArray) -> IntArray:
    """Return the row of each id (n,) in ``bodies`` (m,), or -1 for an id outside ``bodies``; ids rise, m >= 1."""
    place = np.minimum(np.searchsorted(bodies, ids), len(bodies) - 1)
    rows: IntArray = np.where(bodies[place] == ids, place, -1)
    return rows


@numba.njit("(int64[:, :], float64[:, :, :], float64[:, :], float64[:])", cache=True)
def _scale_levers(rows: IntArray, lever: FloatArray, force: FloatArray, turning: FloatArray) -> None:
    """Divide the levers (2, n, 3) [m] of each body by the body's longest lever, or set these levers to 0 if it turns.

    Args:
        rows: rows of bodies a and b in ``force``, negative for other bodies, shape (2, n).
        lever: levers of the contacts on bodies a and b.
        force: sum of the contact forces [N] on each body, shape (m, 3).
        turning: mass times angular acceleration [kg rad/s2] of each body, shape (m,).
    """
    longest = np.zeros(len(force))
    for side in range(2):
        for c in range(rows.shape[1]):
            if rows[side, c] >= 0:
                longest[rows[side, c]] = max(longest[rows[side, c]], math.sqrt((lever[side, c] ** 2).sum()))
    for i in range(len(longest)):
        turns = turning[i] * longest[i] > TURNS * math.sqrt((force[i] ** 2).sum())
        longest[i] = 0.0 if turns or longest[i] == 0.0 else 1.0 / longest[i]
    for side in range(2):
        for c in range(rows.shape[1]):
            if rows[side, c] >= 0:
                lever[side, c] *= longest[rows[side, c]]


@numba.njit(cache=True)
def _gather(
    rows: IntArray, lever: FloatArray, c: int, sums: FloatArray, normal: FloatArray, weight: float, out: FloatArray
) -> None:
    """Write the weighted part across the normal of what both bodies' ``sums`` say at contact c into ``out`` (3,).

    The function is the adjoint of ``_scatter``. A body with a negative row counts as zero.
    """
    out[:] = 0.0
    for side in range(2):
        row, sign = rows[side, c], 2.0 * side - 1.0
        if row >= 0:
            for k in range(3):
                i, j = (k + 1) % 3, (k + 2) % 3
                turned = sums[row, 3 + i] * lever[side, c, j] - sums[row, 3 + j] * lever[side, c, i]
                out[k] += sign * (sums[row, k] + turned)
    along = out[0] * normal[0] + out[1] * normal[1] + out[2] * normal[2]
    for k in range(3):
        out[k] = weight * (out[k] - along * normal[k])


@numba.njit(cache=True)
def _scatter(rows: IntArray, lever: FloatArray, c: int, force: FloatArray, weight: float, sums: FloatArray) -> None:
    """Add the weighted ``force`` (3,) at contact c to the sums (m, 6) of body b, and subtract it from those of body a.

    The sums are of forces, and of moments over the longest lever. The function skips a body with a negative row.
    """
    for side in range(2):
        row, factor = rows[side, c], weight * (2.0 * side - 1.0)
        if row >= 0:
            for k in range(3):
                i, j = (k + 1) % 3, (k + 2) % 3
                sums[row, k] += factor * force[k]
                sums[row, 3 + k] += factor * (lever[side, c, i] * force[j] - lever[side, c, j] * force[i])


@numba.njit("(int64[:, :], float64[:, :, :], float64[:, :], float64[:], float64[:, :], float64[:, :])", cache=True)
def _add_friction(
    rows: IntArray, lever: FloatArray, normal: FloatArray, friction: FloatArray, left: FloatArray, force: FloatArray
) -> None:
    """Add friction to the normal forces in ``force`` (n, 3) [N].

    ``left`` (m, 6) is the sum of contact forces [N] on each live body, and their moment over the longest lever [N]. The
    function overwrites ``left`` by the residual.
    """
    n = len(force)
    weight, bound = np.empty(n), np.empty(n)
    for c in range(n):
        pressed = force[c, 0] * normal[c, 0] + force[c, 1] * normal[c, 1] + force[c, 2] * normal[c, 2]
        bound[c] = friction[c] * max(pressed, 0.0)
        weight[c] = math.sqrt(bound[c])
        _scatter(rows, lever, c, force[c], -1.0, left)
    answer, gradient = np.zeros((n, 3)), np.zeros((n, 3))
    for c in range(n):
        _gather(rows, lever, c, left, normal[c], weight[c], gradient[c])
    direction = gradient.copy()
    size = first = (gradient * gradient).sum()
    for _ in range(MOST_ROUNDS):
        if size <= PRECISION * PRECISION * first:
            break
        change = np.zeros_like(left)
        for c in range(n):
            _scatter(rows, lever, c, direction[c], weight[c], change)
        step = size / (change * change).sum()
        answer += step * direction
        left -= step * change
        for c in range(n):
            _gather(rows, lever, c, left, normal[c], weight[c], gradient[c])
        before, size = size, (gradient * gradient).sum()
        direction = gradient + size / before * direction
    for c in range(n):
        length = weight[c] * math.sqrt((answer[c] * answer[c]).sum())
        share = weight[c] * (1.0 if length <= bound[c] else bound[c] / length)
        force[c] += share * answer[c]
