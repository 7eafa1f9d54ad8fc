"""The contact forces that last held the stack: where the search for the next ones begins.

Nothing is taken on trust. Forces that are out of date, or another patch's, only make a search longer, for every
answer is proven anew.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stability_core.compiled import compiled
from stability_core.port import FloatArray, IntArray
from stability_core.stack import MAX_VERTICES, NONE, Graph


class Memory(NamedTuple):
    """One row for each row of ``Graph.patches``."""

    pair: IntArray
    """Upper body, lower body and kind of the patch whose forces these are, shape (n, 3)."""
    force: FloatArray
    """Force [N] on the upper body at each vertex, shape (n, MAX_VERTICES, 3)."""


def memory_for(patches: int, known: Memory | None = None) -> Memory:
    """A table for so many rows of patches, with what is ``known`` taken over."""
    fresh = Memory(np.full((patches, 3), NONE), np.zeros((patches, MAX_VERTICES, 3)))
    if known is not None:
        fresh.pair[: len(known.pair)], fresh.force[: len(known.pair)] = known
    return fresh


@compiled
def _is_of(graph: Graph, at: int, pair: IntArray) -> bool:
    patch = graph.patches[at]
    return bool(patch.upper == pair[0] and patch.lower == pair[1] and patch.kind == pair[2])


@compiled
def recall(graph: Graph, memory: Memory, patches: IntArray, contacts: int) -> FloatArray:
    """The forces at all vertices of the ``patches`` (p,), in this order, shape (contacts, 3); noughts if unknown."""
    force = np.zeros((contacts, 3))
    c = 0
    for at in patches:
        size = graph.patches[at].vertices
        if _is_of(graph, at, memory.pair[at]):
            force[c : c + size] = memory.force[at, :size]
        c += size
    return force


@compiled
def remember(graph: Graph, memory: Memory, patches: IntArray, force: FloatArray) -> None:
    """Keep the forces (m, 3) at all vertices of the ``patches`` (p,)."""
    c = 0
    for at in patches:
        patch = graph.patches[at]
        memory.pair[at, 0], memory.pair[at, 1], memory.pair[at, 2] = patch.upper, patch.lower, patch.kind
        memory.force[at, : patch.vertices] = force[c : c + patch.vertices]
        c += patch.vertices


@compiled
def hand_on(graph: Graph, memory: Memory, patches: IntArray, bodies: IntArray) -> None:
    """Give the patches of ``bodies`` (k,) the forces of the same pairs, if they were laid anew in other rows since.

    O(their patches times p).

    Args:
        graph: the stack.
        memory: with forces kept in the rows ``patches``.
        patches: the rows of before, shape (p,).
        bodies: those whose patches may have been laid anew.
    """
    pair, force = memory.pair[patches], memory.force[patches]
    for body in bodies:
        at = graph.bodies[body].first_support
        while at != NONE:
            for i in range(len(patches)):
                if _is_of(graph, at, pair[i]):
                    memory.pair[at], memory.force[at] = pair[i], force[i]
            at = graph.patches[at].next_support
