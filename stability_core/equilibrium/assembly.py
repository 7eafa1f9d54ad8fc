"""Assemble the statics problem of a part of the stack, with the action of all other bodies of the stack."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stability_core.compiled import compiled
from stability_core.contact_filter import size_of_pair
from stability_core.equilibrium.memory import Memory, is_known
from stability_core.equilibrium.problem import Problem, add_wrench
from stability_core.port import GROUND, BoolArray, FloatArray, IntArray
from stability_core.stack import NONE, SUPPORT, Graph, is_ground, is_stack

ABSENT_OUTSIDE, AS_BEFORE, FIXED = 0, 1, 2
"""Action of the rest of the stack on a part:

- ABSENT_OUTSIDE: none, as if the rest were absent;
- AS_BEFORE: the kept forces;
- FIXED: rigid support, as if the rest were ground. A body that falls on this support also falls in the whole stack,
  because fixed bodies withstand more than free bodies.
"""


class Terms(NamedTuple):
    """Conditions under which bodies must stand."""

    outside: int
    """Action of the rest of the stack: ABSENT_OUTSIDE, AS_BEFORE or FIXED."""
    gravity: float
    """Gravitational acceleration [m/s2], positive."""
    margin: float = 0.0
    """Horizontal outward shift of each vertex of a patch [sizes of the smaller body of the pair]."""
    grip: float = 1.0
    """Factor on each friction coefficient."""
    radius: float = 0.0
    """Error [sizes] of the contact point of a body that touches only in points and lines: see ``Problem.slack``."""


class Part(NamedTuple):
    """A statics problem, with the rows of its bodies and patches."""

    problem: Problem
    """The problem, with its bodies in the order of ``ids``."""
    ids: IntArray
    """Rows of the bodies, shape (n,)."""
    level: BoolArray
    """Mask of the load-bearing contacts, shape (m,)."""
    patches: IntArray
    """Rows of the patches, shape (p,). Their vertices, in this order, are the contacts."""
    size: FloatArray
    """Longest lever of each body [m], or 1 m without contacts, shape (n,): the unit of moments and levers."""


@compiled
def _patches_of(graph: Graph, ids: IntArray, index: IntArray, outside: int) -> tuple[IntArray, int, IntArray]:
    """Return the patches that join the bodies ``ids`` to each other, to the ground, and to other frozen bodies.

    With ABSENT_OUTSIDE, the function omits patches that join ``ids`` to other frozen bodies.

    Returns:
        Three values:

        - rows of the patches with unknown forces, shape (p,);
        - number of vertices of these patches;
        - rows of the patches with kept forces, shape (q,).
    """
    bodies, patches = graph.bodies, graph.patches
    found, kept = np.empty(len(patches), np.int64), np.empty(len(patches), np.int64)
    size, vertices, border = 0, 0, 0
    for body in ids:
        at = bodies[body].first_support
        while at != NONE:
            lower = patches[at].lower
            if is_ground(bodies, lower) or index[lower] >= 0 or (outside == FIXED and is_stack(bodies, lower)):
                found[size] = at
                size += 1
                vertices += patches[at].vertices
            elif outside == AS_BEFORE and is_stack(bodies, lower):
                kept[border] = at
                border += 1
            at = patches[at].next_support
        at = bodies[body].first_load if outside != ABSENT_OUTSIDE else NONE
        while at != NONE:
            upper = patches[at].upper
            if index[upper] < 0 and is_stack(bodies, upper):
                if outside == FIXED:
                    found[size] = at
                    size += 1
                    vertices += patches[at].vertices
                else:
                    kept[border] = at
                    border += 1
            at = patches[at].next_load
    return found[:size], vertices, kept[:border]


@compiled
def _lever(graph: Graph, at: int, vertex: int, margin: float, body: int, lever: FloatArray) -> float:
    """Write the lever from a body's centre to a vertex of patch ``at``, and return the length [m].

    The ``margin`` [sizes] shifts the vertex horizontally, outward from the patch's centre.
    """
    patch = graph.patches[at]
    outward = np.hypot(patch.vertex[vertex, 0] - patch.center[0], patch.vertex[vertex, 1] - patch.center[1])
    stretch = margin * size_of_pair(graph.bodies, patch.upper, patch.lower) / outward if outward > 0.0 else 0.0
    for k in range(3):
        moved = stretch * (patch.vertex[vertex, k] - patch.center[k]) if k < 2 else 0.0
        lever[k] = patch.vertex[vertex, k] + moved - graph.bodies[body].center[k]
    return float(np.sqrt(lever[0] ** 2 + lever[1] ** 2 + lever[2] ** 2))


@compiled
def _rolling(graph: Graph, patches: IntArray, index: IntArray, n: int, radius: float) -> FloatArray:
    """Return an array (n,): 1 for a body that touches only in points and lines, 0 for any other body.

    Args:
        graph: the stack.
        patches: rows of the patches that touch the bodies, shape (p,).
        index: index of each body in the problem, negative for a body outside the problem.
        n: number of bodies.
        radius: width [sizes] up to which a patch is a point or a line.
    """
    found = np.ones(n)
    for at in patches:
        patch = graph.patches[at]
        if patch.width > radius * size_of_pair(graph.bodies, patch.upper, patch.lower):
            for body in (patch.upper, patch.lower):
                if body != GROUND and index[body] >= 0:
                    found[index[body]] = 0.0
    return found


@compiled
def _add_kept_forces(
    graph: Graph, memory: Memory, kept: IntArray, index: IntArray, size: FloatArray, load: FloatArray
) -> None:
    """Subtract the kept forces of the patches ``kept`` (q,) from the ``load`` (n, 6) that other contacts must bear."""
    lever = np.empty(3)
    for at in kept:
        if not is_known(graph, memory, at):
            continue
        patch = graph.patches[at]
        for body, sign in ((patch.upper, -1.0), (patch.lower, 1.0)):
            if body == GROUND or index[body] < 0:
                continue
            i = index[body]
            for vertex in range(patch.vertices):
                _lever(graph, at, vertex, 0.0, body, lever)
                add_wrench(load[i], sign, memory.force[at, vertex], lever, size[i])


@compiled
def _divide(lever: FloatArray, body: IntArray, size: FloatArray) -> None:
    """Divide each ``lever`` (m, 3) by the ``size`` (n,) of its ``body`` (m,)."""
    for c in range(len(lever)):
        if body[c] >= 0:
            lever[c] /= size[body[c]]


@compiled
def part_of(graph: Graph, memory: Memory, ids: IntArray, terms: Terms) -> Part:
    """Return the statics problem of the bodies ``ids``: O(bodies + patches).

    Args:
        graph: the stack.
        memory: the kept forces.
        ids: the bodies, shape (n,).
        terms: conditions under which the bodies must stand.
    """
    gravity, margin, radius = terms.gravity, terms.margin, terms.radius
    n = len(ids)
    index = np.full(len(graph.bodies), -1)
    for i in range(n):
        index[ids[i]] = i
    patches, m, kept = _patches_of(graph, ids, index, terms.outside)
    body_a, body_b, level = np.full(m, -1), np.full(m, -1), np.empty(m, np.bool_)
    lever_a, lever_b, normal = np.zeros((m, 3)), np.zeros((m, 3)), np.empty((m, 3))
    friction, load, size = np.empty(m), np.zeros((n, 6)), np.zeros(n)
    c = 0
    for at in patches:
        patch = graph.patches[at]
        i, j = index[patch.upper], index[patch.lower] if patch.lower != GROUND else -1
        for vertex in range(patch.vertices):
            body_a[c], body_b[c], level[c] = j, i, patch.kind == SUPPORT
            friction[c] = patch.friction * terms.grip
            for k in range(3):
                normal[c, k] = patch.normal[k]
            if i >= 0:
                size[i] = max(size[i], _lever(graph, at, vertex, margin, patch.upper, lever_b[c]))
            if j >= 0:
                size[j] = max(size[j], _lever(graph, at, vertex, margin, patch.lower, lever_a[c]))
            c += 1
    for i in range(n):
        size[i] = size[i] if size[i] > 0.0 else 1.0
        load[i, 2] = graph.bodies[ids[i]].mass * gravity
    _divide(lever_a, body_a, size)
    _divide(lever_b, body_b, size)
    slack = radius * load[:, 2] * _rolling(graph, np.concatenate((patches, kept)), index, n, radius)
    _add_kept_forces(graph, memory, kept, index, size, load)
    return Part(Problem(body_a, body_b, lever_a, lever_b, normal, friction, load, slack), ids, level, patches, size)
