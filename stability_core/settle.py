"""The steps that every policy takes in a frame, before and after its own decision.

All steps are kernels, so that a policy can settle a frame in one compiled call.
"""

from __future__ import annotations

import numpy as np

from stability_core.compiled import compiled
from stability_core.frame_buffers import AT_REST, GONE, LEANING, LYING, FrameBuffers, frames_of, listed
from stability_core.manifold import lay_all, lift
from stability_core.port import IntArray
from stability_core.settings import ROUNDING_S, Limits
from stability_core.stack import FROZEN, LIVE, Graph, note_change_of_supports, sorted_ids


@compiled
def _with_rule(graph: Graph, buffers: FrameBuffers, rule: int, state: int) -> IntArray:
    """Return the bodies in ``state`` on the list of ``rule`` and of no stricter rule, by rising row, shape (k,)."""
    bodies, ids = graph.bodies, listed(buffers, rule)
    found = np.empty(len(ids), np.int64)
    n = 0
    for body in ids:
        if bodies[body].rule == rule and bodies[body].state == state:
            found[n] = body
            n += 1
    return sorted_ids(found[:n])


@compiled
def lay_due(graph: Graph, buffers: FrameBuffers, limits: Limits) -> None:
    """Build the patches of bodies on the worklist, and remove the patches of bodies that no longer lie on the stack.

    Each rule needs the contacts of its own dwell time. The cost is O(contacts of the dwell frames), independent of the
    number of frozen bodies.
    """
    bodies = graph.bodies
    for body in listed(buffers, GONE):
        lift(graph, body)
    for rule in (LYING, LEANING, AT_REST):  # the strictest rule comes last
        for body in listed(buffers, rule):
            bodies[body].rule = rule
    limit = limits[0]
    for rule, dwell in ((LYING, limit.load_s), (AT_REST, limit.rest_s), (LEANING, limit.lean_s)):
        if buffers.worklist[rule, 0] > 0:
            lay_all(graph, buffers, _with_rule(graph, buffers, rule, LIVE), frames_of(buffers, dwell), limit.face_angle)


@compiled
def lay_frozen(graph: Graph, buffers: FrameBuffers, limits: Limits) -> None:
    """Rebuild the patches of newly frozen bodies, and remove the patches of live bodies after a failed leaning test.

    A newly frozen body that touches only the stack keeps its patches. After a failed leaning test, a live body keeps
    its patches only if it has lain on a support for ``load_s``. Otherwise the body may only pass by, and is no load.
    """
    limit = limits[0]
    for rule, dwell in ((AT_REST, limit.rest_s), (LEANING, limit.lean_s)):
        if buffers.worklist[rule, 0] > 0:
            frozen = _with_rule(graph, buffers, rule, FROZEN)
            _lay_on_stack(graph, buffers, frozen, frames_of(buffers, dwell), limit.face_angle)
    bodies = graph.bodies
    for body in listed(buffers, LEANING):
        row = bodies[body]
        if row.rule == LEANING and row.state == LIVE and row.load_s < limit.load_s - ROUNDING_S:
            lift(graph, body)


@compiled
def _lay_on_stack(graph: Graph, buffers: FrameBuffers, frozen: IntArray, frames: int, face_angle: float) -> None:
    bodies = graph.bodies
    again = np.empty(len(frozen), np.int64)
    n = 0
    for body in frozen:
        if bodies[body].provisional:
            again[n] = body
            n += 1
        else:
            note_change_of_supports(graph, body)
    lay_all(graph, buffers, again[:n], frames, face_angle)


@compiled
def lowest_first(graph: Graph, ids: IntArray) -> IntArray:
    """Return the ``ids`` by rising height of the centre of mass, shape (k,)."""
    if len(ids) < 2:
        return ids
    bodies = graph.bodies
    height = np.empty(len(ids))
    for i in range(len(ids)):
        height[i] = bodies[ids[i]].center[2]
    return ids[np.argsort(height, kind="mergesort")]


@compiled
def write_down(row: IntArray, ids: IntArray) -> int:
    """Write the ``ids`` (k,) to the caller's array ``row``, and return k. ADR-0002 gives the reason for the copy."""
    for i in range(len(ids)):
        row[i] = ids[i]
    return len(ids)
