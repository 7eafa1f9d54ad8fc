"""Loads of live bodies on the stack.

Live bodies enter the statics problem of the stack as loads. The module solves all live bodies on a part of the stack
together: bodies that stand, and bodies that fall. The stack below counts as rigid, like the ground. The loads are the
contact forces that hold the live bodies. If no forces hold a body, the nearest forces are its load. For example, a
toppling brick presses, with at most its weight, at the point about which the brick turns.
"""

from __future__ import annotations

import numpy as np

from stability_core.compiled import compiled
from stability_core.equilibrium.assembly import FIXED, Part, Terms, part_of
from stability_core.equilibrium.memory import Memory
from stability_core.equilibrium.newton import nearest_forces
from stability_core.equilibrium.problem import add_wrench
from stability_core.frame_buffers import HAS_FORCES, FrameBuffers, frame_before, frames_of
from stability_core.port import GROUND, BoolArray, FloatArray, IntArray
from stability_core.pushes import is_push
from stability_core.settings import ROUNDING_S, Limits
from stability_core.stack import FROZEN, LEAN, LIVE, NONE, Graph, sorted_ids

_VERTICAL, _ALL = np.array([2, 3, 4]), np.arange(6)
_HELD = 1e-2
"""Ratio of a live body's imbalance to its weight, up to which forces hold the body. The estimate of the forces leaves a
ratio of about a thousandth."""
UNCERTAIN = 0.2
"""Ratio of the greatest missing force to the greatest load, up to which no body unfreezes under estimated loads.
Contact forces fluctuate by this ratio."""
_UNCERTAIN_AT_REST = 0.01
"""Value in place of ``UNCERTAIN`` if all live bodies have kept their places for ``doubt_s``. The reported forces must
balance each body up to this value."""
_PUSHES, _LIVE, _EVERYTHING = range(3)
"""Contact forces that count:

- _PUSHES: pushes (see ``pushes``);
- _LIVE: pushes, and the forces of live bodies;
- _EVERYTHING: all forces.
"""


@compiled
def lying_on(graph: Graph, ids: IntArray) -> IntArray:
    """Return the live loads that patches join to the bodies ``ids``, directly or indirectly, shape (k,)."""
    bodies, patches = graph.bodies, graph.patches
    reached = np.zeros(len(bodies), np.bool_)
    found = np.empty(len(bodies), np.int64)
    size = 0
    for begin in range(2):
        done = 0
        while done < (len(ids) if begin == 0 else size):
            body = ids[done] if begin == 0 else found[done]
            done += 1
            for upwards in range(2):
                at = bodies[body].first_load if upwards else bodies[body].first_support
                while at != NONE:
                    patch = patches[at]
                    other = patch.upper if upwards else patch.lower
                    at = patch.next_load if upwards else patch.next_support
                    if other == GROUND or reached[other] or bodies[other].state != LIVE or not bodies[other].is_load:
                        continue
                    reached[other] = True
                    found[size] = other
                    size += 1
    return found[:size]


@compiled
def carriers(graph: Graph, ids: IntArray) -> IntArray:
    """Return the frozen bodies among ``ids``, and the frozen bodies that bear live bodies among ``ids``, shape (k,).

    A frozen body may bear a live body directly, or through other bodies that are not frozen.
    """
    bodies, patches = graph.bodies, graph.patches
    reached = np.zeros(len(bodies), np.bool_)
    found, waiting = np.empty(len(bodies), np.int64), np.empty(len(bodies), np.int64)
    size, left = 0, 0
    for body in ids:
        if not reached[body]:
            reached[body] = True
            waiting[left] = body
            left += 1
    while left > 0:
        left -= 1
        body = waiting[left]
        if bodies[body].state == FROZEN:
            found[size] = body
            size += 1
            continue
        at = bodies[body].first_support
        while at != NONE:
            lower = patches[at].lower
            at = patches[at].next_support
            if lower != GROUND and not reached[lower]:
                reached[lower] = True
                waiting[left] = lower
                left += 1
    return sorted_ids(found[:size])


