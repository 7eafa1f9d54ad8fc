"""The policy of exact statics: a body may freeze if contact forces in the Coulomb cones hold the stack with it.

Cheap proofs first. What topples alone is refused, and what lies in the safe region of its supports is accepted, in
O(1) whatever the height. Only what is left costs a solve of the component: leaning bodies, counterweights, lost
supports. What falls then is what moves in the mechanism.

Always kept: the frozen bodies stand by themselves, without any live one. So a live load that goes never matters, and
one that comes is borne if it lies in a safe region.
"""

from __future__ import annotations

import numpy as np

from stability_core.compiled import compiled
from stability_core.equilibrium.component import component, problem_of
from stability_core.equilibrium.region import (
    Regions,
    is_proven,
    is_safe,
    keep_proof,
    keep_proof_of_neighbours,
    regions_for,
    topples_alone,
)
from stability_core.equilibrium.verdict import decide
from stability_core.policies.base import Policy
from stability_core.polygon import width
from stability_core.port import IntArray
from stability_core.settings import Settings
from stability_core.stack import FROZEN, LIVE, NONE, Graph
from stability_core.stack_mass import support_polygon

MOVES = 1e-2
"""Share of the largest unbalanced force below which a body does not take part in a mechanism."""
WAKE_GRIP = 1.02
"""Hysteresis in friction: waking asks for a fall even with this many times the friction."""


@compiled
def _freeze_safely(graph: Graph, regions: Regions, candidates: IntArray) -> IntArray:
    """Freeze the ``candidates`` (lowest first) that lie in safe regions or topple alone; returns those left, (k,)."""
    left = np.empty(len(candidates), np.int64)
    n = 0
    for body in candidates:
        if is_safe(graph, regions, body):
            graph.bodies[body].state = FROZEN
            graph.bodies[body].leans = False
            keep_proof(graph, regions, body)
            keep_proof_of_neighbours(graph, regions, body)
        elif not topples_alone(graph, body, support_polygon(graph, body)):
            left[n] = body
            n += 1
    return left[:n]


@compiled
def _keep_proofs(graph: Graph, regions: Regions, bodies: IntArray) -> None:
    for body in bodies:
        keep_proof(graph, regions, body)


@compiled
def _unproven(graph: Graph, regions: Regions, bodies: IntArray) -> IntArray:
    """Those of ``bodies`` whose part of the stack must be solved again, shape (k,)."""
    found = np.empty(len(bodies), np.int64)
    n = 0
    for body in bodies:
        row = graph.bodies[body]
        is_load = row.state == LIVE and row.first_support != NONE
        if (row.state == FROZEN and not is_proven(graph, regions, body)) or (
            is_load and not is_safe(graph, regions, body)
        ):
            found[n] = body
            n += 1
    return found[:n]


class Equilibrium(Policy):
    """Freezes what provably stands, and wakes what takes part in a collapse."""

    name = "equilibrium"

    def __init__(self, gravity: float, settings: Settings) -> None:
        """Args: gravity: gravitational acceleration [m/s2], positive; settings: the tolerances."""
        super().__init__(gravity, settings)
        self._regions = regions_for(0)

    def carry(self, graph: Graph, changed: IntArray) -> IntArray:
        """Nothing is carried down: safe regions hold whatever lies in them."""
        if len(graph.bodies) > len(self._regions.links):
            self._regions = regions_for(len(graph.bodies), self._regions)
        return changed

    def accept(self, graph: Graph, at_rest: IntArray, leaning: IntArray) -> dict[int, str]:
        """What lies in safe regions, lowest first; then the rest together, less what would fall, until it stands."""
        left = _freeze_safely(graph, self._regions, at_rest)
        reasons = {int(body): "safe region" for body in at_rest if graph.bodies["state"][body] == FROZEN}
        loose = [body for body in leaning if self._is_on_edge(graph, body)]
        group = np.array(sorted({*left.tolist(), *loose}), np.int64)
        while len(group):
            ids = component(graph, group, group, False)
            falling = self._falling(graph, ids, 0.0, 1.0)
            if not len(falling):
                graph.bodies["state"][group] = FROZEN
                graph.bodies["leans"][group] = False
                self._prove(graph, ids)
                return reasons | {int(body): "equilibrium" for body in group}
            if not np.isin(group, falling).any():
                break
            group = group[~np.isin(group, falling)]
        return reasons

    def unbalanced(self, graph: Graph, bodies: IntArray) -> IntArray:
        """The frozen bodies that move in the mechanism of a part of the stack that fell out of balance.

        O(1) a changed body while safe regions decide, else one solve of its component.
        """
        seeds = _unproven(graph, self._regions, bodies)
        if not len(seeds):
            return seeds
        ids = component(graph, seeds, seeds[:0], True)
        falling = self._falling(graph, ids, self.settings.wake_margin, WAKE_GRIP)
        woken: IntArray = falling[graph.bodies["state"][falling] == FROZEN]
        if not len(woken):
            self._prove(graph, ids[graph.bodies["state"][ids] == FROZEN])
        return woken

    def _is_on_edge(self, graph: Graph, body: int) -> bool:
        """A body that stands on an edge may be frozen while it still moves a little; a flat one can wait."""
        is_live: bool = graph.bodies["state"][body] == LIVE
        return is_live and width(support_polygon(graph, body)) <= self.settings.flat_width

    def _falling(self, graph: Graph, ids: IntArray, margin: float, grip: float) -> IntArray:
        """Which of ``ids`` do not provably stand, shape (k,)."""
        problem, level = problem_of(graph, ids, self.gravity, margin, grip)
        verdict, _, rest, _ = decide(problem, level)
        if verdict == "stable":
            return ids[:0]
        unbalanced = np.abs(rest).max(axis=1)
        falling: IntArray = ids[unbalanced > MOVES * unbalanced.max()]
        return falling

    def _prove(self, graph: Graph, ids: IntArray) -> None:
        """Note that the frozen bodies ``ids`` stand together, lowest first, as regions rest on those below."""
        _keep_proofs(graph, self._regions, ids[np.argsort(graph.bodies["center"][ids, 2], kind="stable")])
