"""Judge a proven stack under loads that tremble: live bodies that lean on the stack and have not come to rest.

Only the engine knows the forces of these bodies, and the forces fluctuate from frame to frame. A poured pile consists
of such bodies. Three rules keep its judgement calm and cheap:

- the core judges a body again only after the force of its loads has changed by more than the ratio ``CHANGE``;
- the stack bears the loads if no body lacks more force than ``UNCERTAIN`` times the greatest load. Whether these forces
  arise by themselves does not count before the loads are at rest;
- a body unfreezes only if a second judgement, ``rest_s`` later, finds it overloaded as well.

After the loss of a support or a neighbour, the exact judgement of ``policies.equilibrium`` decides first, at once. The
rules hold for the bodies that it leaves frozen.
"""

from __future__ import annotations

import numpy as np

from stability_core.compiled import compiled
from stability_core.equilibrium.assembly import Part
from stability_core.equilibrium.live_loads import UNCERTAIN, carriers, is_upright, live_force
from stability_core.equilibrium.newton import nearest_forces
from stability_core.equilibrium.problem import Problem
from stability_core.equilibrium.region import Regions, fingerprint, is_proven
from stability_core.frame_buffers import HAS_FORCES, NOW, FrameBuffers
from stability_core.port import BoolArray, FloatArray, IntArray
from stability_core.pushes import CHANGE
from stability_core.settings import ROUNDING_S, Limits, Settings
from stability_core.stack import FROZEN, LIVE, Graph

SEARCHES = 3
"""Greatest number of searches for forces in a judgement, each of which goes on where the last one ended."""
_ALL = np.arange(6)


@compiled
def _are_judged(graph: Graph, regions: Regions, links: IntArray, ids: IntArray) -> bool:
    """Return True if the surroundings of all ``ids`` (k,) are the same as in their proofs, or as in ``links``."""
    judged = True
    for body in ids:
        if graph.bodies[body].state == FROZEN:
            judged &= is_proven(graph, regions, body) or links[body] == fingerprint(graph, body)
    return judged


@compiled
def _note(graph: Graph, links: IntArray, ids: IntArray) -> None:
    for body in ids:
        links[body] = fingerprint(graph, body)


@compiled
def _tremble(graph: Graph, buffers: FrameBuffers, ids: IntArray, limits: Limits) -> BoolArray:
    """Return the mask (k,) of the live bodies among ``ids`` that lean, and have not kept their places for ``doubt_s``.

    The mask is False if the engine reports no forces.
    """
    tremble = np.zeros(len(ids), np.bool_)
    if buffers.clock[HAS_FORCES] == 0.0:
        return tremble
    for i in range(len(ids)):
        row = graph.bodies[ids[i]]
        is_at_rest = row.steady_s >= limits[0].doubt_s - ROUNDING_S
        tremble[i] = row.state == LIVE and not is_at_rest and not is_upright(graph, ids[i : i + 1])
    return tremble


def _lacks(rest: FloatArray, most: float) -> BoolArray:
    """Return the mask (n,) of the bodies that lack more force than ``most`` [N] by the ``rest`` (n, 6)."""
    lacks: BoolArray = ~(np.abs(rest).max(axis=1) <= most)  # true for NaN
    return lacks