@compiled
def is_upright(graph: Graph, live: IntArray) -> bool:
    """Return True if all contacts below the ``live`` bodies (k,) are load-bearing, so that the bodies press down."""
    for body in live:
        at = graph.bodies[body].first_support
        while at != NONE:
            if graph.patches[at].kind == LEAN:
                return False
            at = graph.patches[at].next_support
    return True


@compiled
def live_load(
    graph: Graph, memory: Memory, part: Part, live: IntArray, gravity: float, y: FloatArray
) -> tuple[FloatArray, BoolArray]:
    """Return the loads of the ``live`` bodies (k,) on the bodies of ``part``: O(k) and some factorisations.

    Args:
        graph: the stack.
        memory: the kept forces.
        part: the part of the stack on which the live bodies lie.
        live: the live bodies, shape (k,).
        gravity: gravitational acceleration [m/s2], positive.
        y: start of the search, a row for each body of the stack. The function overwrites the rows of the live bodies
            (see ``nearest_forces``).

    Returns:
        Two arrays:

        - force [N] and moment [N, over the body's size] on each body of ``part``, shape (n, 6);
        - mask of the live bodies that a rigid stack would hold, shape (k,).
    """
    pressed = np.zeros((len(part.ids), 6))
    held = np.ones(len(live), np.bool_)
    if len(live) == 0:
        return pressed, held
    above = part_of(graph, memory, live, Terms(FIXED, gravity, 0.0, 1.0, 0.0))
    problem, upright = above.problem, above.level.all()
    if upright:  # on load-bearing contacts, a toppling body and the bodies on it press straight down
        problem.normal[:, :2] = 0.0
        problem.normal[:, 2] = np.where(problem.normal[:, 2] >= 0.0, 1.0, -1.0)
        problem.friction[:] = 0.0
    begin = y[live]
    force, rest = nearest_forces(problem, _VERTICAL if upright else _ALL, begin, 0.0)
    y[live] = begin
    for i in range(len(live)):
        held[i] = np.abs(rest[i]).max() <= _HELD * problem.load[i, 2]
    index = np.full(len(graph.bodies), -1)
    for i in range(len(part.ids)):
        index[part.ids[i]] = i
    lever = np.empty(3)
    c = 0
    for at in above.patches:
        patch = graph.patches[at]
        i = index[patch.lower] if patch.lower != GROUND else -1
        for vertex in range(patch.vertices):
            if i >= 0:
                for k in range(3):
                    lever[k] = patch.vertex[vertex, k] - graph.bodies[patch.lower].center[k]
                add_wrench(pressed[i], -1.0, force[c], lever, part.size[i])
            c += 1
    return pressed, held


@compiled
def contact_load(graph: Graph, buffers: FrameBuffers, part: Part, limits: Limits, everything: bool) -> FloatArray:
    """Return the mean force [N] and moment [N, over the body's size] of pressing bodies on ``part``, shape (n, 6).

    The cost is O(contacts of the latest dwell frames).

    Args:
        graph: the stack.
        buffers: the dwell frames, with contact forces if the engine reports them.
        part: the part of the stack on which the live bodies press.
        limits: the settings, shape (1,).
        everything: True to count pushes (see ``pushes``) and the forces of all live bodies outside the part, False to
            count pushes only.
    """
    pressed = np.zeros((len(part.ids), 6))
    _add_contacts(graph, buffers, part.ids, part.size, limits, _LIVE if everything else _PUSHES, pressed)
    return pressed


@compiled
def live_force(graph: Graph, buffers: FrameBuffers, ids: IntArray, limits: Limits) -> FloatArray:
    """Return the mean force [N] and moment [N, over the body's size] of live bodies on the ``ids`` (n,), shape (n, 6).

    The cost is O(contacts of the latest dwell frames).
    """
    size, force = np.empty(len(ids)), np.zeros((len(ids), 6))
    for i in range(len(ids)):
        size[i] = graph.bodies[ids[i]].size
    _add_contacts(graph, buffers, ids, size, limits, _LIVE, force)
    return force


