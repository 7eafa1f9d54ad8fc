"""Find the bodies that a solve must include: all connected bodies, or only the bodies that a change affects."""

from __future__ import annotations

import numpy as np

from stability_core.compiled import compiled
from stability_core.equilibrium.memory import Memory, carries, is_held, is_known
from stability_core.port import GROUND, BoolArray, IntArray
from stability_core.stack import FROZEN, NONE, SUPPORT, Graph


@compiled
def component(graph: Graph, seeds: IntArray, members: IntArray) -> IntArray:
    """Return the ``seeds``, and the frozen bodies and ``members`` that patches join to the seeds, shape (k,).

    The patches join the bodies directly, or through other bodies of the result. The cost is O(k), besides two arrays
    with an entry for each row of the table.

    Args:
        graph: the stack.
        seeds: first bodies, shape (n,).
        members: live bodies that count as frozen, shape (m,).
    """
    bodies = graph.bodies
    joins = np.zeros(len(bodies), np.bool_)
    joins[members] = True
    found = np.empty(len(bodies), np.int64)
    reached = np.zeros(len(bodies), np.bool_)
    size = 0
    for seed in seeds:
        if not reached[seed]:
            reached[seed] = True
            found[size] = seed
            size += 1
    done = 0
    while done < size:
        for upwards in range(2):
            at = bodies[found[done]].first_load if upwards else bodies[found[done]].first_support
            while at != NONE:
                patch = graph.patches[at]
                other = patch.upper if upwards else patch.lower
                at = patch.next_load if upwards else patch.next_support
                if other == GROUND or reached[other]:
                    continue
                if bodies[other].state == FROZEN or joins[other]:
                    reached[other] = True
                    found[size] = other
                    size += 1
        done += 1
    return found[:size]


@compiled
def _reach(body: int, reached: BoolArray, found: IntArray, size: int) -> int:
    """Add a body to ``found`` unless it is ``reached``, and return the number of bodies in ``found``."""
    if reached[body]:
        return size
    reached[body] = True
    found[size] = body
    return size + 1


@compiled
def bearing(graph: Graph, memory: Memory, seeds: IntArray, members: IntArray, gravity: float) -> IntArray:
    """Return the bodies for which a change of the ``seeds`` requires new contact forces, shape (k,).

    The result contains the seeds and all bodies that bear the seeds, down to the ground. The result also contains each
    member beside or above these bodies, and each frozen body there whose kept forces do not balance. All other kept
    forces may stay. If new forces balance the bodies of the result under the kept forces on their border, the whole
    stack is in balance. The cost is O(k), besides arrays with an entry for each row of the table.

    Args:
        graph: the stack.
        memory: the kept forces.
        seeds: bodies with a changed load or changed contacts, frozen or among the members, shape (n,).
        members: live bodies that count as frozen, shape (m,).
        gravity: gravitational acceleration [m/s2], positive.
    """
    bodies, patches = graph.bodies, graph.patches
    joins = np.zeros(len(bodies), np.bool_)
    joins[members] = True
    reached = np.zeros(len(bodies), np.bool_)
    found = np.empty(len(bodies), np.int64)
    size = 0
    for seed in seeds:
        size = _reach(seed, reached, found, size)
    done = 0
    while done < size:
        body = found[done]
        done += 1
        at = bodies[body].first_support
        while at != NONE:
            lower = patches[at].lower
            if lower != GROUND and not reached[lower] and (bodies[lower].state == FROZEN or joins[lower]):
                bears = patches[at].kind == SUPPORT or not is_known(graph, memory, at) or carries(memory, at)
                if bears or joins[lower] or not is_held(graph, memory, lower, gravity):
                    size = _reach(lower, reached, found, size)
            at = patches[at].next_support
        at = bodies[body].first_load
        while at != NONE:
            upper = patches[at].upper
            if not reached[upper] and (
                joins[upper] or (bodies[upper].state == FROZEN and not is_held(graph, memory, upper, gravity))
            ):
                size = _reach(upper, reached, found, size)
            at = patches[at].next_load
    return found[:size]
