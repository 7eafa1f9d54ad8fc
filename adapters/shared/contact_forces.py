"""Mean contact forces of a frame, for engines that report the forces of one substep at a time.

The force of a pair of bodies is its exact mean over the frame's substeps. The points of the pair share the forces of
earlier substeps in proportion to their normal forces in the last substep, or equally if none of them presses. Therefore
the distribution over the contact area is the distribution of the last substep. The module omits pairs without contacts
after the last substep, for example a brick that has bounced off and its support.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numba
import numpy as np

from stability_core.port import FloatArray, IntArray


@dataclass(frozen=True, slots=True)
class SubstepForces:
    """Forces of one substep in n rows. A pair may have several rows."""

    body_a: IntArray
    """First bodies, shape (n,)."""
    body_b: IntArray
    """Second bodies, shape (n,)."""
    force: FloatArray
    """Forces [N] on bodies b, shape (n, 3)."""


def mean_force(last: SubstepForces, normal: FloatArray, earlier: Sequence[SubstepForces]) -> FloatArray:
    """Return the mean forces (n, 3) [N] of a frame at the contacts of its last substep.

    Args:
        last: forces of the last substep, one row per contact.
        normal: unit normals of the contacts from a to b, shape (n, 3).
        earlier: forces of each of the frame's other substeps.
    """
    if not len(last.body_a) or not earlier:
        return last.force
    lowest = min(int(last.body_a.min()), int(last.body_b.min()))
    span = max(int(last.body_a.max()), int(last.body_b.max())) - lowest + 1
    keys = _keys(last.body_a, last.body_b, lowest, span)
    order = np.argsort(keys, kind="stable")
    body_a = np.concatenate([substep.body_a for substep in earlier])
    body_b = np.concatenate([substep.body_b for substep in earlier])
    force = np.concatenate([substep.force for substep in earlier])
    mean = last.force.copy()
    _share(
        keys[order],
        order,
        last.body_a,
        normal,
        _keys(body_a, body_b, lowest, span),
        body_a,
        force,
        1 + len(earlier),
        mean,
    )
    return mean


def _keys(body_a: IntArray, body_b: IntArray, lowest: int, span: int) -> IntArray:
    """Return a number (n,) for each pair, independent of the order of its bodies; -1 for an unknown id.

    The known ids are the ``span`` ids from ``lowest`` on.
    """
    low, high = np.minimum(body_a, body_b) - lowest, np.maximum(body_a, body_b) - lowest
    keys: IntArray = np.where((low >= 0) & (high < span), low * span + high, -1)
    return keys


@numba.njit(
    "(int64[:], int64[:], int64[:], float64[:, :], int64[:], int64[:], float64[:, :], int64, float64[:, :])", cache=True
)
def _share(
    sorted_keys: IntArray,
    order: IntArray,
    body_a: IntArray,
    normal: FloatArray,
    keys: IntArray,
    earlier_a: IntArray,
    earlier: FloatArray,
    substeps: int,
    force: FloatArray,
) -> None:
    """Add the earlier forces of each pair to the ``force`` of its rows, and divide by the number of substeps."""
    n = len(sorted_keys)
    total = np.zeros((n, 3))  # earlier force on body b of each pair, at the index of the pair's first row
    for row in range(len(keys)):
        first = np.searchsorted(sorted_keys, keys[row])
        if first < n and sorted_keys[first] == keys[row]:
            sign = 1.0 if body_a[order[first]] == earlier_a[row] else -1.0
            for k in range(3):
                total[first, k] += sign * earlier[row, k]
    first = 0
    while first < n:
        last = first
        pressed = 0.0
        while last < n and sorted_keys[last] == sorted_keys[first]:
            row = order[last]
            pressed += max(
                0.0, force[row, 0] * normal[row, 0] + force[row, 1] * normal[row, 1] + force[row, 2] * normal[row, 2]
            )
            last += 1
        for place in range(first, last):
            row = order[place]
            share = 1.0 / (last - first)
            if pressed > 0.0:
                along = force[row, 0] * normal[row, 0] + force[row, 1] * normal[row, 1] + force[row, 2] * normal[row, 2]
                share = max(0.0, along) / pressed
            sign = 1.0 if body_a[row] == body_a[order[first]] else -1.0
            for k in range(3):
                force[row, k] = (force[row, k] + sign * share * total[first, k]) / substeps
        first = last
