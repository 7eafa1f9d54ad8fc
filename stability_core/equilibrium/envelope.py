"""Factors of the sparse matrices of a stack, in an envelope (skyline): each row from its first entry to the diagonal.

In reverse Cuthill-McKee order, the row length of a stack grows with the number w of bodies in its widest layer. For n
bodies, a factorisation costs O(n) in a column, and O(n w^2) in a pile.
"""

from __future__ import annotations

from functools import partial
from typing import NamedTuple

import numpy as np

from stability_core.compiled import compiled
from stability_core.port import FloatArray, IntArray

_summing = partial(compiled, fastmath={"reassoc", "contract"})
"""Decorator for the function of a sum: the compiler may reorder the terms, so that the sum uses SIMD lanes."""


class Envelope(NamedTuple):
    """Layout of the stored entries of a lower triangle."""

    first: IntArray
    """First stored column of each row, shape (n,)."""
    offset: IntArray
    """Offset of each row, shape (n,): entry (i, j) has the place ``offset[i] + j``."""
    size: int
    """Number of stored entries."""


@compiled
def _neighbours(body_a: IntArray, body_b: IntArray, n: int) -> tuple[IntArray, IntArray]:
    """Return the start of each body's neighbours in a list, shape (n + 1,), and the list.

    A neighbour may occur more than once.
    """
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
    """Write the bodies reached from ``root`` to ``order``, breadth first, and return their number.

    The function sets ``reached`` to ``mark`` for these bodies. Among the new neighbours of a body, bodies with fewer
    neighbours come first.
    """
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
    """Return the place of each body in reverse Cuthill-McKee order, shape (n,).

    The function numbers each component from an end: the last body of a breadth-first walk from any body of the
    component.

    Args:
        body_a: index of the first body of each contact, negative for a fixed body, shape (m,).
        body_b: index of the second body, shape (m,).
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
    """Return the envelope of a matrix with ``width`` rows for each body and an entry for each touching pair."""
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


@_summing
def _products(
    left: FloatArray, right: FloatArray, offset: IntArray, i: int, j: int, low: int, high: int, tile: FloatArray
) -> None:
    """Write the scalar products of three rows of ``left`` from i and three rows of ``right`` from j to ``tile`` (3, 3).

    The products extend over the columns from ``low`` up to, but without, ``high``. One pass computes all nine sums, so
    that the sums share their reads.
    """
    a0, b0 = left[offset[i] + low : offset[i] + high], right[offset[j] + low : offset[j] + high]
    a1, b1 = left[offset[i + 1] + low : offset[i + 1] + high], right[offset[j + 1] + low : offset[j + 1] + high]
    a2, b2 = left[offset[i + 2] + low : offset[i + 2] + high], right[offset[j + 2] + low : offset[j + 2] + high]
    s00 = s01 = s02 = s10 = s11 = s12 = s20 = s21 = s22 = 0.0
    for k in range(len(a0)):
        x0, x1, x2 = a0[k], a1[k], a2[k]
        y0, y1, y2 = b0[k], b1[k], b2[k]
        s00 += x0 * y0
        s01 += x0 * y1
        s02 += x0 * y2
        s10 += x1 * y0
        s11 += x1 * y1
        s12 += x1 * y2
        s20 += x2 * y0
        s21 += x2 * y1
        s22 += x2 * y2
    tile[0, 0], tile[0, 1], tile[0, 2] = s00, s01, s02
    tile[1, 0], tile[1, 1], tile[1, 2] = s10, s11, s12
    tile[2, 0], tile[2, 1], tile[2, 2] = s20, s21, s22


@compiled
def factorize(matrix: FloatArray, envelope: Envelope) -> None:
    """Replace a positive definite matrix by its Cholesky factor.

    The function stores the inverse of each diagonal entry of the factor. The number of rows for each body
    must be a multiple of 3, because the function works in tiles of 3 x 3.
    """
    first, offset = envelope.first, envelope.offset
    tile = np.empty((3, 3))
    for i in range(0, len(first), 3):
        for j in range(first[i], i + 1, 3):
            _products(matrix, matrix, offset, i, j, max(first[i], first[j]), j, tile)
            for a in range(3):
                row = offset[i + a] + j
                for b in range(a + 1 if i == j else 3):
                    diagonal = offset[j + b] + j
                    entry = matrix[row + b] - tile[a, b]
                    for k in range(b):
                        entry -= matrix[row + k] * matrix[diagonal + k]
                    if i == j and a == b:
                        matrix[row + b] = 1.0 / np.sqrt(max(entry, 1e-300))
                    else:
                        matrix[row + b] = entry * matrix[diagonal + b]


@_summing
def _dot(left: FloatArray, right: FloatArray) -> float:
    total = 0.0
    for k in range(len(left)):
        total += left[k] * right[k]
    return total


@compiled
def substitute(factor: FloatArray, envelope: Envelope, x: FloatArray) -> None:
    """Replace the right side ``x`` by the solution of the linear system, with the factor of ``factorize``."""
    first, offset = envelope.first, envelope.offset
    n = len(first)
    for i in range(n):
        row = factor[offset[i] + first[i] : offset[i] + i]
        x[i] = (x[i] - _dot(row, x[first[i] : i])) * factor[offset[i] + i]
    for i in range(n - 1, -1, -1):
        row, above = factor[offset[i] + first[i] : offset[i] + i], x[first[i] : i]
        x[i] *= factor[offset[i] + i]
        for k in range(len(row)):
            above[k] -= row[k] * x[i]


@compiled
def _finish_lower(lower: FloatArray, upper: FloatArray, offset: IntArray, i: int, j: int, tile: FloatArray) -> None:
    """Finish L(i, j) of a tile left of the diagonal: subtract the products ``tile``, and divide by U(j, j)."""
    for a in range(3):
        row = offset[i + a] + j
        for b in range(3):
            column = offset[j + b] + j
            entry = lower[row + b] - tile[a, b]
            for k in range(b):
                entry -= lower[row + k] * upper[column + k]
            lower[row + b] = entry * upper[column + b]


@compiled
def _finish_upper(lower: FloatArray, upper: FloatArray, offset: IntArray, j: int, i: int, tile: FloatArray) -> None:
    """Finish U(j, i) of a tile above the diagonal: subtract the products ``tile``, and divide by L(j, j)."""
    for b in range(3):
        column = offset[i + b] + j
        for a in range(3):
            row = offset[j + a] + j
            entry = upper[column + a] - tile[a, b]
            for k in range(a):
                entry -= lower[row + k] * upper[column + k]
            upper[column + a] = entry


@compiled
def _finish_diagonal(lower: FloatArray, upper: FloatArray, offset: IntArray, i: int, tile: FloatArray) -> None:
    """Finish L(i, i) and U(i, i) of a tile on the diagonal: subtract the products ``tile``, and factorize.

    For U(i, i), the function stores the inverse of each diagonal entry.
    """
    for b in range(3):
        for a in range(3):
            row, column = offset[i + a] + i, offset[i + b] + i
            entry = (upper[column + a] if a <= b else lower[row + b]) - tile[a, b]
            for k in range(min(a, b)):
                entry -= lower[row + k] * upper[column + k]
            if a > b:
                lower[row + b] = entry * upper[column + b]
            else:
                upper[column + a] = 1.0 / entry if a == b else entry


@compiled
def factorize_general(lower: FloatArray, upper: FloatArray, envelope: Envelope) -> None:
    """Replace a matrix with a symmetric pattern by its factors L and U.

    In the envelope, ``lower`` holds the lower triangle by rows, and ``upper`` holds the upper triangle by columns, both
    with the diagonal. L has ones on its diagonal. For U, the function stores the inverse of each diagonal entry.

    The function does not pivot. After a zero pivot the result is wrong, and the caller must detect the error by the
    residual. The function works in tiles, as ``factorize`` does.
    """
    first, offset = envelope.first, envelope.offset
    tile = np.empty((3, 3))
    for i in range(0, len(first), 3):
        for j in range(first[i], i, 3):
            low = max(first[i], first[j])
            _products(lower, upper, offset, i, j, low, j, tile)
            _finish_lower(lower, upper, offset, i, j, tile)
            _products(lower, upper, offset, j, i, low, j, tile)
            _finish_upper(lower, upper, offset, j, i, tile)
        _products(lower, upper, offset, i, i, first[i], i, tile)
        _finish_diagonal(lower, upper, offset, i, tile)


@compiled
def substitute_general(lower: FloatArray, upper: FloatArray, envelope: Envelope, x: FloatArray) -> None:
    """Replace the right side ``x`` by the solution of the linear system, with the factors of ``factorize_general``."""
    first, offset = envelope.first, envelope.offset
    n = len(first)
    for i in range(n):
        x[i] -= _dot(lower[offset[i] + first[i] : offset[i] + i], x[first[i] : i])
    for i in range(n - 1, -1, -1):
        column, above = upper[offset[i] + first[i] : offset[i] + i], x[first[i] : i]
        x[i] *= upper[offset[i] + i]
        for k in range(len(column)):
            above[k] -= column[k] * x[i]
