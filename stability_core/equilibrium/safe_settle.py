"""Cheap proofs in compiled calls: freeze bodies in safe regions, and refuse bodies that topple alone.

``policies.equilibrium`` solves the remaining candidates.
"""

from __future__ import annotations

import numpy as np

from stability_core.compiled import compiled
from stability_core.contact_filter import ContactRows
from stability_core.equilibrium.live_loads import is_upright
from stability_core.equilibrium.region import (
    Regions,
    is_safe,
    is_unchanged,
    keep_proof,
    keep_proof_of_neighbours,
    note_doubts,
    region_of,
    topples_alone,
    topples_off,
)
from stability_core.frame_buffers import AT_REST, LEANING, FrameBuffers, listed
from stability_core.polygon import width
from stability_core.port import GROUND, FloatArray, IntArray
from stability_core.settings import ROUNDING_S, Limits
from stability_core.settle import lay_due, lay_frozen, lowest_first, write_down
from stability_core.stack import FROZEN, LIVE, NONE, SUPPORT, TOPPLES, Bodies, Graph, Patches, sorted_ids, take_changed
from stability_core.stack_mass import support_polygon

SAFE, LEFT, UNSOLVED = range(3)
"""Rows of the results of ``settle_safely``:

- SAFE: frozen bodies;
- LEFT: undecided candidates, which need a joint solve;
- UNSOLVED: bodies whose part of the stack needs a new solve.
"""


@compiled
def _is_ready(body: Bodies, limits: Limits) -> bool:
    """Return True if a body is at rest, and no blow has shaken the live bodies around it for ``quiet_s``."""
    return bool(body.is_resting and body.quiet_s >= limits[0].quiet_s - ROUNDING_S)


@compiled
def _leave_shaken(graph: Graph, buffers: FrameBuffers, limits: Limits) -> None:
    """Take the shaken bodies from the lists AT_REST and LEANING: O(listed).

    Blows shake a pile while bodies are poured onto it, and would unfreeze what freezes between two blows.
    """
    for rule in (AT_REST, LEANING):
        bodies = buffers.worklist[rule]
        kept = 0
        for body in listed(buffers, rule):
            if graph.bodies[body].quiet_s >= limits[0].quiet_s - ROUNDING_S:
                kept += 1
                bodies[kept] = body
        bodies[0] = kept


@compiled
def _list_stacked(graph: Graph, buffers: FrameBuffers, limits: Limits) -> None:
    """Add to the list AT_REST the bodies at rest that stand on its bodies, directly or through other bodies: O(added).

    Therefore a stack at rest freezes in one frame, at any height.
    """
    bodies, patches = graph.bodies, graph.patches
    at_rest = buffers.worklist[AT_REST]
    reached = np.zeros(len(bodies), np.bool_)
    for body in listed(buffers, AT_REST):
        reached[body] = True
    done = 1
    while done <= at_rest[0]:
        at = bodies[at_rest[done]].first_load
        done += 1
        while at != NONE:
            upper, kind = patches[at].upper, patches[at].kind
            at = patches[at].next_load
            if (
                kind == SUPPORT
                and not reached[upper]
                and bodies[upper].state == LIVE
                and _is_ready(bodies[upper], limits)
            ):
                reached[upper] = True
                at_rest[0] += 1
                at_rest[at_rest[0]] = upper


@compiled
def _freeze_safely(graph: Graph, regions: Regions, candidates: IntArray) -> tuple[IntArray, IntArray]:
    """Freeze the ``candidates`` in safe regions in the given order, and return the frozen and the undecided bodies.

    Pass the candidates lowest first, because regions build on lower regions. A body that topples alone stays live, and
    does not count as undecided. The same holds for a body that leans, and touched only live bodies in this frame.
    """
    bodies = graph.bodies
    frozen, left = np.empty(len(candidates), np.int64), np.empty(len(candidates), np.int64)
    n, m = 0, 0
    for i in range(len(candidates)):
        body = candidates[i]
        region = region_of(graph, regions, body)
        if is_safe(graph, regions, body, region):
            bodies[body].state = FROZEN
            bodies[body].leans = False
            keep_proof(graph, regions, body, region)
            keep_proof_of_neighbours(graph, regions, body)
            frozen[n] = body
            n += 1
        elif not bodies[body].touches and not is_upright(graph, candidates[i : i + 1]):
            continue
        elif not topples_alone(graph, body, support_polygon(graph, body)):
            left[m] = body
            m += 1
        else:
            bodies[body].refusal = TOPPLES
    return frozen[:n], left[:m]


