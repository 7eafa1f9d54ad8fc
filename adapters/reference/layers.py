"""Layers of a stack: groups of contacts, by the number of contacts between a body and the fixed boxes.

In this module a fixed box is any box that contacts do not move, also a frozen box or a box that the host moves. The
height of a body is the least number of contacts on a path to a fixed box: 1 for a body on the ground. A contact
belongs to the layer of its lower body. If both bodies have the same height, the contact belongs to the layer below.
Then the solver treats the contact when both bodies may move.

    layer of a contact between heights a and b:  min(a, b)  if a != b,  a - 1  otherwise

In layer l, bodies of height l are the floor and do not move, and bodies of height l + 1 are the passengers.
"""

from __future__ import annotations

import numba
import numpy as np

from stability_core.port import IntArray


@numba.njit(cache=True)
def heights_of(body: IntArray, bodies: int) -> IntArray:
    """Return the height of each live body, shape (m,), by a breadth-first search from the fixed boxes.

    A body without a path of contacts to a fixed box counts as one contact higher than the highest body with a path.

    Args:
        body: live bodies a and b of each contact, -1 for a fixed box, shape (n, 2).
        bodies: number m of the live bodies.
    """
    height = np.full(bodies, -1)
    first, neighbour = _neighbours(body, bodies)
    queue = np.empty(bodies, np.int64)
    end = 0
    for c in range(len(body)):
        for side in range(2):
            i = body[c, side]
            if i >= 0 and body[c, 1 - side] < 0 and height[i] < 0:
                height[i] = 1
                queue[end] = i
                end += 1
    place = 0
    while place < end:
        i = queue[place]
        place += 1
        for k in range(first[i], first[i + 1]):
            j = neighbour[k]
            if height[j] < 0:
                height[j] = height[i] + 1
                queue[end] = j
                end += 1
    highest = 0
    for i in range(bodies):
        highest = max(highest, height[i])
    for i in range(bodies):
        if height[i] < 0:
            height[i] = highest + 1
    return height


@numba.njit(cache=True)
def _neighbours(body: IntArray, bodies: int) -> tuple[IntArray, IntArray]:
    """Return the start index of each live body in a list of neighbours, and this list."""
    first = np.zeros(bodies + 1, np.int64)
    for c in range(len(body)):
        if body[c, 0] >= 0 and body[c, 1] >= 0:
            first[body[c, 0] + 1] += 1
            first[body[c, 1] + 1] += 1
    first = np.cumsum(first)
    neighbour = np.empty(first[bodies], np.int64)
    filled = first[:-1].copy()
    for c in range(len(body)):
        a, b = body[c]
        if a >= 0 and b >= 0:
            neighbour[filled[a]], neighbour[filled[b]] = b, a
            filled[a] += 1
            filled[b] += 1
    return first, neighbour


@numba.njit(cache=True)
def layers_of(body: IntArray, height: IntArray) -> IntArray:
    """Return the layer of each contact, shape (n,); the heights of fixed boxes are 0."""
    layer = np.empty(len(body), np.int64)
    for c in range(len(body)):
        a = height[body[c, 0]] if body[c, 0] >= 0 else 0
        b = height[body[c, 1]] if body[c, 1] >= 0 else 0
        layer[c] = min(a, b) if a != b else a - 1
    return layer
