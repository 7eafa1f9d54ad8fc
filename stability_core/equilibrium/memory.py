"""The certificate: kept contact forces that held the stack at the latest solve.

The next solve starts from the kept forces. After a change, a solve includes only the affected bodies, because the kept
forces still hold all other bodies. ``is_held`` checks the kept forces against the present patches. Forces that are out
of date, or belong to another patch, fail the check, and the solve includes their bodies as well.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stability_core.compiled import compiled
from stability_core.equilibrium.problem import add_wrench
from stability_core.port import FloatArray, IntArray
from stability_core.stack import MAX_VERTICES, NONE, Graph, is_stack

KEPT_BALANCED = 1e-8
"""Imbalance, relative to the largest force on a body, up to which kept forces balance the body. The value is ten times
``BALANCED``, because the core measures the sizes of bodies again after the solve."""


class Memory(NamedTuple):
    """Kept forces, with one row for each row of ``Graph.patches``."""

    pair: IntArray
    """Upper body, lower body and kind of the patch to which the forces belong, shape (n, 3)."""
    force: FloatArray
    """Force [N] on the upper body at each vertex, shape (n, MAX_VERTICES, 3)."""


def memory_for(patches: int, known: Memory | None = None) -> Memory:
    """Return a table of ``patches`` rows with a copy of the ``known`` rows."""
    fresh = Memory(np.full((patches, 3), NONE), np.zeros((patches, MAX_VERTICES, 3)))
    if known is not None:
        rows = np.flatnonzero(known.pair[:, 0] != NONE)
        fresh.pair[rows], fresh.force[rows] = known.pair[rows], known.force[rows]
    return fresh


@compiled
def _is_of(graph: Graph, at: int, pair: IntArray) -> bool:
    patch = graph.patches[at]
    return bool(patch.upper == pair[0] and patch.lower == pair[1] and patch.kind == pair[2])


@compiled
def is_known(graph: Graph, memory: Memory, at: int) -> bool:
    """Return True if the kept forces of row ``at`` belong to the present patch of this row."""
    return _is_of(graph, at, memory.pair[at])


@compiled
def carries(memory: Memory, at: int) -> bool:
    """Return True if a kept force of row ``at`` is not zero."""
    return bool(memory.force[at].any())


@compiled
def is_held(graph: Graph, memory: Memory, body: int, gravity: float) -> bool:
    """Return True if the kept forces hold a frozen body: O(patches of the body).

    The forces must lie in the Coulomb cones of the body's contacts, and balance its weight. Only contacts with the
    ground and with frozen bodies count.
    """
    bodies, patches = graph.bodies, graph.patches
    row = bodies[body]
    rest, lever = np.zeros(6), np.empty(3)
    rest[2] = row.mass * gravity
    largest, size = rest[2], row.size
    for upwards in range(2):
        at = row.first_load if upwards else row.first_support
        while at != NONE:
            patch = patches[at]
            other = patch.upper if upwards else patch.lower
            here, at = at, patch.next_load if upwards else patch.next_support
            if not is_stack(bodies, other) or not is_known(graph, memory, here):
                continue
            sign = 1.0 if upwards else -1.0
            for vertex in range(patch.vertices):
                force = memory.force[here, vertex]
                if not _is_in_cone(force, patch.normal, patch.friction):
                    return False
                for k in range(3):
                    lever[k] = patch.vertex[vertex, k] - row.center[k]
                add_wrench(rest, sign, force, lever, size)
                largest = max(largest, abs(force[0]), abs(force[1]), abs(force[2]))
    return bool(np.abs(rest).max() <= KEPT_BALANCED * largest)


@compiled
def _is_in_cone(force: FloatArray, normal: FloatArray, friction: float) -> bool:
    along, total = 0.0, 0.0
    for k in range(3):
        along += force[k] * normal[k]
        total += force[k] ** 2
    across = total - along**2
    limit = friction * along
    return bool(along >= 0.0 and across <= limit**2 + KEPT_BALANCED * total)


@compiled
def recall(graph: Graph, memory: Memory, patches: IntArray, contacts: int) -> FloatArray:
    """Return the kept forces, or zero if unknown, at all vertices of the ``patches`` (p,), shape (contacts, 3)."""
    force = np.zeros((contacts, 3))
    c = 0
    for at in patches:
        size = graph.patches[at].vertices
        if is_known(graph, memory, at):
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
    """Copy the kept forces to the new rows of rebuilt patches of ``bodies`` (k,).

    The cost is O(p log p), and O(log p) per patch of the bodies.

    Args:
        graph: the stack.
        memory: the kept forces, in the rows ``patches``.
        patches: the former rows, shape (p,).
        bodies: the bodies of patches that may have new rows.
    """
    order = np.argsort(memory.pair[patches, 0])
    pair, force = memory.pair[patches[order]], memory.force[patches[order]]
    for body in bodies:
        first = np.searchsorted(pair[:, 0], body)
        at = graph.bodies[body].first_support
        while at != NONE:
            i = first
            while i < len(pair) and pair[i, 0] == body:
                if _is_of(graph, at, pair[i]):
                    memory.pair[at], memory.force[at] = pair[i], force[i]
                i += 1
            at = graph.patches[at].next_support
