"""Turn the core's memory when gravity changes by more than its tolerances.

A patch keeps its points and its normal. The module derives the kind, the upper body and the hull of each patch again,
because all three depend on the direction of gravity. For example, a face that carried a body may become a side, and a
side may become a support. The module drops patches of live bodies, because later steps rebuild these patches from the
contacts of the dwell frames.
"""

from __future__ import annotations

import numpy as np

from stability_core.compiled import compiled
from stability_core.contact_filter import is_level, upper_of
from stability_core.frame_buffers import FrameBuffers
from stability_core.manifold import lift, shape_patch
from stability_core.port import FloatArray, IntArray
from stability_core.stack import (
    ABSENT,
    FROZEN,
    LEAN,
    NONE,
    NOT_REFUSED,
    SUPPORT,
    Bodies,
    Graph,
    is_immovable,
    link,
    note_change,
    unlink,
)
from stability_core.upright import turned


@compiled
def _turn_vector(vector: FloatArray, turn: FloatArray) -> None:
    x, y, z = vector[0], vector[1], vector[2]
    for k in range(3):
        vector[k] = x * turn[k, 0] + y * turn[k, 1] + z * turn[k, 2]


@compiled
def _turn_bodies(bodies: Bodies, turn: FloatArray) -> None:
    """Turn the positions of all bodies, and reset the policy's refusals and the times ``steady_s``."""
    for i in range(len(bodies)):
        row = bodies[i]
        if row.state == ABSENT:
            continue
        for place in (row.center, row.still_center, row.steady_center, row.load_center, row.stack_center):
            _turn_vector(place, turn)
        row.steady_s, row.refusal = 0.0, NOT_REFUSED


@compiled
def _turn_contacts(bodies: Bodies, buffers: FrameBuffers, turn: FloatArray, level_tilt: float) -> None:
    """Turn the contacts of the dwell frames, and decide again which contacts are load-bearing."""
    contacts, sizes = buffers.contacts, buffers.sizes
    room = len(contacts) // len(sizes)
    for frame in range(len(sizes)):
        for i in range(frame * room, frame * room + sizes[frame]):
            row = contacts[i]
            _turn_vector(row.point, turn)
            _turn_vector(row.normal, turn)
            upper = upper_of(row.body_a, row.body_b, row.normal[2])
            row.level = is_level(row.normal[2], row.friction, level_tilt) and not is_immovable(bodies, upper)


@compiled
def _patches_of_frozen(graph: Graph) -> IntArray:
    """List frozen bodies as changed, drop the patches of other bodies, and return the remaining patches, shape (k,)."""
    bodies, patches = graph.bodies, graph.patches
    rows = np.empty(len(patches), np.int64)
    n = 0
    for body in range(len(bodies)):
        if bodies[body].state != FROZEN:
            lift(graph, body)
            continue
        note_change(graph, body)
        at = bodies[body].first_support
        while at != NONE:
            rows[n] = at
            n += 1
            at = patches[at].next_support
    return rows[:n]


@compiled
def _turn_patch(graph: Graph, at: int, turn: FloatArray, level_tilt: float) -> None:
    """Turn a patch of a frozen body, and derive its kind, its upper body and its hull for the new direction.

    If the lower body becomes the upper body, but is not frozen, the function removes the patch.
    """
    patch = graph.patches[at]
    upper, lower, friction = patch.upper, patch.lower, patch.friction
    points = turned(patch.vertex[: patch.vertices], turn)
    normal = patch.normal.copy()
    _turn_vector(normal, turn)
    kind = SUPPORT if is_level(normal[2], friction, level_tilt) else LEAN
    if kind == SUPPORT and normal[2] < 0.0:
        if is_immovable(graph.bodies, lower):
            kind = LEAN  # a ceiling carries nothing
        else:
            unlink(graph, at)
            if graph.bodies[lower].state != FROZEN:
                return
            upper, lower = lower, upper
            patch = link(graph, upper, lower, kind)
            for k in range(3):
                normal[k] = -normal[k]
    patch.kind, patch.friction = kind, friction
    for k in range(3):
        patch.normal[k] = normal[k]
    shape_patch(patch, points)


@compiled
def turn_memory(graph: Graph, buffers: FrameBuffers, turn: FloatArray, level_tilt: float) -> None:
    """Turn bodies, contacts and patches, and list every frozen body as changed: O(all rows).

    Args:
        graph: the stack.
        buffers: the contacts of the dwell frames.
        turn: rotation from the former to the present upright coordinates, shape (3, 3).
        level_tilt: slope [rad] up to which a contact is load-bearing at any friction.
    """
    _turn_bodies(graph.bodies, turn)
    _turn_contacts(graph.bodies, buffers, turn, level_tilt)
    for at in _patches_of_frozen(graph):
        _turn_patch(graph, at, turn, level_tilt)