@compiled
def _on_edge(graph: Graph, candidates: IntArray, flat_width: float) -> IntArray:
    """Return the live ``candidates`` that stand on an edge of at most ``flat_width`` [sizes], shape (k,).

    A body on an edge may freeze while the body still moves slightly. A flat body waits until it is at rest.
    """
    bodies = graph.bodies
    found = np.empty(len(candidates), np.int64)
    n = 0
    for body in candidates:
        if bodies[body].state == LIVE and width(support_polygon(graph, body)) <= flat_width * bodies[body].size:
            found[n] = body
            n += 1
    return found[:n]


@compiled
def _with_resting(graph: Graph, candidates: IntArray, limits: Limits) -> IntArray:
    """Return the ``candidates``, and the live bodies at rest below, directly or indirectly, by rising id.

    Bodies that hold each other must freeze together, although these bodies may come to rest at different times.
    """
    bodies, patches = graph.bodies, graph.patches
    reached = np.zeros(len(bodies), np.bool_)
    found = np.empty(len(bodies), np.int64)
    size = len(candidates)
    found[:size] = candidates
    reached[candidates] = True
    done = 0
    while done < size:
        at = bodies[found[done]].first_support
        done += 1
        while at != NONE:
            other = patches[at].lower
            at = patches[at].next_support
            if (
                other != GROUND
                and not reached[other]
                and bodies[other].state == LIVE
                and _is_ready(bodies[other], limits)
            ):
                reached[other] = True
                found[size] = other
                size += 1
    return sorted_ids(found[:size])


@compiled
def keep_proofs(graph: Graph, regions: Regions, bodies: IntArray) -> None:
    """Record that the ``bodies`` (k,) stand together.

    Pass the bodies lowest first, because regions build on lower regions.
    """
    for body in bodies:
        keep_proof(graph, regions, body, region_of(graph, regions, body))


@compiled
def _is_borne(graph: Graph, regions: Regions, body: int) -> bool:
    """Return True if a cheap proof shows that the stack bears a live ``body`` that lies on the stack or topples off.

    False means unknown.
    """
    region = region_of(graph, regions, body)
    return is_safe(graph, regions, body, region) or topples_off(graph, regions, body, region)


@compiled
def _unproven(graph: Graph, regions: Regions, bodies: IntArray) -> IntArray:
    """Return the frozen ``bodies`` with changed surroundings and the live loads without a cheap proof, shape (k,)."""
    table = graph.bodies
    found = np.empty(len(bodies), np.int64)
    n = 0
    for body in bodies:
        row = table[body]
        is_load = row.state == LIVE and row.first_support != NONE
        if (row.state == FROZEN and not is_unchanged(graph, regions, body)) or (
            is_load and not _is_borne(graph, regions, body)
        ):
            found[n] = body
            n += 1
    return found[:n]


@compiled
def finish(graph: Graph, regions: Regions, buffers: FrameBuffers, limits: Limits, unsolved: IntArray) -> int:
    """Finish the frame after the decision about all candidates: O(1) per changed body.

    Returns:
        Number of bodies written to ``unsolved``: their part of the stack needs a new solve.
    """
    lay_frozen(graph, buffers, limits)
    note_doubts(graph, regions)
    return write_down(unsolved, _unproven(graph, regions, take_changed(graph)))


@compiled
def settle_safely(
    bodies: Bodies,
    patches: Patches,
    spare: IntArray,
    changed: IntArray,
    regions: Regions,
    contacts: ContactRows,
    sizes: IntArray,
    latest: IntArray,
    clock: FloatArray,
    worklist: IntArray,
    limits: Limits,
    found: IntArray,
) -> tuple[int, int, int]:
    """Settle the frame by cheap proofs, but leave ``finish`` to the caller if a candidate stays undecided.

    If no candidate stays undecided, the cost is O(1) per body on the worklist and per changed body. ADR-0002 gives the
    reason for the separate array arguments.

    Returns:
        Numbers of bodies written to the rows of ``found``, shape (3, bodies):

        - SAFE: frozen bodies;
        - LEFT: undecided candidates, which need a joint solve;
        - UNSOLVED: bodies whose part of the stack needs a new solve, or 0 if a body is LEFT.
    """
    graph = Graph(bodies, patches, spare, changed)
    buffers = FrameBuffers(contacts, sizes, latest, clock, worklist)
    if buffers.worklist[AT_REST, 0] + buffers.worklist[LEANING, 0] > 0:
        _leave_shaken(graph, buffers, limits)
        _list_stacked(graph, buffers, limits)
    lay_due(graph, buffers, limits)
    frozen, left = _freeze_safely(graph, regions, lowest_first(graph, listed(buffers, AT_REST)))
    on_edge = _on_edge(graph, listed(buffers, LEANING), limits[0].flat_width)
    safe = write_down(found[SAFE], frozen)
    if len(left) + len(on_edge) > 0:
        return (
            safe,
            write_down(found[LEFT], _with_resting(graph, np.unique(np.concatenate((left, on_edge))), limits)),
            0,
        )
    return safe, 0, finish(graph, regions, buffers, limits, found[UNSOLVED])
