"""The naive policy, a reference for all other policies: freeze every body at rest."""

from __future__ import annotations

import numpy as np

from stability_core.compiled import compiled
from stability_core.frame_buffers import AT_REST, FrameBuffers, listed
from stability_core.policies.base import Decision, Policy
from stability_core.port import IntArray
from stability_core.settings import Limits
from stability_core.settle import lay_due, lay_frozen
from stability_core.stack import FROZEN, NONE, Graph, take_changed

CEILING = -0.5
"""Upward component of a patch's normal below which the patch is a ceiling: the other body lies above."""


@compiled
def _is_held(graph: Graph, body: int) -> bool:
    """Return True if ``body`` has a patch on another body or the ground, except for ceilings."""
    at = graph.bodies[body].first_support
    while at != NONE:
        if graph.patches[at].normal[2] > CEILING:
            return True
        at = graph.patches[at].next_support
    return False


@compiled
def _settle(graph: Graph, buffers: FrameBuffers, limits: Limits) -> IntArray:
    """Freeze all bodies at rest, and return the frozen bodies that lost all their supports and leaning contacts."""
    lay_due(graph, buffers, limits)
    for body in listed(buffers, AT_REST):
        graph.bodies[body].state = FROZEN
    lay_frozen(graph, buffers, limits)
    changed = take_changed(graph)
    floating = np.zeros(len(changed), np.bool_)
    for i in range(len(changed)):
        floating[i] = graph.bodies[changed[i]].state == FROZEN and not _is_held(graph, changed[i])
    return changed[floating]


class AtRest(Policy):
    """Policy that freezes every body at rest, and unfreezes a body that has lost all supports and leaning contacts.

    The policy ignores the weaker rule of rest for leaning bodies, because the policy has no leaning test.
    """

    name = "at_rest"
    judges_statics = False

    def settle(self, graph: Graph, buffers: FrameBuffers) -> Decision:
        """Freeze every body at rest, and find frozen bodies without supports and leaning contacts: O(changes)."""
        floating = _settle(graph, buffers, self.limits)
        return Decision(dict.fromkeys(listed(buffers, AT_REST).tolist(), "at rest"), floating)
