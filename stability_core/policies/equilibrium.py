"""The policy of exact statics: a body may freeze if contact forces in the Coulomb cones hold the body and the stack.

Cheap proofs come first. The policy refuses a body that topples alone, and accepts a body in the safe region of its
supports, in O(1) at any height. The policy solves the remaining bodies, together with the bodies below. The
remaining bodies are leaning bodies, counterweights, and bodies that lost a support. A failed solve gives a mechanism:
the motion in which the bodies fall. Bodies that move in the mechanism stay live or unfreeze.

A proof covers frozen bodies, not live loads. A change of mass, normal or neighbour invalidates the proof of a body.
Therefore the departure of a live load invalidates no proof. The stack bears a new live load without a solve if the
load lies in a safe region.

A body in doubt (see ``verdict``) has no proof. The body freezes only after the engine has held the body in place for
``doubt_s`` under the present contacts. The body unfreezes at any change of contact, load or neighbour.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from stability_core.equilibrium.assembly import AS_BEFORE, FIXED, Part, Terms, part_of
from stability_core.equilibrium.component import bearing, component
from stability_core.equilibrium.live_loads import (
    UNCERTAIN,
    carriers,
    contact_load,
    is_upright,
    live_load,
    load_error,
    lying_on,
)
from stability_core.equilibrium.loading import STIFFNESSES
from stability_core.equilibrium.memory import hand_on, memory_for, recall, remember
from stability_core.equilibrium.problem import Problem, relieved_of
from stability_core.equilibrium.region import (
    REGION,
    regions_for,
)
from stability_core.equilibrium.safe_settle import LEFT, SAFE, UNSOLVED, finish, keep_proofs, settle_safely
from stability_core.equilibrium.trembling import TremblingLoads
from stability_core.equilibrium.verdict import BRIEF, QUICK, THOROUGH, Answer, Effort, decide, takes_part
from stability_core.equilibrium.waking import resting_on
from stability_core.frame_buffers import HAS_FORCES, NOW, PUSHED, FrameBuffers, listed
from stability_core.policies.base import NOBODY, Decision, Policy
from stability_core.port import BoolArray, FloatArray, IntArray
from stability_core.settings import ROUNDING_S, Settings
from stability_core.stack import (
    DOUBTED,
    FALLS,
    FROZEN,
    IN_DOUBT,
    NONE,
    NOT_REFUSED,
    PROVEN,
    Graph,
)

WAKE_GRIP = 1.02
"""Factor on friction in the test for unfreezing. This hysteresis keeps bodies at the limit of friction frozen."""
TOGETHER = 12
"""Greatest number of candidates in a joint solve within a budget. In a pile few bodies hold each other, and a solve of
fifty bodies that lean on each other takes 0.5 s."""
FEW_REFUSALS = 2
"""Number of refusals, each after a change around a body, from which the body waits before the next question."""
FEW_TOGETHER = 16
"""Greatest number of bodies in a joint solve of live bodies with the stack below them, to bound the cost of a frame.
The limit is ``FEW_BODIES`` if all contacts of the live bodies are load-bearing, because their solve is cheap, or if
``load_error`` is finite."""
FEW_BODIES = 64
"""Greatest number of bodies for which the policy solves a whole part of the stack, if a solve of the affected bodies
decides nothing. The limit bounds the cost of a frame."""


def _chosen(ids: IntArray, among: BoolArray) -> IntArray:
    """Return the ``ids`` (n,) of the mask ``among`` (n,), shape (k,)."""
    chosen: IntArray = ids[among]
    return chosen


def _together(first: IntArray, second: IntArray) -> IntArray:
    """Return the union of two lists of bodies, by rising row, shape (k,)."""
    both: IntArray = np.union1d(first, second)
    return both


class Equilibrium(Policy):
    """Policy that freezes bodies with a proof of equilibrium, and unfreezes bodies that take part in a collapse."""

    name = "equilibrium"
    waits_while_shaken = True

    def __init__(self, gravity: float, settings: Settings) -> None:
        """Set gravity and tolerances.

        Args:
            gravity: gravitational acceleration [m/s2], positive.
            settings: the tolerances.
        """
        super().__init__(gravity, settings)
        self._regions = np.zeros(0, REGION)
        self._memory = memory_for(0)
        self._found = np.empty((3, 0), np.int64)
        self._wake_margin, self._wake_grip = settings.wake_margin, WAKE_GRIP
        self._sag = np.zeros((len(STIFFNESSES), 0, 6))
        """Displacements of the last loading, by body, from which the next loading starts."""
        self._solved = 0
        """Number of bodies in the solves of this frame."""
        self._trembling = TremblingLoads(settings)
        self._lift = np.zeros((0, 6))
        """Start of the search for the loads of live bodies, by body."""

    def set_gravity(self, gravity: float) -> None:
        """Set gravity, and forget proofs, regions and forces.

        The next frame judges without hysteresis, so that bodies unfreeze at the angle at which they slide or
        topple. The contacts of frozen bodies do not change while gravity turns. Therefore hysteresis is not necessary.
        """
        super().set_gravity(gravity)
        self._wake_margin, self._wake_grip = 0.0, 1.0
        self._regions["vertices"] = self._regions["links"] = 0
        self._memory.pair[:] = NONE
        self._trembling.forget_all()
        self._sag[:] = 0.0

    @property
    def is_waiting(self) -> bool:
        """True if a coming frame must judge a body again that seems overloaded."""
        return self._trembling.is_waiting

    def resting_on(self, graph: Graph, roots: IntArray) -> IntArray:
        """Return the bodies ``roots`` and the frozen bodies that rest on them by the kept forces, shape (k,)."""
        above: IntArray = resting_on(graph, self._memory, self._regions, roots, self.gravity)
        return above

    def settle(self, graph: Graph, buffers: FrameBuffers) -> Decision:
        """Freeze bodies in safe regions and other candidates that stand together, and find the frozen bodies that fall.

        While safe regions decide, the cost is O(1) per changed body. Otherwise the cost is some solves of the affected
        bodies. The solves start from the latest forces.
        """
        if len(graph.bodies) > len(self._regions):
            self._regions = regions_for(len(graph.bodies), self._regions)
            self._found = np.empty((3, len(graph.bodies)), np.int64)
            more = len(graph.bodies) - self._sag.shape[1]
            self._sag = np.concatenate([self._sag, np.zeros((len(STIFFNESSES), more, 6))], axis=1)
            self._lift = np.concatenate([self._lift, np.zeros((more, 6))])
        if len(graph.patches) > len(self._memory.pair):
            self._memory = memory_for(len(graph.patches), self._memory)
        self._trembling.make_room(len(graph.bodies))
        safe, left, unsolved = settle_safely(
            *graph,
            self._regions,
            buffers.contacts,
            buffers.sizes,
            buffers.latest,
            buffers.clock,
            buffers.worklist,
            self.limits,
            self._found,
        )
        reasons, deferred = dict.fromkeys(self._found[SAFE, :safe].tolist(), "safe region"), NOBODY
        if left:
            group, now = self._found[LEFT, :left].copy(), buffers.clock.item(NOW)
            if math.isfinite(self.budget):
                group = _chosen(group, self._is_due(graph, group, now))
            together, patches, deferred = self._freeze_together(graph, group, now)
            reasons.update(together)
            unsolved = finish(graph, self._regions, buffers, self.limits, self._found[UNSOLVED])
            hand_on(graph, self._memory, patches, np.array(list(together), np.int64))
        self._trembling.forget(list(reasons))
        unbalanced, pushed = NOBODY, buffers.worklist.item(PUSHED, 0)
        if unsolved or pushed or self.is_waiting:
            changed = self._found[UNSOLVED, :unsolved]
            if pushed:
                changed = _together(changed, listed(buffers, PUSHED))
            unbalanced = self._unbalanced(graph, buffers, changed)
        self._wake_margin, self._wake_grip = self.settings.wake_margin, WAKE_GRIP
        return Decision(reasons, unbalanced, deferred)

    def _is_due(self, graph: Graph, group: IntArray, now: float) -> BoolArray:
        """Return the mask (k,) of the candidates that have waited enough, or have a new frozen neighbour."""
        rows = graph.bodies[group]
        has_gained = (rows["frozen_neighbours"] & ~rows["refused_among"]) != 0
        due: BoolArray = (rows["not_before_s"] <= now) | (has_gained & (rows["refusal"] != DOUBTED))
        return due

    def _freeze_together(self, graph: Graph, group: IntArray, now: float) -> tuple[dict[int, str], IntArray, IntArray]:
        """Freeze the stable candidates of ``group``, part by part of the stack, within the budget.

        Returns:
            Three values:

            - the frozen bodies, with their reasons;
            - rows of the solved patches;
            - the deferred bodies.
        """
        reasons: dict[int, str] = {}
        solved = [group[:0]]
        self._solved = 0
        while len(group) and self._solved < self.budget:
            ids = component(graph, group[:1], group)
            part = group[np.isin(group, ids)]
            batch = self._batch(graph, part)
            group = np.setdiff1d(group, batch)
            frozen, reason, patches = self._freeze_part(graph, batch, now)
            reasons.update(dict.fromkeys(frozen.tolist(), reason))
            solved.append(patches)
        graph.bodies["deferred"][group] = True
        return reasons, np.concatenate(solved), group

    def _batch(self, graph: Graph, part: IntArray) -> IntArray:
        """Return the candidates of a ``part`` for a joint solve, shape (k,).

        With a budget, the batch contains the lowest ``TOGETHER`` candidates. Candidates with only load-bearing contacts
        have no limit, because their solve is cheap.
        """
        if len(part) <= TOGETHER or math.isinf(self.budget) or is_upright(graph, part):
            return part
        lowest = part[np.argsort(graph.bodies["center"][part, 2], kind="stable")]
        return np.sort(lowest[:TOGETHER])

    def _parts(self, graph: Graph, seeds: IntArray, members: IntArray) -> Iterator[tuple[IntArray, bool]]:
        """Yield the bodies to solve for the ``seeds``, and True if these bodies are the whole part of the stack.

        The method first yields the bodies that bear the seeds, then the whole part, if the part has at most
        ``FEW_BODIES`` bodies.
        """
        near = bearing(graph, self._memory, seeds, members, self.gravity)
        whole = component(graph, seeds, members)
        if len(near) == len(whole):
            yield near, True
            return
        yield near, False
        if len(whole) <= FEW_BODIES:
            yield whole, True

    def _part(self, graph: Graph, ids: IntArray, outside: int, margin: float, grip: float) -> Part:
        terms = Terms(outside, self.gravity, margin, grip, self.settings.point_radius)
        return part_of(graph, self._memory, ids, terms)

    def _decide(
        self, graph: Graph, part: Part, problem: Problem, changed: BoolArray, effort: Effort = THOROUGH
    ) -> Answer:
        """Return the answer of ``decide`` for the ``problem`` of a part, from the kept forces and displacements."""
        self._solved += len(part.ids)
        start = recall(graph, self._memory, part.patches, len(part.level))
        sag = np.ascontiguousarray(self._sag[:, part.ids])  # the kernels need this layout
        answer = decide(problem, part.level, start, changed, sag, effort)
        self._sag[:, part.ids] = sag
        return answer

    def _effort(self, graph: Graph, group: IntArray) -> Effort:
        """Return the limit on the cost of a question about the candidates ``group`` (k,): lower for a restless pile."""
        if math.isinf(self.budget):
            return THOROUGH
        rows = graph.bodies[group]
        is_restless = (np.maximum(rows["wakes"], rows["restless"] - 1) > 1) | (rows["refusals"] > FEW_REFUSALS)
        return QUICK if is_restless.any() else BRIEF

    def _freeze_part(self, graph: Graph, group: IntArray, now: float) -> tuple[IntArray, str, IntArray]:
        """Freeze the bodies of ``group`` that stand: remove falling bodies until the remaining bodies stand.

        Bodies in doubt freeze too, without a proof, once the engine has held the whole group in place for ``doubt_s``.
        A standing group usually costs one to four steps of a solve of the bodies that bear the group. A falling group
        usually costs a few steps of a solve of its own bodies.

        Returns:
            Three values:

            - the frozen bodies;
            - the reason for the freeze;
            - rows of the solved patches.
        """
        bodies, effort = graph.bodies, self._effort(graph, group)
        while len(group):
            for ids, is_whole in self._parts(graph, group, group):
                part, joins = self._part(graph, ids, AS_BEFORE, 0.0, 1.0), np.isin(ids, group)
                verdict, forces, rest, _ = self._decide(graph, part, part.problem, joins, effort)
                falls = takes_part(rest)
                if verdict == "stable" or is_whole or (verdict == "unstable" and not (falls & ~joins).any()):
                    break
            if verdict == "stable" and forces is not None:
                remember(graph, self._memory, part.patches, forces)
                bodies["state"][group] = FROZEN
                bodies["leans"][group] = False
                bodies["refusals"][group] = 0
                self._prove(graph, ids)
                return group, "equilibrium", part.patches
            if verdict == "doubt" and (bodies["steady_s"][group] >= self.settings.doubt_s - ROUNDING_S).all():
                bodies["state"][group] = FROZEN
                bodies["leans"][group] = False
                bodies["doubt"][group] = IN_DOUBT
                return group, "held by the engine", part.patches[:0]
            goes = np.isin(group, ids[falls])
            if verdict == "doubt":
                goes |= bodies["steady_s"][group] < self.settings.doubt_s - ROUNDING_S
            refused = group[goes] if goes.any() else group
            is_expensive = verdict == "doubt" and len(ids) > QUICK.bodies
            least_wait = is_expensive * self.settings.doubt_s  # even if the surroundings change earlier
            self._refuse(graph, refused, DOUBTED if verdict == "doubt" else FALLS, now, least_wait)
            if not goes.any():
                break
            group = group[~goes]
        return group[:0], "", group[:0]

    def _refuse(self, graph: Graph, refused: IntArray, reason: int, now: float, least_wait: float) -> None:
        """Record a refusal of the bodies ``refused`` (k,), which the policy judges again after ``least_wait`` [s].

        A body that the policy refuses repeatedly, although its surroundings change, waits longer each time, because it
        usually lies in a pile that still moves.
        """
        bodies = graph.bodies
        has_changed = (bodies["refusal"][refused] == NOT_REFUSED) | (
            bodies["refused_among"][refused] != bodies["frozen_neighbours"][refused]
        )
        bodies["refusals"][refused] += has_changed
        times = bodies["refusals"][refused] - FEW_REFUSALS
        waits = np.where(times < 0, 0.0, np.minimum(self.settings.calm_s * 2.0**times, self.settings.longest_calm_s))
        bodies["not_before_s"][refused] = now + np.maximum(waits, least_wait)
        bodies["refusal"][refused] = reason
        bodies["refused_among"][refused] = bodies["frozen_neighbours"][refused]

    def _unbalanced(self, graph: Graph, buffers: FrameBuffers, unproven: IntArray) -> IntArray:
        """Return the frozen bodies that must unfreeze, because of the bodies without a valid proof, ``unproven`` (k,).

        - A stack that stands with a live load gets no proof, because the stack may fall without the load.
        - A body in doubt unfreezes at any change around the body.
        - The method judges each part of the stack separately, so that an uncertain live load does not hide the fall of
          another part.
        """
        in_doubt = graph.bodies["doubt"][unproven] != PROVEN
        falls: IntArray = unproven[in_doubt]
        seeds = self._trembling.to_judge(graph, buffers, unproven[~in_doubt], self.limits)
        while len(seeds):
            among = np.isin(seeds, component(graph, seeds[:1], seeds[:0]))
            falls = _together(falls, self._unbalanced_in_part(graph, buffers, seeds[among]))
            seeds = seeds[~among]
        return falls

    def _unbalanced_in_part(self, graph: Graph, buffers: FrameBuffers, seeds: IntArray) -> IntArray:
        """Return the unbalanced frozen bodies of the part of the stack that contains all ``seeds``, shape (k,).

        Loads that tremble have rules of their own (see ``trembling``).
        """
        near = bearing(graph, self._memory, seeds, seeds[:0], self.gravity)
        live = lying_on(graph, near)
        if self._judged_by_change(graph, buffers, near, live):
            return self._overloaded(graph, buffers, near, live)
        falls = self._certainly_unbalanced(graph, buffers, seeds)
        if len(falls) == 0:
            self._trembling.note_judged(graph, near)
        return falls

    def _certainly_unbalanced(self, graph: Graph, buffers: FrameBuffers, seeds: IntArray) -> IntArray:
        """Return the unbalanced frozen bodies as ``_unbalanced_in_part``, for loads that do not tremble.

        If the part is too large for a joint solve, and no proof shows which bodies fall, all ``seeds`` count as
        unbalanced.
        """
        for ids, is_whole in self._parts(graph, seeds, seeds[:0]):
            goes = self._falls(graph, buffers, ids, seeds, AS_BEFORE)
            if is_whole or len(goes) == 0:
                return goes
        certain = self._falls(graph, buffers, ids, seeds, FIXED)
        return certain if len(certain) else seeds

    def _falls(self, graph: Graph, buffers: FrameBuffers, ids: IntArray, seeds: IntArray, outside: int) -> IntArray:
        """Return the frozen bodies among ``ids`` that fall or are in doubt under their live loads, shape (k,).

        Leaning live bodies that contacts alone hold at rest are in equilibrium together with the stack. A joint solve
        decides then, without loads. In all other cases the method computes the loads of live bodies on a rigid stack.
        These loads are one of many distributions of the weight of the live bodies. If the stack does not bear these
        loads, a joint solve includes the stack and the live bodies that do not fall. If the verdict then depends on
        uncertain loads, the method returns all ``seeds`` or no bodies, by the size of the imbalance.
        """
        live = lying_on(graph, ids)
        error = load_error(graph, buffers, live, self.limits) if outside == AS_BEFORE else np.inf
        upright = is_upright(graph, live)
        if error < np.inf and not upright:
            falls = self._falls_together(graph, buffers, ids, seeds, live, FEW_BODIES)
            if falls is not None:
                return falls
        for margin, grip in ((0.0, 1.0), (self._wake_margin, self._wake_grip))[len(live) > 0 :]:
            part = self._part(graph, ids, outside, margin, grip)
            pressed, held = self._pressed(graph, buffers, part, live)
            problem = part.problem._replace(load=part.problem.load - pressed)
            answer = self._decide(graph, part, problem, np.isin(ids, seeds))
            verdict, forces = answer[:2]
            if verdict == "stable":
                if margin == 0.0 and outside == AS_BEFORE and forces is not None and not pressed.any():
                    remember(graph, self._memory, part.patches, forces)
                    self._prove(graph, ids)
                return ids[:0]
        goes = self._moves(graph, part, problem, seeds, answer)
        if len(goes) == 0 or len(live) == 0:
            return goes
        if verdict == "unstable" and not pressed[takes_part(answer[2])].any():
            return goes  # the fall is certain, because no live load takes part in it
        if outside == AS_BEFORE and (upright or held.any()):
            most = FEW_BODIES if upright else FEW_TOGETHER
            falls = self._falls_together(graph, buffers, ids, seeds, live if upright else live[held], most)
            goes = goes if falls is None else falls
        if verdict == "unstable" and (upright or len(goes) == 0):
            return goes
        lacking = np.abs(answer[2]).max() if verdict == "unstable" else np.inf
        return seeds if lacking > min(error, UNCERTAIN) * np.abs(problem.load).max() else ids[:0]

    def _judged_by_change(self, graph: Graph, buffers: FrameBuffers, ids: IntArray, live: IntArray) -> bool:
        """Return True if the ``live`` bodies on the ``ids`` tremble, and the ``ids`` have a proof without them."""
        if len(live) == 0 or is_upright(graph, live):
            return False
        is_certain = math.isfinite(load_error(graph, buffers, live, self.limits))
        return not is_certain and (
            self._trembling.are_judged(graph, self._regions, ids) or self._stand_alone(graph, ids)
        )

    def _stand_alone(self, graph: Graph, ids: IntArray) -> bool:
        """Return True if the frozen bodies ``ids`` stand without live bodies, and record this proof."""
        frozen = _chosen(ids, graph.bodies["state"][ids] == FROZEN)
        part = self._part(graph, frozen, AS_BEFORE, 0.0, 1.0)
        verdict, forces, _, _ = self._decide(graph, part, part.problem, np.ones(len(frozen), np.bool_), QUICK)
        if verdict != "stable" or forces is None:
            return False
        remember(graph, self._memory, part.patches, forces)
        self._prove(graph, frozen)
        return True

    def _overloaded(self, graph: Graph, buffers: FrameBuffers, ids: IntArray, live: IntArray) -> IntArray:
        """Return the frozen bodies among the ``ids`` that the trembling ``live`` bodies overload, shape (k,)."""
        part = self._part(graph, ids, AS_BEFORE, self._wake_margin, self._wake_grip)
        pressed, _ = self._pressed(graph, buffers, part, live)
        problem = part.problem._replace(load=part.problem.load - pressed)
        frozen = graph.bodies["state"][ids] == FROZEN
        return self._trembling.overloaded(part, problem, frozen, buffers.clock.item(NOW))

    def _pressed(self, graph: Graph, buffers: FrameBuffers, part: Part, live: IntArray) -> tuple[FloatArray, BoolArray]:
        """Return the loads (n, 6) of ``live`` bodies (k,) on a part, and the mask (k,) of live bodies that forces hold.

        A body on load-bearing contacts presses with its weight. Only the engine knows the force of a wedged body. For
        an engine that reports no forces, see ``live_load``.
        """
        has_forces = buffers.clock.item(HAS_FORCES) > 0.0
        if has_forces and not is_upright(graph, live):
            return contact_load(graph, buffers, part, self.limits, True), np.zeros(len(live), np.bool_)
        pressed, held = live_load(graph, self._memory, part, live, self.gravity, self._lift)
        if has_forces:
            pressed += contact_load(graph, buffers, part, self.limits, False)
        return pressed, held

    def _falls_together(
        self,
        graph: Graph,
        buffers: FrameBuffers,
        ids: IntArray,
        seeds: IntArray,
        joint: IntArray,
        most: int,
    ) -> IntArray | None:
        """Return the frozen bodies that fall in a joint solve with the live bodies ``joint`` (k,).

        In this solve, the bodies ``joint`` distribute their weight in favour of the stack. All other live bodies press
        with their estimated loads. The result is None if the solve would have more than ``most`` bodies.
        """
        borne = bearing(graph, self._memory, _together(seeds, carriers(graph, joint)), joint, self.gravity)
        together = _together(_together(ids, borne), joint)
        if len(together) > most:
            return None
        others = np.setdiff1d(lying_on(graph, together), together)
        if self._judged_by_change(graph, buffers, together, others):
            return self._overloaded(graph, buffers, together, others)
        part = self._part(graph, together, AS_BEFORE, self._wake_margin, self._wake_grip)
        pressed, _ = self._pressed(graph, buffers, part, others)
        problem = part.problem._replace(load=part.problem.load - pressed)
        answer = self._decide(graph, part, problem, np.isin(together, seeds))
        return self._moves(graph, part, problem, seeds, answer)

    def _moves(self, graph: Graph, part: Part, problem: Problem, seeds: IntArray, answer: Answer) -> IntArray:
        """Return the frozen bodies that move in the mechanism of an ``answer``, shape (k,).

        If the answer has no forces, the result also contains the proven ``seeds``.

        Live bodies, and bodies frozen in doubt, may fall or be in doubt although the stack stands. The method removes
        these bodies, and the remaining bodies must bear the loads of these bodies.
        """
        bodies, ids, level = graph.bodies, part.ids, part.level
        may_move: BoolArray = (bodies["state"][ids] == FROZEN) & (bodies["doubt"][ids] == PROVEN)
        verdict, forces, rest, _ = answer
        while verdict != "stable":
            falls = takes_part(rest)
            goes = falls & may_move
            if forces is None:  # the search found neither an equilibrium nor a mechanism
                goes |= np.isin(ids, seeds) & may_move
            if goes.any() or forces is None:
                return _chosen(ids, goes)
            problem, kept = relieved_of(problem, falls, forces)
            ids, may_move, level = ids[~falls], may_move[~falls], level[kept]
            verdict, forces, rest, _ = decide(problem, level, forces[kept], np.isin(ids, seeds))
        return ids[:0]

    def _prove(self, graph: Graph, ids: IntArray) -> None:
        """Record that the frozen bodies ``ids`` stand together.

        The method records the lowest body first, because a region builds on lower regions.
        """
        keep_proofs(graph, self._regions, ids[np.argsort(graph.bodies["center"][ids, 2], kind="stable")])
