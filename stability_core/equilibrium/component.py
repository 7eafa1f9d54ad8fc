"""A part of the stack as a problem of statics: all that is joined through bodies, not through the ground."""

from __future__ import annotations

import numpy as np

from stability_core.compiled import compiled
from stability_core.contact_filter import size_of_pair
from stability_core.equilibrium.problem import Problem
from stability_core.port import GROUND, BoolArray, FloatArray, IntArray
from stability_core.stack import FROZEN, LIVE, NONE, SUPPORT, Graph, is_ground


@compiled
def component(graph: Graph, seeds: IntArray, members: IntArray, with_loads: bool) -> IntArray:
    """All bodies that are joined to the ``seeds`` by patches, shape (k,): O(k).

    Args:
        graph: the stack.
        seeds: where to begin, shape (n,).
        members: live bodies that count as if they were frozen, shape (m,).
        with_loads: whether the live bodies that lie on the stack belong to it as well.
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
                is_load = with_loads and bodies[other].state == LIVE and bodies[other].is_load
                if bodies[other].state == FROZEN or joins[other] or is_load:
                    reached[other] = True
                    found[size] = other
                    size += 1
        done += 1
    return found[:size]


@compiled
def _inner_patches(graph: Graph, ids: IntArray, index: IntArray) -> tuple[IntArray, int]:
    """The patches between the bodies that have an ``index``, and the ground: (rows (p,), number of vertices)."""
    found = np.empty(len(graph.patches), np.int64)
    size, vertices = 0, 0
    for body in ids:
        at = graph.bodies[body].first_support
        while at != NONE:
            lower = graph.patches[at].lower
            if is_ground(graph.bodies, lower) or index[lower] >= 0:
                found[size] = at
                size += 1
                vertices += graph.patches[at].vertices
            at = graph.patches[at].next_support
    return found[:size], vertices


@compiled
def _lever(graph: Graph, at: int, vertex: int, margin: float, body: int, lever: FloatArray) -> float:
    """From a body's centre to a vertex of patch ``at``, moved outwards by ``margin`` [sizes]; returns its length."""
    patch = graph.patches[at]
    outward = np.hypot(patch.vertex[vertex, 0] - patch.center[0], patch.vertex[vertex, 1] - patch.center[1])
    stretch = margin * size_of_pair(graph.bodies, patch.upper, patch.lower) / outward if outward > 0.0 else 0.0
    for k in range(3):
        moved = stretch * (patch.vertex[vertex, k] - patch.center[k]) if k < 2 else 0.0
        lever[k] = patch.vertex[vertex, k] + moved - graph.bodies[body].center[k]
    return float(np.sqrt(lever[0] ** 2 + lever[1] ** 2 + lever[2] ** 2))


@compiled
def _rolling(graph: Graph, patches: IntArray, index: IntArray, n: int, radius: float) -> FloatArray:
    """One for each of the ``n`` bodies that touch in points and lines alone, zero for the others, shape (n,).

    Args:
        graph: the stack.
        patches: rows of the patches between the bodies, shape (p,).
        index: of each body, or negative.
        n: number of bodies.
        radius: width [sizes] up to which a patch is a point or a line.
    """
    found = np.ones(n)
    for at in patches:
        patch = graph.patches[at]
        if patch.width > radius * size_of_pair(graph.bodies, patch.upper, patch.lower):
            found[index[patch.upper]] = 0.0
            if patch.lower != GROUND and index[patch.lower] >= 0:
                found[index[patch.lower]] = 0.0
    return found


@compiled
def problem_of(
    graph: Graph, ids: IntArray, gravity: float, margin: float, grip: float, radius: float
) -> tuple[Problem, BoolArray, IntArray]:
    """The statics of the bodies ``ids`` alone: O(bodies + patches).

    Args:
        graph: the stack.
        ids: the bodies, shape (n,).
        gravity: gravitational acceleration [m/s2], positive.
        margin: by how much [sizes of the smaller body] each vertex of a patch is moved outwards.
        grip: by what each friction coefficient is multiplied.
        radius: by how much [sizes] a contact in a point or a line may be off: see ``Problem.slack``.

    Returns:
        The problem, with the bodies in the order of ``ids``; which contacts can carry a vertical force, (m,); and the
        rows of the patches, each of whose vertices is a contact, in this order.
    """
    n = len(ids)
    index = np.full(len(graph.bodies), -1)
    for i in range(n):
        index[ids[i]] = i
    patches, m = _inner_patches(graph, ids, index)
    body_a, body_b, level = np.empty(m, np.int64), np.empty(m, np.int64), np.empty(m, np.bool_)
    lever_a, lever_b, normal = np.zeros((m, 3)), np.zeros((m, 3)), np.empty((m, 3))
    friction, load, size = np.empty(m), np.zeros((n, 6)), np.zeros(n)
    c = 0
    for at in patches:
        patch = graph.patches[at]
        i, j = index[patch.upper], index[patch.lower] if patch.lower != GROUND else -1
        for vertex in range(patch.vertices):
            body_a[c], body_b[c], level[c] = j, i, patch.kind == SUPPORT
            friction[c] = patch.friction * grip
            for k in range(3):
                normal[c, k] = patch.normal[k]
            size[i] = max(size[i], _lever(graph, at, vertex, margin, patch.upper, lever_b[c]))
            if j >= 0:
                size[j] = max(size[j], _lever(graph, at, vertex, margin, patch.lower, lever_a[c]))
            c += 1
    for c in range(m):
        lever_b[c] /= size[body_b[c]]
        if body_a[c] >= 0:
            lever_a[c] /= size[body_a[c]]
    for i in range(n):
        load[i, 2] = graph.bodies[ids[i]].mass * gravity
    slack = radius * load[:, 2] * _rolling(graph, patches, index, n, radius)
    return Problem(body_a, body_b, lever_a, lever_b, normal, friction, load, slack), level, patches
