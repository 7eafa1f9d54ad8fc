"""Transfer of values from the contacts of one list to the contacts of a later list, by pair and nearest point."""

from __future__ import annotations

import numba
import numpy as np

from adapters.reference.detector import FoundContacts
from stability_core.port import FloatArray, IntArray


def moved_to(later: FoundContacts, earlier: FoundContacts, values: FloatArray) -> FloatArray:
    """Move the vector of each earlier contact to the nearest later contact of the pair; return the sums, shape (n, 3).

    A pair keeps the sum of its vectors, unless the pair has no point in the later list.

    Args:
        later: the contacts of the later list, n.
        earlier: the contacts of the earlier list, k, in the same world.
        values: a vector for each earlier contact, shape (k, 3).
    """
    moved = np.zeros((len(later), 3))
    if len(later) and len(earlier):
        keys, earlier_keys = _keys(later), _keys(earlier)
        order = np.argsort(keys, kind="stable")
        _move(keys[order], order, later.point, earlier_keys, earlier.point, values, moved)
    return moved


def _keys(found: FoundContacts) -> IntArray:
    keys: IntArray = found.row_a * (1 << 32) + found.row_b
    return keys


@numba.njit(cache=True)
def _move(
    keys: IntArray,
    order: IntArray,
    point: FloatArray,
    earlier_keys: IntArray,
    earlier_point: FloatArray,
    values: FloatArray,
    moved: FloatArray,
) -> None:
    """Add each earlier vector to the nearest later point of its pair; ``order`` (n,) sorts ``keys`` (n,)."""
    for row in range(len(earlier_keys)):
        place = np.searchsorted(keys, earlier_keys[row])
        best, least = -1, np.inf
        while place < len(keys) and keys[place] == earlier_keys[row]:
            apart = point[order[place]] - earlier_point[row]
            distance = apart[0] * apart[0] + apart[1] * apart[1] + apart[2] * apart[2]
            if distance < least:
                best, least = order[place], distance
            place += 1
        if best >= 0:
            moved[best] += values[row]
