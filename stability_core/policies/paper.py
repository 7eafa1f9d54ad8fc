"""The policy of Thomsen and Kraus 2015: a body is stable if its centre of mass lies above its contact area.

C_stack is the common centre of mass of a body and its loads.

- Flat test: a vertical ray from C_stack must hit the combined contact area.
- Leaning test: a test for bodies that do not lie flat (see ``leaning``).
- Overall test: the test that froze the body, repeated with all later loads. The flat test then has a tolerance,
  ``wake_margin``.
"""

from __future__ import annotations

import numpy as np

from stability_core.compiled import compiled
from stability_core.frame_buffers import AT_REST, LEANING, FrameBuffers, listed
from stability_core.leaning import leans_stably
from stability_core.policies.base import Decision, Policy
from stability_core.polygon import inside_distance, lies_on, width
from stability_core.port import IntArray
from stability_core.settings import Limits
from stability_core.settle import lay_due, lay_frozen, lowest_first
from stability_core.stack import FROZEN, LIVE, NONE, Graph, is_stack, take_changed
from stability_core.stack_mass import carry_down, support_polygon


@compiled
def balances(graph: Graph, body: int, margin: float) -> bool:
    """Return True if C_stack lies in the combined contact area, or at most ``margin`` [sizes] outside."""
    center, support = graph.bodies[body].stack_center, support_polygon(graph, body)
    if lies_on(support, center[0], center[1]):
        return True  # cheaper than the distance, and usually sufficient
    outside = margin * graph.bodies[body].size
    return outside > 0.0 and bool(inside_distance(support, center[0], center[1]) >= -outside)


@compiled
def lies_flat(graph: Graph, body: int, flat_width: float) -> bool:
    """Return True if the body stands on an area wider than an edge of ``flat_width`` [sizes]."""
    return bool(width(support_polygon(graph, body)) > flat_width * graph.bodies[body].size)


@compiled
def leans_on_stack(graph: Graph, body: int) -> bool:
    """Return True if every body below or beside ``body`` belongs to the stack."""
    bodies, patches = graph.bodies, graph.patches
    at = bodies[body].first_support
    while at != NONE:
        if not is_stack(bodies, patches[at].lower):
            return False
        at = patches[at].next_support
    return True


@compiled
def pass_flat_test(graph: Graph, candidates: IntArray) -> IntArray:
    """Freeze the ``candidates`` that pass the flat test, and return the frozen bodies, shape (k,).

    Pass the candidates lowest first, because the function must decide about the supports of a candidate before the
    candidate.
    """
    accepted = np.empty(len(candidates), np.int64)
    n = 0
    for body in candidates:
        if balances(graph, body, 0.0):
            graph.bodies[body].state, graph.bodies[body].leans = FROZEN, False
            accepted[n] = body
            n += 1
    return accepted[:n]


@compiled
def pass_leaning_test(graph: Graph, candidates: IntArray, gravity: float, flat_width: float) -> IntArray:
    """Freeze the live ``candidates`` that do not lie flat and pass the leaning test, and return these (k,) bodies.

    Bodies that lean on each other, such as the planks of an inverted V, pass together or not at all.
    """
    group = np.empty(len(candidates), np.int64)
    n = 0
    for body in candidates:
        is_live = graph.bodies[body].state == LIVE
        if is_live and not lies_flat(graph, body, flat_width) and leans_stably(graph, body, gravity):
            group[n] = body
            n += 1
    for body in group[:n]:
        graph.bodies[body].state, graph.bodies[body].leans = FROZEN, True
    shrinks = True
    while shrinks:
        shrinks = False
        for body in group[:n]:
            if graph.bodies[body].state == FROZEN and not leans_on_stack(graph, body):
                graph.bodies[body].state = LIVE
                shrinks = True
    kept = 0
    for body in group[:n]:
        if graph.bodies[body].state == FROZEN:
            group[kept] = body
            kept += 1
    return group[:kept]


@compiled
def fail_overall_test(graph: Graph, bodies: IntArray, gravity: float, wake_margin: float) -> IntArray:
    """Return the frozen bodies among ``bodies`` that fail the overall test, shape (k,).

    A flat body fails only if C_stack lies more than ``wake_margin`` [sizes] outside the area (hysteresis).
    """
    table = graph.bodies
    found = np.empty(len(bodies), np.int64)
    n = 0
    for body in bodies:
        row = table[body]
        if row.state != FROZEN:
            continue
        if row.leans:
            holds = leans_on_stack(graph, body) and leans_stably(graph, body, gravity)
        else:
            holds = balances(graph, body, wake_margin)
        if not holds:
            found[n] = body
            n += 1
    return found[:n]


@compiled
def _settle(graph: Graph, buffers: FrameBuffers, limits: Limits, gravity: float) -> tuple[IntArray, IntArray, IntArray]:
    """Settle one frame by all tests of the policy.

    Returns:
        Three lists of bodies:

        - bodies that passed the flat test;
        - bodies that passed the leaning test;
        - frozen bodies that failed the overall test.
    """
    limit = limits[0]
    # Contact areas
    lay_due(graph, buffers, limits)
    # Update of the stack data below changed bodies
    affected = carry_down(graph, take_changed(graph))
    # New members: flat test, then leaning test
    flat = pass_flat_test(graph, lowest_first(graph, listed(buffers, AT_REST)))
    leaning = pass_leaning_test(graph, lowest_first(graph, listed(buffers, LEANING)), gravity, limit.flat_width)
    lay_frozen(graph, buffers, limits)
    # Update of the stack data below new members
    affected = np.concatenate((affected, carry_down(graph, take_changed(graph))))
    # Overall test of all affected bodies
    return flat, leaning, fail_overall_test(graph, np.unique(affected), gravity, limit.wake_margin)


class Paper(Policy):
    """Policy that freezes bodies by the flat or the leaning test, and unfreezes bodies by the overall test."""

    name = "paper"

    def settle(self, graph: Graph, buffers: FrameBuffers) -> Decision:
        """Run the flat test and the leaning test, update the stack data, and run the overall test.

        Equations 1 to 5 of the paper give the stack data. The cost is O(k log k) for the k bodies with a changed load.
        """
        flat, leaning, unbalanced = _settle(graph, buffers, self.limits, self.gravity)
        return Decision(dict.fromkeys(flat.tolist(), "flat") | dict.fromkeys(leaning.tolist(), "leaning"), unbalanced)