class TremblingLoads:
    """The latest judgement of each frozen body under loads that tremble."""

    def __init__(self, settings: Settings) -> None:
        """Start without judgements, and with the tolerances of ``settings``."""
        self._settings = settings
        self._load = np.zeros((0, 6))
        """Force of the live bodies on each body in its latest judgement [N], or NaN, by row."""
        self._multipliers = np.zeros((0, 6))
        """Result of the latest search for forces, by row (see ``newton.nearest_forces``)."""
        self._links = np.zeros(0, np.int64)
        """Fingerprint of each body's surroundings in the latest exact judgement, or 0, by row."""
        self._since: dict[int, float] = {}
        """Time [s] since which a body has been overloaded, by row."""
        self._before: dict[int, float] = {}
        """The same before the present frame."""

    def make_room(self, bodies: int) -> None:
        """Make room for a table of ``bodies`` rows."""
        more = bodies - len(self._load)
        if more > 0:
            self._load = np.concatenate([self._load, np.full((more, 6), np.nan)])
            self._links = np.concatenate([self._links, np.zeros(more, np.int64)])
            self._multipliers = np.concatenate([self._multipliers, np.zeros((more, 6))])

    def forget(self, bodies: list[int]) -> None:
        """Forget the judgements of newly frozen ``bodies``."""
        self._load[bodies] = np.nan
        self._links[bodies], self._multipliers[bodies] = 0, 0.0

    def forget_all(self) -> None:
        """Forget all judgements, because gravity has changed."""
        self._load[:] = np.nan
        self._links[:], self._multipliers[:] = 0, 0.0
        self._since = {}

    def note_judged(self, graph: Graph, bodies: IntArray) -> None:
        """Record that an exact judgement has just left the ``bodies`` (k,) frozen."""
        _note(graph, self._links, bodies)

    def are_judged(self, graph: Graph, regions: Regions, bodies: IntArray) -> bool:
        """Return True if the ``bodies`` (k,) have proofs, or unchanged surroundings since ``note_judged``."""
        return bool(_are_judged(graph, regions, self._links, bodies))

    @property
    def is_waiting(self) -> bool:
        """True if a body seems overloaded, so that a coming frame must judge the body again."""
        return len(self._since) > 0

    def to_judge(self, graph: Graph, buffers: FrameBuffers, unproven: IntArray, limits: Limits) -> IntArray:
        """Return the frozen bodies whose balance may have changed, shape (j,).

        These are the bodies that bear the bodies ``unproven`` (k,), without those whose trembling loads have hardly
        changed, and the bodies that seemed overloaded ``rest_s`` ago.
        """
        now, states = buffers.clock.item(NOW), graph.bodies["state"]
        tremble = _tremble(graph, buffers, unproven, limits)
        seeds = carriers(graph, unproven[~tremble])
        if tremble.any():
            trembling = np.setdiff1d(carriers(graph, unproven[tremble]), seeds)
            seeds = np.union1d(seeds, self._with_other_load(graph, buffers, trembling, limits))
        self._before = {body: time for body, time in self._since.items() if states[body] == FROZEN}
        ripe = [body for body, time in self._before.items() if now - time >= self._settings.rest_s - ROUNDING_S]
        seeds = np.union1d(seeds, np.array(ripe, np.int64))
        judged = set(seeds.tolist())
        self._since = {body: time for body, time in self._before.items() if body not in judged}
        return seeds

    def _with_other_load(self, graph: Graph, buffers: FrameBuffers, ids: IntArray, limits: Limits) -> IntArray:
        """Return those of the ``ids`` (k,) whose loads press with another force than in the latest judgement."""
        load = live_force(graph, buffers, ids, limits)
        change = np.abs(load - self._load[ids]).max(axis=1, initial=0.0)
        weight = graph.bodies["mass"][ids] * limits["gravity"][0]
        differs = ~(change <= CHANGE * (weight + np.abs(load).max(axis=1, initial=0.0)))  # true for NaN
        self._load[ids[differs]] = load[differs]
        changed: IntArray = ids[differs]
        return changed

    def overloaded(self, part: Part, problem: Problem, frozen: BoolArray, now: float) -> IntArray:
        """Return the frozen bodies of a part that the latest two judgements found overloaded, shape (k,).

        Args:
            part: n bodies of the stack.
            problem: the statics problem of the part under its live loads.
            frozen: mask of the frozen bodies of the part, shape (n,).
            now: time since the first frame [s].
        """
        most, y = UNCERTAIN * np.abs(problem.load).max(), self._multipliers[part.ids]
        for _ in range(SEARCHES):
            _, rest = nearest_forces(problem, _ALL, y, most)  # goes on from the latest result, which nearly fits
            lacking = part.ids[_lacks(rest, most) & frozen]
            if len(lacking) == 0:
                break
        self._multipliers[part.ids] = y
        return self._lasting(lacking, now)

    def _lasting(self, ids: IntArray, now: float) -> IntArray:
        """Return those of the overloaded ``ids`` (k,) that were overloaded ``rest_s`` ago as well, shape (j,)."""
        since = np.array([self._before.get(body, now) for body in ids.tolist()])
        lasts = now - since >= self._settings.rest_s - ROUNDING_S
        self._since.update(zip(ids[~lasts].tolist(), since[~lasts].tolist(), strict=True))
        lasting: IntArray = ids[lasts]
        return lasting
