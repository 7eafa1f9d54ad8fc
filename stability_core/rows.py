"""Rows of the table of bodies by id. Memory grows with the number of bodies in the world, not with the greatest id.

A hash table with linear probing, at most half full, holds the ids (Knuth, The Art of Computer Programming 3, 6.4). When
a body leaves the world, later entries of the hash table move up to close the gap (Algorithm R). A new body may get the
row of the body that left. Bodies get rows in order of appearance, by rising id within a frame. If bodies 0, 1, 2 ...
appear in this order and no body leaves, they have rows 0, 1, 2 ...
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stability_core.compiled import compiled
from stability_core.port import GROUND, IntArray
from stability_core.stack import NONE, sorted_ids

UNKNOWN = -2
"""Row of an unknown body."""
_GOLDEN = np.uint64(0x9E3779B97F4A7C15)
"""2^64 over the golden ratio, because multiples of this number spread consecutive ids evenly (Fibonacci hashing)."""
_HALF = np.uint64(32)


class Rows(NamedTuple):
    """The row of each body in ``Graph.bodies``."""

    slots: IntArray
    """Id and row of a body in each slot, shape (2**k, 2). The id is NONE in a free slot."""
    spare: IntArray
    """Free rows: their number, then the rows, shape (1 + rows,). A new body takes the last of these rows."""


@compiled
def _home(slots: IntArray, body: int) -> np.int64:
    """Return the slot at which the search for a body starts."""
    key = np.uint64(body)
    mixed = (key ^ (key >> _HALF)) * _GOLDEN
    return np.int64((mixed >> _HALF) & np.uint64(len(slots) - 1))


@compiled
def _slot_of(slots: IntArray, body: int) -> int:
    """Return the slot of a body, or the free slot for a body without a row."""
    last = len(slots) - 1
    at = _home(slots, body)
    while slots[at, 0] != body and slots[at, 0] != NONE:
        at = (at + 1) & last
    return int(at)


@compiled
def find_rows(slots: IntArray, ids: IntArray, rows: IntArray) -> int:
    """Write the row of each of ``ids`` (k,) to ``rows`` (k,): GROUND for the ground, UNKNOWN for an unknown body.

    Return the index in ``ids`` of the first unknown body, or -1.
    """
    first = -1
    for i in range(len(ids)):
        if ids[i] == GROUND:
            rows[i] = GROUND
            continue
        at = _slot_of(slots, ids[i]) if ids[i] >= 0 else 0
        rows[i] = slots[at, 1] if slots[at, 0] == ids[i] else UNKNOWN
        if rows[i] == UNKNOWN and first < 0:
            first = i
    return first


@compiled
def give_rows(slots: IntArray, spare: IntArray, ids: IntArray, rows: IntArray) -> int:
    """Give a row, by rising id, to each body of ``ids`` (k,) that is UNKNOWN in ``rows`` (k,), and update ``rows``.

    Return the number of missing rows. If any row is missing, no body gets a row.
    """
    new = ids[rows == UNKNOWN]
    if len(new) > spare[0]:
        return int(len(new) - spare[0])
    for body in sorted_ids(new):
        at = _slot_of(slots, body)
        if slots[at, 0] == NONE:  # otherwise ``ids`` lists the body twice
            slots[at, 0], slots[at, 1] = body, spare[spare[0]]
            spare[0] -= 1
    find_rows(slots, ids, rows)
    return 0


@compiled
def take_row(slots: IntArray, spare: IntArray, body: int) -> None:
    """Free the row of a body, if the body has a row. The rows of other bodies stay the same.

    Later entries of the hash table move up to close the gap (Algorithm R).
    """
    last = len(slots) - 1
    gap = _slot_of(slots, body)
    if slots[gap, 0] == NONE:
        return
    spare[0] += 1
    spare[spare[0]] = slots[gap, 1]
    slots[gap, 0] = NONE
    at = (gap + 1) & last
    while slots[at, 0] != NONE:
        if ((at - _home(slots, slots[at, 0])) & last) >= ((at - gap) & last):
            slots[gap, 0], slots[gap, 1] = slots[at, 0], slots[at, 1]
            slots[at, 0] = NONE
            gap = at
        at = (at + 1) & last


@compiled
def _copy_slots(known: IntArray, slots: IntArray) -> None:
    for i in range(len(known)):
        if known[i, 0] != NONE:
            at = _slot_of(slots, known[i, 0])
            slots[at, 0], slots[at, 1] = known[i, 0], known[i, 1]


def rows_for(count: int, known: Rows | None = None) -> Rows:
    """Return a table with ``count`` rows and at least twice as many slots, and copy the ``known`` rows."""
    slots = np.full((1 << max(1, 2 * count - 1).bit_length(), 2), NONE, np.int64)
    old, free = (0, np.empty(0, np.int64)) if known is None else (len(known.spare) - 1, known.spare[1:])
    if known is not None:
        _copy_slots(known.slots, slots)
        free = free[: known.spare[0]]
    spare = np.zeros(1 + count, np.int64)
    spare[0] = count - old + len(free)
    spare[1 : 1 + spare[0]] = np.concatenate([np.arange(count - 1, old - 1, -1), free])
    return Rows(slots, spare)
