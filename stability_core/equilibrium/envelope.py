"""Cholesky factors of the sparse matrices of a stack, kept in an envelope (skyline) of their rows.

A row is stored from its first entry to its diagonal. Numbered in reverse Cuthill-McKee order a column or a wall of
n bodies has rows of bounded length, so that a factor costs O(n); a pile whose widest layer has w bodies O(n w^2).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from stability_core.compiled import compiled
from stability_core.port import FloatArray, IntArray


class Envelope(NamedTuple):
    """Which entries of a lower triangle are stored."""

    first: IntArray
    """First stored column of each row, shape (n,)."""
    offset: IntArray
    """Entry (i, j) is stored at ``offset[i] + j``, shape (n,)."""
    size: int
    """Number of stored entries."""


@compiled
def _neighbours(body_a: IntArray, body_b: IntArray, n: int) -> tuple[IntArray, IntArray]:
    """Who touches whom, as rows of one list: (starts (n + 1,), list). A pair may be listed more than once."""
    start = np.zeros(n + 1, np.int64)
    for fill in range(2):
        listed = np.empty(start[n] if fill else 0, np.int64)
        at = start.copy()
        last_a, last_b = -1, -1
        for c in range(len(body_a)):
            a, b = body_a[c], body_b[c]
            if a < 0 or b < 0 or (a == last_a and b == last_b):
                continue
            last_a, last_b = a, b
            if fill:
                listed[at[a]], listed[at[b]] = b, a
                at[a] += 1
                at[b] += 1
            else:
                start[a + 1] += 1
                start[b + 1] += 1
        if not fill:
            for i in range(n):
                start[i + 1] += start[i]
    return start, listed


@compiled
def _spread(start: IntArray, listed: IntArray, root: int, reached: IntArray, mark: int, order: IntArray) -> int:
    """Breadth first from ``root`` into ``order``, at each body those with the fewest neighbours first."""
    order[0] = root
    reached[root] = mark
    size, done = 1, 0
    while done < size:
        begin = size
        for i in range(start[order[done]], start[order[done] + 1]):
            body = listed[i]
            if reached[body] == mark:
                continue
            reached[body] = mark
            degree = start[body + 1] - start[body]
            place = size
            while place > begin and start[order[place - 1] + 1] - start[order[place - 1]] > degree:
                order[place] = order[place - 1]
                place -= 1
            order[place] = body
            size += 1
        done += 1
    return size


@compiled
def numbering(body_a: IntArray, body_b: IntArray, n: int) -> IntArray:
    """Place of each body in reverse Cuthill-McKee order, shape (n,).

    Each component begins at an end: at the last body that a walk from any of its bodies comes to.

    Args:
        body_a: first body of each contact, from 0, or negative if it is fixed, shape (m,).
        body_b: second body, shape (m,).
        n: number of bodies.
    """
    start, listed = _neighbours(body_a, body_b, n)
    order = np.empty(n, np.int64)
    reached = np.zeros(n, np.int64)
    place = np.empty(n, np.int64)
    done = 0
    for root in range(n):
        if reached[root]:
            continue
        size = _spread(start, listed, root, reached, 1, order)
        size = _spread(start, listed, order[size - 1], reached, 2, order)
        for i in range(size):
            place[order[i]] = n - 1 - done - i
        done += size
    return place


@compiled
def envelope_of(body_a: IntArray, body_b: IntArray, place: IntArray, width: int) -> Envelope:
    """The envelope of a matrix with a block of ``width`` rows a body and an entry for each touching pair."""
    n = len(place)
    first_block = np.arange(n)
    for c in range(len(body_a)):
        if body_a[c] >= 0 and body_b[c] >= 0:
            i, j = place[body_a[c]], place[body_b[c]]
            low, high = min(i, j), max(i, j)
            first_block[high] = min(first_block[high], low)
    first = np.empty(n * width, np.int64)
    offset = np.empty(n * width, np.int64)
    size = 0
    for i in range(n * width):
        first[i] = first_block[i // width] * width
        offset[i] = size - first[i]
        size += i + 1 - first[i]
    return Envelope(first, offset, size)


@njit(cache=True, fastmath={"reassoc", "contract"})  # reassociation lets the sum use SIMD lanes
def _dot(values: FloatArray, p: int, q: int, count: int) -> float:
    total = 0.0
    for k in range(count):
        total += values[p + k] * values[q + k]
    return total


@compiled
def factorize(matrix: FloatArray, envelope: Envelope) -> None:
    """Replace a positive definite matrix by its Cholesky factor, in place; the diagonal is stored inverted."""
    first, offset = envelope.first, envelope.offset
    for i in range(len(first)):
        for j in range(first[i], i):
            low = max(first[i], first[j])
            inner = _dot(matrix, offset[i] + low, offset[j] + low, j - low)
            matrix[offset[i] + j] = (matrix[offset[i] + j] - inner) * matrix[offset[j] + j]
        at = offset[i] + first[i]
        pivot = matrix[offset[i] + i] - _dot(matrix, at, at, i - first[i])
        matrix[offset[i] + i] = 1.0 / np.sqrt(max(pivot, 1e-300))


@compiled
def substitute(factor: FloatArray, envelope: Envelope, x: FloatArray) -> None:
    """Solve with the factor, in place: ``x`` holds the right side, then the solution."""
    first, offset = envelope.first, envelope.offset
    n = len(first)
    for i in range(n):
        total = x[i]
        for j in range(first[i], i):
            total -= factor[offset[i] + j] * x[j]
        x[i] = total * factor[offset[i] + i]
    for i in range(n - 1, -1, -1):
        x[i] *= factor[offset[i] + i]
        for j in range(first[i], i):
            x[j] -= factor[offset[i] + j] * x[i]