@compiled
def load_error(graph: Graph, buffers: FrameBuffers, live: IntArray, limits: Limits) -> float:
    """Return the relative error of the loads of the ``live`` bodies (k,), or infinity.

    The cost is O(contacts of the latest dwell frames). The result is the first of these values that applies:

    - infinity, if there are no live bodies, or if a body has kept its place for less than ``doubt_s``;
    - ``UNCERTAIN``, if the engine reports no forces;
    - infinity, if the forces on a body miss balance by more than ``UNCERTAIN``, because a joint of the engine may hold
      the body;
    - ``UNCERTAIN``, if the forces miss balance by more than ``_UNCERTAIN_AT_REST``, because a port may estimate
      friction;
    - ``_UNCERTAIN_AT_REST``.

    Args:
        graph: the stack.
        buffers: the dwell frames, with contact forces if the engine reports them.
        live: the live bodies, shape (k,).
        limits: the settings, shape (1,).
    """
    bodies = graph.bodies
    if len(live) == 0:
        return np.inf
    for body in live:
        if bodies[body].steady_s < limits[0].doubt_s - ROUNDING_S:
            return np.inf
    if buffers.clock[HAS_FORCES] == 0.0:
        return UNCERTAIN
    rest, size = np.zeros((len(live), 6)), np.empty(len(live))
    for i in range(len(live)):
        size[i] = bodies[live[i]].size
    largest = _add_contacts(graph, buffers, live, size, limits, _EVERYTHING, rest)
    error = _UNCERTAIN_AT_REST
    for i in range(len(live)):
        weight = bodies[live[i]].mass * limits[0].gravity
        rest[i, 2] -= weight
        imbalance = np.abs(rest[i]).max() / max(weight, largest[i])
        if imbalance > UNCERTAIN:
            return np.inf
        if imbalance > _UNCERTAIN_AT_REST:
            error = UNCERTAIN
    return error


@compiled
def _add_contacts(
    graph: Graph,
    buffers: FrameBuffers,
    ids: IntArray,
    size: FloatArray,
    limits: Limits,
    counted: int,
    wrench: FloatArray,
) -> FloatArray:
    """Add the mean contact forces on the bodies ``ids`` (n,) to their ``wrench`` (n, 6).

    Args:
        graph: the stack.
        buffers: the dwell frames, with contact forces.
        ids: the bodies, shape (n,).
        size: length [m] over which the moment of each body counts, shape (n,).
        limits: the settings, shape (1,).
        counted: the forces that count: ``_PUSHES``, ``_LIVE`` without forces between the ``ids``, or ``_EVERYTHING``.
        wrench: output, force [N] and moment [N, over ``size``] on each body, shape (n, 6).

    Returns:
        The largest component of a counted force on each body [N], shape (n,).
    """
    bodies = graph.bodies
    index = np.full(len(bodies), -1)
    for i in range(len(ids)):
        index[ids[i]] = i
    largest, lever = np.zeros(len(ids)), np.empty(3)
    frames, room = frames_of(buffers, limits[0].load_s), len(buffers.contacts) // len(buffers.sizes)
    for back in range(frames):
        frame = frame_before(buffers, back)
        for at in range(frame * room, frame * room + buffers.sizes[frame]):
            contact = buffers.contacts[at]
            for target, pusher, sign in ((contact.body_b, contact.body_a, 1.0), (contact.body_a, contact.body_b, -1.0)):
                if target == GROUND or index[target] < 0:
                    continue
                counts = counted == _EVERYTHING
                if not counts and pusher != GROUND:
                    counts = counted == _LIVE and bodies[pusher].state == LIVE and index[pusher] < 0
                    counts = counts or is_push(bodies, pusher, contact.level, limits[0])
                if not counts:
                    continue
                i = index[target]
                for k in range(3):
                    lever[k] = contact.point[k] - bodies[target].center[k]
                    largest[i] = max(largest[i], abs(contact.force[k]))
                add_wrench(wrench[i], sign / frames, contact.force, lever, size[i])
    return largest
