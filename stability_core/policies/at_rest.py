"""The naive policy, the baseline to beat: freeze whatever is at rest."""

from __future__ import annotations

from stability_core.policies.base import Policy
from stability_core.port import IntArray
from stability_core.stack import FROZEN, NONE, Graph


class AtRest(Policy):
    """Freezes every body at rest, stable or not, and keeps it so while anything is left below it."""

    name = "at_rest"

    def carry(self, graph: Graph, changed: IntArray) -> IntArray:
        """Nothing is carried: no body's load matters to another."""
        del graph
        return changed

    def accept(self, graph: Graph, at_rest: IntArray, leaning: IntArray) -> dict[int, str]:
        """Accept every body at rest; the weaker rule for leaning is for those who test what they freeze."""
        del leaning
        graph.bodies["state"][at_rest] = FROZEN
        return {int(body): "at rest" for body in at_rest}

    def unbalanced(self, graph: Graph, bodies: IntArray) -> IntArray:
        """Frozen bodies that have lost everything they stood on."""
        rows = graph.bodies[bodies]
        floating: IntArray = bodies[(rows["state"] == FROZEN) & (rows["first_support"] == NONE)]
        return floating
