"""The policy of exact statics: a body may freeze if contact forces in the Coulomb cones hold the stack with it.

Cheap proofs first. What topples alone is refused, and what lies in the safe region of its supports is accepted, in
O(1) whatever the height. Only what is left costs a solve of the component: leaning bodies, counterweights, lost
supports. What falls then is what moves in the mechanism.

A proof holds for frozen bodies alone: no certificate is kept of what stands with a live load, nor after a change of
mass, normal or neighbour. So a live load that goes never matters where there is a proof, and one that comes is borne if
it lies in a safe region.

What statics leaves in doubt (see ``verdict``) is never proven. It is frozen only after the engine itself has held it in
place for ``doubt_s`` under the present contacts, and wakes at any change of contact, load or neighbour.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from stability_core.compiled import compiled
from stability_core.contact_filter import ContactRows
from stability_core.equilibrium.assembly import AS_BEFORE, FIXED, Part, part_of
from stability_core.equilibrium.component import bearing, component
from stability_core.equilibrium.live_loads import carriers, contact_load, is_upright, live_load, lying_on
from stability_core.equilibrium.loading import STIFFNESSES
from stability_core.equilibrium.memory import hand_on, memory_for, recall, remember
from stability_core.equilibrium.problem import Problem, relieved_of
from stability_core.equilibrium.region import (
    REGION,
    Regions,
    is_safe,
    is_unchanged,
    keep_proof,
    keep_proof_of_neighbours,
    note_doubts,
    region_of,
    regions_for,
    topples_alone,
    topples_off,
)
from stability_core.equilibrium.verdict import Answer, decide, takes_part
from stability_core.policies.base import NOBODY, Decision, Policy
from stability_core.polygon import width
from stability_core.port import GROUND, BoolArray, FloatArray, IntArray
from stability_core.settings import ROUNDING_S, Limits, Settings
from stability_core.settle import lay_due, lay_frozen, lowest_first, write_down
from stability_core.stack import (
    DOUBTED,
    FALLS,
    FROZEN,
    IN_DOUBT,
    LIVE,
    NONE,
    PROVEN,
    TOPPLES,
    Bodies,
    Graph,
    Patches,
    sorted_ids,
    take_changed,
)
from stability_core.stack_mass import support_polygon
from stability_core.watch import AT_REST, LEANING, PUSHED, TOLD, Watch, listed

SAFE, LEFT, UNSOLVED = range(3)
"""Rows of what ``_settle_safely`` finds: frozen; to be solved as candidates; to be solved again."""
WAKE_GRIP = 1.02
"""Hysteresis in friction: waking asks for a fall even with this many times the friction."""
UNCERTAIN = 0.2
"""Share of the greatest load that may lack where loads are estimates: contact forces tremble by as much."""
FEW_TOGETHER = 16
"""Up to how many bodies the live ones are solved together with the stack that they press on; if they stand on level
contacts up to ``FEW_BODIES``."""
FEW_BODIES = 64
"""Up to how many bodies all of a part of the stack is solved where what bears the change does not decide."""


@compiled
def _freeze_safely(graph: Graph, regions: Regions, candidates: IntArray) -> tuple[IntArray, IntArray]:
    """Freeze the ``candidates``, lowest first, that lie in safe regions; returns them, and those left undecided.

    What topples alone is decided as well: it stays live.
    """
    bodies = graph.bodies
    frozen, left = np.empty(len(candidates), np.int64), np.empty(len(candidates), np.int64)
    n, m = 0, 0
    for body in candidates:
        region = region_of(graph, regions, body)
        if is_safe(graph, regions, body, region):
            bodies[body].state = FROZEN
            bodies[body].leans = False
            keep_proof(graph, regions, body, region)
            keep_proof_of_neighbours(graph, regions, body)
            frozen[n] = body
            n += 1
        elif not topples_alone(graph, body, support_polygon(graph, body)):
            left[m] = body
            m += 1
        else:
            bodies[body].refusal = TOPPLES
    return frozen[:n], left[:m]


@compiled
def _on_edge(graph: Graph, candidates: IntArray, flat_width: float) -> IntArray:
    """The live ``candidates`` that stand on an edge of at most ``flat_width`` [sizes], shape (k,).

    They may be frozen while they still move a little; a flat body can wait.
    """
    bodies = graph.bodies
    found = np.empty(len(candidates), np.int64)
    n = 0
    for body in candidates:
        if bodies[body].state == LIVE and width(support_polygon(graph, body)) <= flat_width * bodies[body].size:
            found[n] = body
            n += 1
    return found[:n]


@compiled
def _with_resting(graph: Graph, candidates: IntArray) -> IntArray:
    """The ``candidates``, and the live bodies at rest on which they rest, directly or through others, by rising id.

    Bodies that hold each other can only be frozen together, whichever of them came to rest first.
    """
    bodies, patches = graph.bodies, graph.patches
    reached = np.zeros(len(bodies), np.bool_)
    found = np.empty(len(bodies), np.int64)
    size = len(candidates)
    found[:size] = candidates
    reached[candidates] = True
    done = 0
    while done < size:
        at = bodies[found[done]].first_support
        done += 1
        while at != NONE:
            other = patches[at].lower
            at = patches[at].next_support
            if other != GROUND and not reached[other] and bodies[other].state == LIVE and bodies[other].is_resting:
                reached[other] = True
                found[size] = other
                size += 1
    return sorted_ids(found[:size])


@compiled
def _keep_proofs(graph: Graph, regions: Regions, bodies: IntArray) -> None:
    for body in bodies:
        keep_proof(graph, regions, body, region_of(graph, regions, body))


@compiled
def _is_borne(graph: Graph, regions: Regions, body: int) -> bool:
    """True if the stack is known to bear a live body that lies on it, or that topples off it."""
    region = region_of(graph, regions, body)
    return is_safe(graph, regions, body, region) or topples_off(graph, regions, body, region)


@compiled
def _unproven(graph: Graph, regions: Regions, bodies: IntArray) -> IntArray:
    """Those of ``bodies`` whose part of the stack must be solved again, shape (k,)."""
    table = graph.bodies
    found = np.empty(len(bodies), np.int64)
    n = 0
    for body in bodies:
        row = table[body]
        is_load = row.state == LIVE and row.first_support != NONE
        if (row.state == FROZEN and not is_unchanged(graph, regions, body)) or (
            is_load and not _is_borne(graph, regions, body)
        ):
            found[n] = body
            n += 1
    return found[:n]


@compiled
def _finish(graph: Graph, regions: Regions, watch: Watch, limits: Limits, unsolved: IntArray) -> int:
    """What comes after the candidates are decided: O(1) a changed body.

    Returns:
        How many bodies are written into ``unsolved``: their part of the stack must be solved again.
    """
    lay_frozen(graph, watch, limits)
    note_doubts(graph, regions)
    return write_down(unsolved, _unproven(graph, regions, take_changed(graph)))


@compiled
def _settle_safely(
    bodies: Bodies,
    patches: Patches,
    spare: IntArray,
    changed: IntArray,
    regions: Regions,
    contacts: ContactRows,
    sizes: IntArray,
    latest: IntArray,
    clock: FloatArray,
    due: IntArray,
    limits: Limits,
    found: IntArray,
) -> tuple[int, int, int]:
    """The frame as far as cheap proofs go: all of it, unless a candidate is left undecided.

    O(1) a body that is due, whatever the number of frozen bodies. The arrays of ``Graph`` and ``Watch`` come one by
    one: Numba takes longer to look at two tuples than a plank takes to freeze.

    Returns:
        How many bodies are written into the rows of ``found``, shape (3, bodies). SAFE: frozen. LEFT: candidates to be
        solved together. UNSOLVED: bodies whose part of the stack must be solved again, known if none is left.
    """
    graph = Graph(bodies, patches, spare, changed)
    watch = Watch(contacts, sizes, latest, clock, due)
    lay_due(graph, watch, limits)
    frozen, left = _freeze_safely(graph, regions, lowest_first(graph, listed(watch, AT_REST)))
    on_edge = _on_edge(graph, listed(watch, LEANING), limits[0].flat_width)
    safe = write_down(found[SAFE], frozen)
    if len(left) + len(on_edge) > 0:
        return safe, write_down(found[LEFT], _with_resting(graph, np.unique(np.concatenate((left, on_edge))))), 0
    return safe, 0, _finish(graph, regions, watch, limits, found[UNSOLVED])


def _chosen(ids: IntArray, among: BoolArray) -> IntArray:
    """Return the ``ids`` (n,) that are ``among`` those wanted (n,), shape (k,)."""
    chosen: IntArray = ids[among]
    return chosen


def _together(first: IntArray, second: IntArray) -> IntArray:
    """Return all of two lists of bodies, each once, by rising id, shape (k,)."""
    both: IntArray = np.union1d(first, second)
    return both


class Equilibrium(Policy):
    """Freezes what provably stands, and wakes what takes part in a collapse."""

    name = "equilibrium"

    def __init__(self, gravity: float, settings: Settings) -> None:
        """Args: gravity: gravitational acceleration [m/s2], positive; settings: the tolerances."""
        super().__init__(gravity, settings)
        self._regions = np.zeros(0, REGION)
        self._memory = memory_for(0)
        self._found = np.empty((3, 0), np.int64)
        self._wake_grip = WAKE_GRIP
        self._sag = np.zeros((len(STIFFNESSES), 0, 6))
        """Displacements to which loading last came, by body: where it looks first for the next."""
        self._lift = np.zeros((0, 6))
        """Where the search for the loads of live bodies begins, by body."""

    def set_gravity(self, gravity: float) -> None:
        """Forget proofs, regions and forces.

        The next frame judges without hysteresis in friction: contacts of frozen bodies do not change while gravity
        turns, so that bodies wake at their exact angle of friction.
        """
        super().set_gravity(gravity)
        self._wake_grip = 1.0
        self._regions["vertices"] = self._regions["links"] = 0
        self._memory.pair[:] = NONE
        self._sag[:] = 0.0

    def settle(self, graph: Graph, watch: Watch) -> Decision:
        """What lies in safe regions, in one compiled call; then the rest together, less what would fall.

        O(1) a changed body while safe regions decide, else some solves of its component that begin at its latest
        forces.
        """
        if len(graph.bodies) > len(self._regions):
            self._regions = regions_for(len(graph.bodies), self._regions)
            self._found = np.empty((3, len(graph.bodies)), np.int64)
            more = len(graph.bodies) - self._sag.shape[1]
            self._sag = np.concatenate([self._sag, np.zeros((len(STIFFNESSES), more, 6))], axis=1)
            self._lift = np.concatenate([self._lift, np.zeros((more, 6))])
        if len(graph.patches) > len(self._memory.pair):
            self._memory = memory_for(len(graph.patches), self._memory)
        safe, left, unsolved = _settle_safely(
            *graph,
            self._regions,
            watch.contacts,
            watch.sizes,
            watch.latest,
            watch.clock,
            watch.due,
            self.limits,
            self._found,
        )
        reasons = dict.fromkeys(self._found[SAFE, :safe].tolist(), "safe region")
        if left:
            together, patches = self._freeze_together(graph, self._found[LEFT, :left].copy())
            reasons.update(together)
            unsolved = _finish(graph, self._regions, watch, self.limits, self._found[UNSOLVED])
            hand_on(graph, self._memory, patches, np.array(list(together), np.int64))
        changed = self._found[UNSOLVED, :unsolved]
        if watch.due.item(PUSHED, 0):
            changed = _together(changed, listed(watch, PUSHED))
        unbalanced = self._unbalanced(graph, watch, changed) if len(changed) else NOBODY
        self._wake_grip = WAKE_GRIP
        return Decision(reasons, unbalanced)

    def _freeze_together(self, graph: Graph, group: IntArray) -> tuple[dict[int, str], IntArray]:
        """Freeze of the candidates ``group`` what stands, each part of the stack by itself.

        Returns what was frozen, with the reasons, and the rows of the patches that were solved.
        """
        reasons: dict[int, str] = {}
        solved = [group[:0]]
        while len(group):
            ids = component(graph, group[:1], group)
            part = group[np.isin(group, ids)]
            group = group[~np.isin(group, ids)]
            frozen, reason, patches = self._freeze_part(graph, part)
            reasons.update(dict.fromkeys(frozen.tolist(), reason))
            solved.append(patches)
        return reasons, np.concatenate(solved)

    def _parts(self, graph: Graph, seeds: IntArray, members: IntArray) -> Iterator[tuple[IntArray, bool]]:
        """The bodies to be solved for the ``seeds``: what bears them, the rest as it was; then all, if they are few.

        Yields them with whether they are all.
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
        return part_of(graph, self._memory, ids, outside, self.gravity, margin, grip, self.settings.point_radius)

    def _decide(self, graph: Graph, part: Part, problem: Problem, changed: BoolArray) -> Answer:
        """``decide`` for the ``problem`` of a part, from the kept forces and displacements."""
        start = recall(graph, self._memory, part.patches, len(part.level))
        sag = np.ascontiguousarray(self._sag[:, part.ids])  # as the kernels are compiled for it
        answer = decide(problem, part.level, start, changed, sag)
        self._sag[:, part.ids] = sag
        return answer

    def _freeze_part(self, graph: Graph, group: IntArray) -> tuple[IntArray, str, IntArray]:
        """Freeze all of ``group``, less what would fall, until the rest stands.

        What statics leaves in doubt is frozen too, without a proof, once the engine has held all of it for long enough.
        Returns what was frozen, the reason, and the rows of the patches that were solved. One to four steps of a solve
        of what bears the group if that stands; a few of the group alone if that falls.
        """
        bodies = graph.bodies
        while len(group):
            for ids, is_whole in self._parts(graph, group, group):
                part, joins = self._part(graph, ids, AS_BEFORE, 0.0, 1.0), np.isin(ids, group)
                verdict, forces, rest, _ = self._decide(graph, part, part.problem, joins)
                falls = takes_part(rest)
                if verdict == "stable" or is_whole or (verdict == "unstable" and not (falls & ~joins).any()):
                    break
            if verdict == "stable" and forces is not None:
                remember(graph, self._memory, part.patches, forces)
                bodies["state"][group] = FROZEN
                bodies["leans"][group] = False
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
            bodies["refusal"][refused] = DOUBTED if verdict == "doubt" else FALLS
            bodies["refused_among"][refused] = bodies["frozen_neighbours"][refused]
            if not goes.any():
                break
            group = group[~goes]
        return group[:0], "", group[:0]

    def _unbalanced(self, graph: Graph, watch: Watch, unproven: IntArray) -> IntArray:
        """The frozen bodies that move in the mechanism of a part of the stack that fell out of balance.

        What stands with a live load is not proven to stand without it. A body that was frozen in doubt goes at any
        change around it.
        """
        in_doubt = graph.bodies["doubt"][unproven] != PROVEN
        doubtful: IntArray = unproven[in_doubt]
        seeds = carriers(graph, unproven[~in_doubt])
        if len(seeds) == 0:
            return doubtful
        for ids, is_whole in self._parts(graph, seeds, seeds[:0]):
            goes = self._falls(graph, watch, ids, seeds, AS_BEFORE)
            if len(goes) == 0:
                return doubtful
            if is_whole:
                return _together(doubtful, goes)
        certain = self._falls(graph, watch, ids, seeds, FIXED)
        return _together(doubtful, certain if len(certain) else seeds)

    def _falls(self, graph: Graph, watch: Watch, ids: IntArray, seeds: IntArray, outside: int) -> IntArray:
        """Which of the frozen bodies ``ids`` fall or are in doubt under their live loads, shape (k,).

        What live bodies press if the stack is rigid is one of many ways to share their weight. Where the stack does not
        bear it, those that do not fall themselves are solved together with it. If that does not prove that all of it
        bears the load, what the load presses on is woken, and the rest is asked again without it.
        """
        live = lying_on(graph, ids)
        for margin, grip in ((0.0, 1.0), (self.settings.wake_margin, self._wake_grip))[len(live) > 0 :]:
            part = self._part(graph, ids, outside, margin, grip)
            pressed, held = self._pressed(graph, watch, part, live)
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
        upright = is_upright(graph, live)
        if outside == AS_BEFORE and (upright or held.any()):
            most = FEW_BODIES if upright else FEW_TOGETHER
            goes = self._falls_together(graph, watch, ids, seeds, live if upright else live[held], most, goes)
        if verdict == "unstable" and (upright or len(goes) == 0):
            return goes
        lacking = np.abs(answer[2]).max() if verdict == "unstable" else np.inf
        return seeds if lacking > UNCERTAIN * np.abs(problem.load).max() else ids[:0]

    def _pressed(self, graph: Graph, watch: Watch, part: Part, live: IntArray) -> tuple[FloatArray, BoolArray]:
        """What ``live`` bodies (k,) press on a part, (n, 6), and which of them are known to be held, (k,).

        What stands on level contacts presses with its weight. Of what wedges itself in only the engine knows the force;
        where it does not tell, see ``live_load``.
        """
        told = watch.clock.item(TOLD) > 0.0
        if told and not is_upright(graph, live):
            return contact_load(graph, watch, part, self.limits, True), np.zeros(len(live), np.bool_)
        pressed, held = live_load(graph, self._memory, part, live, self.gravity, self._lift)
        if told:
            pressed += contact_load(graph, watch, part, self.limits, False)
        return pressed, held

    def _falls_together(
        self,
        graph: Graph,
        watch: Watch,
        ids: IntArray,
        seeds: IntArray,
        joint: IntArray,
        most: int,
        goes: IntArray,
    ) -> IntArray:
        """Which frozen bodies fall if the live bodies ``joint`` (k,) share their weight as the stack needs it.

        All other live bodies press as estimated. ``goes``: the answer if there are more than ``most`` bodies.
        """
        borne = bearing(graph, self._memory, _together(seeds, carriers(graph, joint)), joint, self.gravity)
        together = _together(_together(ids, borne), joint)
        if len(together) > most:
            return goes
        part = self._part(graph, together, AS_BEFORE, self.settings.wake_margin, self._wake_grip)
        others = np.setdiff1d(lying_on(graph, together), together)
        pressed, _ = self._pressed(graph, watch, part, others)
        problem = part.problem._replace(load=part.problem.load - pressed)
        answer = self._decide(graph, part, problem, np.isin(together, seeds))
        return self._moves(graph, part, problem, seeds, answer)

    def _moves(self, graph: Graph, part: Part, problem: Problem, seeds: IntArray, answer: Answer) -> IntArray:
        """The frozen bodies that move in the mechanism of an ``answer``, shape (k,); if nothing is known, the seeds.

        Live bodies may fall from what stands, or be in doubt, as may be those that the engine held before they were
        frozen: they are taken away, and the rest must bear what they press on it.
        """
        bodies, ids, level = graph.bodies, part.ids, part.level
        may_move: BoolArray = (bodies["state"][ids] == FROZEN) & (bodies["doubt"][ids] == PROVEN)
        verdict, forces, rest, _ = answer
        while verdict != "stable":
            falls = takes_part(rest)
            goes = falls & may_move
            if forces is None:  # no equilibrium was found, nor a proof that there is none
                goes |= np.isin(ids, seeds) & may_move
            if goes.any() or forces is None:
                return _chosen(ids, goes)
            problem, kept = relieved_of(problem, falls, forces)
            ids, may_move, level = ids[~falls], may_move[~falls], level[kept]
            verdict, forces, rest, _ = decide(problem, level, forces[kept], np.isin(ids, seeds))
        return ids[:0]

    def _prove(self, graph: Graph, ids: IntArray) -> None:
        """Note that the frozen bodies ``ids`` stand together, lowest first, as regions rest on those below."""
        _keep_proofs(graph, self._regions, ids[np.argsort(graph.bodies["center"][ids, 2], kind="stable")])
