"""The extension: freezes what is statically stable, and wakes what no longer balances, once a frame."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from stability_core.checks import BAD_SHAPE, FINE, NO_ROOM, check_ids, check_shapes, checked_removals, fault_of
from stability_core.compiled import WrongTypeError
from stability_core.compiling import compile_policy
from stability_core.explanation import explain
from stability_core.frame import observe
from stability_core.lookup import look_up
from stability_core.manifold import supports_as_bits
from stability_core.policies import POLICIES, Policy
from stability_core.port import BoolArray, Contacts, IntArray, Masses, StabilityPort
from stability_core.settings import Settings
from stability_core.stack import (
    ABSENT,
    FROZEN,
    LIVE,
    PROVEN,
    Bodies,
    Graph,
    drop_loads,
    drop_supports,
    empty_graph,
    grown,
    note_change,
    with_all_above,
)
from stability_core.watch import AT_REST, LEANING, LYING, STRUCK, skip_frame, watch_for


class Change(NamedTuple):
    """What one update did."""

    frozen: tuple[int, ...]
    """Bodies frozen in this frame, by rising id."""
    woken: tuple[int, ...]
    """Bodies woken in this frame, by rising id."""
    reasons: Mapping[int, str]
    """Why, for each of them."""


IDS, NUMBERS = np.dtype(np.int64), np.dtype(np.float64)
UNCHANGED = Change((), (), {})
MOMENT_S = 1e-9
"""Time [s] that passes where none does: what has moved at all since the last update is fast."""


def warm_up(policy: str = "equilibrium") -> float:
    """Compile all that ``policy`` runs, or read it from Numba's cache; returns the seconds it took.

    ``StabilityExtension`` does so when it is made, once in a process for each policy, so that nothing is compiled while
    a simulation runs. Call it where the wait hurts least, such as when a container is built: compiling takes a minute
    or two, once for each version. What takes long, and a cache that cannot be written, are told to the logger
    ``stability_core``.

    Raises:
        UnknownNameError: if there is no such policy.
    """
    look_up("policy", policy, POLICIES)
    return compile_policy(policy, partial(StabilityExtension, policy=policy))


def _laid_out(array: Any, dtype: np.dtype[Any]) -> Any:
    """Return an array as the kernels are compiled for it, whatever an adapter reads; copied only if it must be."""
    contiguous = np.ascontiguousarray(array, dtype)
    return contiguous if contiguous.flags.writeable else contiguous.copy()


class StabilityExtension:
    """Thomsen and Kraus' stability extension over any engine that shows contacts, sleep and mass."""

    def __init__(
        self,
        port: StabilityPort,
        policy: str | Policy = "paper",
        gravity: Sequence[float] = (0.0, 0.0, -9.81),
        settings: Settings | None = None,
    ) -> None:
        """Watch the world behind ``port``.

        The first extension of a policy in a process compiles what it needs: see ``warm_up``.

        Args:
            port: the engine, as the core sees it.
            policy: a name of ``POLICIES``, or a policy of your own.
            gravity: [m/s2], straight down.
            settings: the tolerances.

        Raises:
            UnknownNameError: if there is no such policy.
            ValueError: if gravity does not point straight down: turn the world so that z is up.
        """
        x, y, z = gravity
        if x != 0.0 or y != 0.0 or not (np.isfinite(z) and z < 0.0):
            raise ValueError(f"gravity must be (0, 0, -g), got {tuple(gravity)}: turn the world so that z is up")
        if isinstance(policy, str):
            warm_up(policy)
        self.port = port
        self.settings = settings or Settings()
        self.policy = look_up("policy", policy, POLICIES)(-z, self.settings) if isinstance(policy, str) else policy
        self._graph: Graph = empty_graph()
        self._limits = self.settings.limits(-z)
        self._watch = watch_for(self.settings.longest_dwell, 32)
        self._news: dict[int, str] = {}
        """Bodies woken by the host's words since the last update, with the reason."""
        self._is_pending = False
        """True if something changed since the last update that no contact tells of."""
        self._leaving: list[int] = []
        """Bodies that the host removed, until an update has taken note of them."""
        self._left: frozenset[int] = frozenset()
        """Bodies that the latest update forgot: an engine that lags a frame may still list them."""
        self._dt = math.inf
        """Length of the latest frame [s]."""
        self._reasons: dict[int, str] = {}
        """For what each body was frozen or woken last."""
        self.dropped = 0
        """Rows of contacts and masses dropped so far because they name a body removed in this frame or the last."""

    @property
    def frozen(self) -> IntArray:
        """Ids of all frozen bodies, shape (n,)."""
        return np.flatnonzero(self._graph.bodies["state"] == FROZEN)

    def disturb(self, bodies: Iterable[int]) -> None:
        """A user holds or pushes ``bodies``: they stay live until released; what rests on them is re-examined.

        Raises:
            KeyError: for a body that no update has seen.
        """
        for body in self._seen(bodies):
            self._detach(body)
            self._graph.bodies["held"][body] = True
            if self._graph.bodies["state"][body] == FROZEN:
                self._news[body] = "disturbed"

    def release(self, bodies: Iterable[int]) -> None:
        """The user lets go: ``bodies`` may freeze again once they are at rest.

        Raises:
            KeyError: for a body that no update has seen.
        """
        for body in self._seen(bodies):
            self._graph.bodies["held"][body] = False

    def why(self, body: int) -> str:
        """Say in words why a body is not frozen, such as "0.31 mm deep in its support", or what it was frozen for.

        Raises:
            KeyError: for a body that no update has seen.
        """
        self._seen([body])
        row = self._graph.bodies[body]
        return explain(row, self.settings, self._limits.item(0)[-1], self._dt, self._reasons.get(body, ""))

    def update(self, dt: float) -> Change:
        """Look at the world after a step of ``dt`` seconds; freeze and wake what must be.

        Costs what the live bodies and the changes cost, whatever the number of frozen bodies; next to nothing while
        nothing is live. Nothing changes if it raises, except that a port whose ``sleep`` or ``wake`` raised may have
        carried out a part of the batch: the same is asked of it again in the next update.

        Raises:
            ValueError: if dt is not positive, or the port gives malformed contacts or masses.
        """
        if not 0.0 < dt < math.inf:
            raise ValueError(f"dt must be a positive time in seconds, got {dt}")
        self._dt = dt
        seen = self._look(dt)
        if seen is None:
            skip_frame(self._watch, dt)
            return UNCHANGED
        due, rows = seen
        if due == 0 and not self._is_pending:
            return UNCHANGED
        self._is_pending = False
        return self._settle(rows)

    def adopt(self, bodies: Iterable[int] | None = None) -> Change:
        """Judge bodies that are in place by statics, at once: freeze those that stand, without waiting for their rest.

        For stacks that are there when the simulation starts, or are set down whole: call it before the first step,
        with an engine that lists the contacts of the present poses. What cannot stand stays live, and so does what
        moves, or slides at a contact. Policies that ask for rest alone (``at_rest``, ``pile``) adopt nothing.

        Args:
            bodies: which of the live bodies; None for all.

        Raises:
            KeyError: for a body that the port does not list.
            ValueError: if the port gives malformed contacts or masses.
        """
        if not self.policy.judges_statics:
            return UNCHANGED
        seen = self._look(MOMENT_S)
        if seen is None:
            return UNCHANGED
        table = self._graph.bodies
        wanted = np.flatnonzero(table["state"] == LIVE) if bodies is None else np.array(self._seen(bodies), np.int64)
        self._make_due(wanted[self._is_in_place(table[wanted])])
        self._is_pending = False
        return self._settle(seen[1])

    def _is_in_place(self, rows: Bodies) -> BoolArray:
        """Tell which live bodies neither move, as far as is known, nor slide at a contact, nor are held, shape (k,)."""
        fall_speed = np.sqrt(self._limits["gravity"] * rows["size"])
        moves = np.isfinite(rows["speed"]) & (rows["speed"] > self.settings.rest_speed * fall_speed)
        slides = rows["slip"] > self.settings.rest_slip * fall_speed
        in_place: BoolArray = (rows["state"] == LIVE) & ~rows["held"] & ~moves & ~slides
        return in_place

    def _make_due(self, wanted: IntArray) -> None:
        """Let the live bodies ``wanted`` be decided now, by every rule, shape (k,)."""
        table, due = self._graph.bodies, self._watch.due
        table["unsettled"][wanted] = False
        table["load_s"][wanted] = self.settings.load_s
        for rule in (AT_REST, LEANING, LYING):
            together = np.union1d(due[rule, 1 : 1 + due[rule, 0]], wanted)
            due[rule, 0], due[rule, 1 : 1 + len(together)] = len(together), together

    def _look(self, dt: float) -> tuple[int, int] | None:
        """Take over what the port tells: how many bodies are due, and contacts kept; None if nothing is live or new.

        Raises:
            ValueError: if the port gives malformed contacts or masses.
        """
        contacts, masses = self.port.contacts(), self.port.masses()
        if len(masses.removed):
            self._leaving += checked_removals(masses.removed)
        if self._leaving or self._left:
            contacts, masses = self._without_removed(contacts, masses)
        if len(masses.body) == 0 and len(contacts) == 0 and not (self._is_pending or self._leaving):
            return None
        due, rows = self._observe(contacts, masses, dt)
        if self._leaving:
            self._forget(self._leaving)
        self._left, self._leaving = frozenset(self._leaving), []
        return due, rows

    def _without_removed(self, contacts: Contacts, masses: Masses) -> tuple[Contacts, Masses]:
        """What the port gave, less the rows of bodies that were removed in this frame or the last; these are counted.

        Raises:
            ValueError: if arrays do not belong together.
        """
        check_shapes(contacts, masses)
        gone = [*self._leaving, *self._left]
        stays = ~(np.isin(contacts.body_a, gone) | np.isin(contacts.body_b, gone))
        lives = ~np.isin(masses.body, gone)
        dropped = int(np.count_nonzero(~stays) + np.count_nonzero(~lives))
        if not dropped:
            return contacts, masses
        self.dropped += dropped
        return contacts.chosen(stays), Masses(masses.body[lives], masses.mass[lives], masses.center_of_mass[lives])

    def _observe(self, contacts: Contacts, masses: Masses, dt: float) -> tuple[int, int]:
        """``observe`` with room for every body and contact; returns how many bodies are due, and contacts kept.

        Raises:
            ValueError: for what the port gave, if it is malformed.
        """
        for name, ids in (("masses.body", masses.body), ("contacts.body_a", contacts.body_a)):
            check_ids(name, ids)
        check_ids("contacts.body_b", contacts.body_b)
        room = max(2 * len(contacts), len(masses.body))
        if room >= self._watch.due.shape[1]:
            self._watch = watch_for(self.settings.longest_dwell, 2 * room, self._watch)
        while True:
            try:
                fault, row, due, rows = observe(
                    self._graph.bodies,
                    *self._watch,
                    self._limits,
                    dt,
                    _laid_out(masses.body, IDS),
                    _laid_out(contacts.body_a, IDS),
                    _laid_out(contacts.body_b, IDS),
                    _laid_out(masses.mass, NUMBERS),
                    _laid_out(masses.center_of_mass, NUMBERS),
                    _laid_out(contacts.point, NUMBERS),
                    _laid_out(contacts.normal, NUMBERS),
                    _laid_out(contacts.separation, NUMBERS),
                    _laid_out(contacts.relative_velocity, NUMBERS),
                    _laid_out(contacts.friction, NUMBERS),
                )
            except WrongTypeError:  # an array has more or fewer dimensions
                check_shapes(contacts, masses)
                raise
            if fault != NO_ROOM:
                break
            self._graph = grown(self._graph, row + 1, 0)
        if fault == BAD_SHAPE:
            check_shapes(contacts, masses)
        if fault != FINE:
            raise fault_of(fault, row, contacts, masses)
        if row > 0:
            self._follow_frozen(masses)
        return due, rows

    def _follow_frozen(self, masses: Masses) -> None:
        """Take over what the port tells of frozen bodies: another mass is judged anew, one that has moved is live."""
        bodies = self._graph.bodies
        rows = np.flatnonzero(bodies["state"][masses.body] == FROZEN)
        for row in rows:
            body = int(masses.body[row])
            moved = float(np.linalg.norm(masses.center_of_mass[row] - bodies["center"][body]))
            if moved > self.settings.steady_shift * bodies["size"][body]:
                self._detach(body)
                self._news[body] = "moved"
            elif masses.mass[row] != bodies["mass"][body]:
                bodies["mass"][body] = masses.mass[row]
                note_change(self._graph, body)
                self._is_pending = True

    def _settle(self, rows: int) -> Change:
        """Let the policy freeze what is stable, and wake what is not, with all that rests on it.

        Each of the ``rows`` of contacts may lay a patch for either body, before and after that is frozen.
        """
        woken, self._news = self._news, {}
        for body in woken:
            self._wake(body)
        if 4 * rows > self._graph.spare.item(0):
            self._graph = grown(self._graph, 0, 4 * rows)
        frozen, unbalanced = self.policy.settle(self._graph, self._watch)
        struck = self._watch.due.item(STRUCK, 0)
        if struck:
            self._wake_above(self._watch.due[STRUCK, 1 : 1 + struck], "struck", frozen, woken)
        if len(unbalanced):
            self._wake_above(unbalanced, "unbalanced", frozen, woken)
        return self._tell(frozen, woken)

    def _wake_above(self, roots: IntArray, reason: str, frozen: dict[int, str], woken: dict[int, str]) -> None:
        """Wake the ``roots`` and what rests on them; what was frozen and woken at once never slept."""
        for body in with_all_above(self._graph, roots).tolist():
            if self._graph.bodies["state"][body] == FROZEN:
                self._wake(body)
                if frozen.pop(body, None) is None:
                    woken[body] = reason if body in roots else f"rested on what was {reason}"

    def _tell(self, frozen: dict[int, str], woken: dict[int, str]) -> Change:
        """One sleep and one wake batch for the engine."""
        if not frozen and not woken:
            return UNCHANGED
        asleep, awake = tuple(sorted(frozen)), tuple(sorted(woken))
        try:
            if asleep:
                self.port.sleep(asleep)
        except BaseException:
            self._take_back(asleep, woken)
            raise
        try:
            if awake:
                self.port.wake(awake)
        except BaseException:
            self._take_back((), woken)
            raise
        reasons = frozen | woken if awake else frozen
        self._reasons.update(reasons)
        return Change(asleep, awake, reasons)

    def _take_back(self, asleep: Iterable[int], woken: Mapping[int, str]) -> None:
        """Undo a batch that the port did not carry out: what should sleep is live, what should wake is asked again."""
        for body in asleep:
            self._wake(body)
            self._graph.bodies["unsettled"][body] = False
        for body, reason in woken.items():
            self._graph.bodies["state"][body] = FROZEN
            self._news[body] = reason
            self._is_pending = True

    def _wake(self, body: int) -> None:
        """Hand a frozen body back; until it moves it goes on to load what it rests on."""
        row = self._graph.bodies[body]
        row["state"], row["unsettled"], row["leans"], row["doubt"] = LIVE, True, False, PROVEN
        row["rest_s"] = row["still_s"] = row["lean_s"] = row["steady_s"] = 0.0
        row["load_s"] = self.settings.load_s
        row["is_load"], row["load_center"] = True, row["center"]
        row["load_supported_by"] = supports_as_bits(self._graph, body)

    def _detach(self, body: int) -> None:
        self._is_pending = True
        drop_supports(self._graph, body)
        drop_loads(self._graph, body)

    def _forget(self, removed: Sequence[int]) -> None:
        """Drop bodies that left the world; one that was never seen leaves nothing behind."""
        for body in removed:
            if body < len(self._graph.bodies):
                self._detach(body)
                self._graph.bodies["state"][body] = ABSENT
                self._news.pop(body, None)
                self._reasons.pop(body, None)

    def _seen(self, bodies: Iterable[int]) -> list[int]:
        wanted = list(bodies)
        states = self._graph.bodies["state"]
        unknown = [body for body in wanted if not 0 <= body < len(states) or states[body] == ABSENT]
        if unknown:
            raise KeyError(f"unknown body {', '.join(map(str, unknown))}: no update has seen it")
        return wanted
