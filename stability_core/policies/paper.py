"""The policy of Thomsen and Kraus 2015: a body is stable if its centre of mass lies above its contact area.

The flat test is a vertical ray from C_stack into the combined contact area; an object that does not lie
flat may pass the leaning test instead. The overall check repeats whichever test the object passed, with
all that has come to rest on it since.
"""

from __future__ import annotations

import numpy as np

from stability_core.compiled import compiled
from stability_core.leaning import leans_stably
from stability_core.policies.base import Policy
from stability_core.polygon import inside_distance, width
from stability_core.port import IntArray
from stability_core.stack import FROZEN, LIVE, NONE, Graph, is_stack
from stability_core.stack_mass import carry_down, support_polygon


@compiled
def balance(graph: Graph, body: int) -> float:
    """How far C_stack lies inside the combined contact area [m]; negative if it lies outside."""
    center = graph.bodies[body].stack_center
    return inside_distance(support_polygon(graph, body), center[0], center[1])


@compiled
def lies_flat(graph: Graph, body: int, flat_width: float) -> bool:
    """True if the body stands on an area and not on an edge of at most ``flat_width`` [m]."""
    return bool(width(support_polygon(graph, body)) > flat_width)


@compiled
def leans_on_stack(graph: Graph, body: int) -> bool:
    """True if all that a body stands on or leans against belongs to the stack."""
    at = graph.bodies[body].first_support
    while at != NONE:
        if not is_stack(graph, graph.patches[at].lower):
            return False
        at = graph.patches[at].next_support
    return True


@compiled
def fallen_out(graph: Graph, bodies: IntArray, gravity: float, wake_margin: float) -> IntArray:
    """The frozen among ``bodies`` that fail the overall check, shape (k,)."""
    found = np.empty(len(bodies), np.int64)
    n = 0
    for body in bodies:
        if graph.bodies[body].state != FROZEN:
            continue
        if graph.bodies[body].leans:
            holds = leans_on_stack(graph, body) and leans_stably(graph, body, gravity)
        else:
            holds = balance(graph, body) >= -wake_margin
        if not holds:
            found[n] = body
            n += 1
    return found[:n]


class Paper(Policy):
    """Freezes what passes the flat or the leaning test, and wakes what fails it under its load."""

    name = "paper"

    def carry(self, graph: Graph, changed: IntArray) -> IntArray:
        """Eqs 1-5, downward from what changed."""
        return carry_down(graph, changed)

    def accept(self, graph: Graph, at_rest: IntArray, leaning: IntArray) -> dict[int, str]:
        """Flat stacking first, lowest first, so that each candidate sees those it stands on; then leaning.

        Bodies that lean on each other, as the planks of an inverted V, pass together or not at all.
        """
        bodies = graph.bodies
        reasons: dict[int, str] = {}
        for body in at_rest:
            if balance(graph, body) >= 0.0:
                bodies["state"][body], bodies["leans"][body] = FROZEN, False
                reasons[int(body)] = "flat"
        group = [body for body in leaning if self._may_lean(graph, body)]
        for body in group:
            bodies["state"][body], bodies["leans"][body] = FROZEN, True
        while alone := [body for body in group if not leans_on_stack(graph, body)]:
            for body in alone:
                bodies["state"][body] = LIVE
                group.remove(body)
        return reasons | {int(body): "leaning" for body in group}

    def _may_lean(self, graph: Graph, body: int) -> bool:
        return (
            graph.bodies["state"][body] == LIVE
            and not lies_flat(graph, body, self.settings.flat_width)
            and leans_stably(graph, body, self.gravity)
        )

    def unbalanced(self, graph: Graph, bodies: IntArray) -> IntArray:
        """The overall check, with hysteresis: waking asks for a centre well outside the area."""
        return fallen_out(graph, bodies, self.gravity, self.settings.wake_margin)
