"""Compiled check and storage of the states in an answer, because NumPy calls would take longer than the transfer."""

from __future__ import annotations

from enum import IntEnum

import numba
import numpy as np

from stability_core.port import FloatArray, IntArray


class Finding(IntEnum):
    """Result of the check of an answer's numbers."""

    VALID = 0
    OTHER_BODIES = 1
    """The ids differ from the ids of the bodies that are live or moved."""
    STATES_NOT_FINITE = 2
    POINTS_NOT_FINITE = 3
    """All states are finite, but contact points or forces are not."""


_VALID, _OTHER_BODIES, _STATES_NOT_FINITE, _POINTS_NOT_FINITE = map(int, Finding)


@numba.njit("int64(float64[::1], int64[:], int64, float64[:, ::1])", cache=True)
def receive(words: FloatArray, bodies: IntArray, blocks: int, table: FloatArray) -> int:
    """Check the numbers of an answer, and store each body's latest state in the row of its id.

    Args:
        words: one array of ids (m,), states at ``blocks`` times (blocks, m, w), contact points and forces.
        bodies: ids of the bodies that the answer must contain, in rising order, shape (m,).
        blocks: number of states of each body, at least 1.
        table: latest states by id, shape (n, w); the rows of ``bodies`` become NaN if any state is not finite.

    Returns:
        A ``Finding``; for ``OTHER_BODIES`` the function stores nothing.
    """
    count, width = len(bodies), table.shape[1]
    for k in range(count):
        if words[k] != bodies[k]:
            return _OTHER_BODIES
    end = count * (1 + blocks * width)
    unbounded = 0
    for k in range(count, end):
        unbounded += not abs(words[k]) < np.inf
    latest = end - count * width
    for k in range(count):
        for column in range(width):
            table[bodies[k], column] = np.nan if unbounded else words[latest + k * width + column]
    if unbounded:
        return _STATES_NOT_FINITE
    for k in range(end, len(words)):
        unbounded += not abs(words[k]) < np.inf
    return _POINTS_NOT_FINITE if unbounded else _VALID
