"""The naive policy, the baseline to beat: freeze whatever is at rest."""

from __future__ import annotations

from stability_core.compiled import compiled
from stability_core.policies.base import Decision, Policy
from stability_core.port import IntArray
from stability_core.settings import Limits
from stability_core.settle import lay_due, lay_frozen
from stability_core.stack import FROZEN, NONE, Graph, take_changed
from stability_core.watch import AT_REST, Watch, listed


@compiled
def _settle(graph: Graph, watch: Watch, limits: Limits) -> IntArray:
    """Freeze all that is at rest; returns the changed bodies."""
    lay_due(graph, watch, limits)
    for body in listed(watch, AT_REST):
        graph.bodies[body].state = FROZEN
    lay_frozen(graph, watch, limits)
    return take_changed(graph)


class AtRest(Policy):
    """Freezes every body at rest, stable or not, and keeps it so while anything is left below it.

    The weaker rule for leaning is for those who test what they freeze.
    """

    name = "at_rest"

    def settle(self, graph: Graph, watch: Watch) -> Decision:
        """Accept every body at rest; only what has lost everything it stood on is unbalanced. O(changes)."""
        changed = _settle(graph, watch, self.limits)
        rows = graph.bodies[changed]
        floating = changed[(rows["state"] == FROZEN) & (rows["first_support"] == NONE)]
        return Decision(dict.fromkeys(listed(watch, AT_REST).tolist(), "at rest"), floating)
