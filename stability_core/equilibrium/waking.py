"""Find the bodies that rest on unfreezing bodies, by the kept forces: a contact without force carries nothing."""

from __future__ import annotations

import numpy as np

from stability_core.compiled import compiled
from stability_core.equilibrium.memory import Memory, carries, is_held, is_known
from stability_core.equilibrium.region import Regions, is_safe, region_of
from stability_core.port import GROUND, IntArray
from stability_core.stack import FROZEN, LEAN, NONE, PROVEN, Graph, is_in_doubt


@compiled
def _rests_by(graph: Graph, memory: Memory, regions: Regions, at: int, gravity: float) -> bool:
    """Return True if the upper body of the patch ``at`` may need this patch: O(patches of the body).

    A proven body does not need the patch in two cases:

    - the kept forces hold the body, and the patch carries none of these forces;
    - the body only leans there, and lies in the safe region of its supports.
    """
    upper = graph.patches[at].upper
    if graph.bodies[upper].doubt != PROVEN:
        return True
    if is_known(graph, memory, at):
        return carries(memory, at) or not is_held(graph, memory, upper, gravity)
    leans = graph.patches[at].kind == LEAN
    return not (leans and is_safe(graph, regions, upper, region_of(graph, regions, upper)))


@compiled
def resting_on(graph: Graph, memory: Memory, regions: Regions, roots: IntArray, gravity: float) -> IntArray:
    """Return ``roots`` and the frozen bodies that rest on them, as ``stack.with_all_above``, shape (k,).

    A body that only touches another body does not rest on it. If its balance needs the contact nevertheless, the
    next frame finds that out, because ``stack.drop_frozen_loads`` removes the contact.
    """
    bodies, patches = graph.bodies, graph.patches
    reached = np.zeros(len(bodies), np.bool_)
    found = np.empty(len(bodies), np.int64)
    size = 0
    for root in roots:
        if not reached[root]:
            reached[root] = True
            found[size] = root
            size += 1
    done = 0
    while done < size:
        at = bodies[found[done]].first_load
        while at != NONE:
            upper = patches[at].upper
            rests = not reached[upper] and bodies[upper].state == FROZEN
            if rests and _rests_by(graph, memory, regions, at, gravity):
                reached[upper] = True
                found[size] = upper
                size += 1
            at = patches[at].next_load
        at = bodies[found[done]].first_support
        while at != NONE:
            lower = patches[at].lower
            if lower != GROUND and not reached[lower] and is_in_doubt(bodies, lower):
                reached[lower] = True
                found[size] = lower
                size += 1
            at = patches[at].next_support
        done += 1
    return found[:size]
