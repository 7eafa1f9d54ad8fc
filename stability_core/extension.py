"""The extension: once a frame, freeze statically stable bodies, and unfreeze bodies that no longer balance."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from functools import partial
from typing import Self

import numpy as np

from stability_core.batch import UNCHANGED, Batch, Change, unfreeze
from stability_core.compiling import compile_policy
from stability_core.explanation import explain
from stability_core.frame_buffers import AT_REST, LEANING, LYING, MOVED, STRUCK, skip_frame
from stability_core.lookup import look_up
from stability_core.policies import POLICIES, Policy
from stability_core.port import BoolArray, Contacts, IntArray, Masses, StabilityPort
from stability_core.settings import Settings
from stability_core.stack import (
    FROZEN,
    LIVE,
    Bodies,
    note_change,
)
from stability_core.upright import checked_gravity
from stability_core.validation import check_shapes, checked_removals
from stability_core.world import World

CLOSED = "this extension is closed: create a new StabilityExtension for the port, or call attach() again"
MOMENT_S = 1e-9
"""Time [s] of an update without a step, so short that any motion since the last update counts as fast."""


def warm_up(policy: str = "equilibrium") -> float:
    """Compile all kernels of ``policy``, or read them from Numba's cache, and return the time [s].

    ``StabilityExtension`` calls this function for a policy given by name, so that Numba compiles nothing while a
    simulation runs. You may call the function earlier, for example while you build a container. Compiling takes one to
    two minutes, once per version of the core if Numba's cache is writable. A further call for the same policy in the
    same process only returns 0. The function reports long compilations, and a cache that is not writable, to the logger
    ``stability_core``.

    Raises:
        UnknownNameError: if ``policy`` is no name of ``POLICIES``.
    """
    look_up("policy", policy, POLICIES)
    return compile_policy(policy, partial(StabilityExtension, policy=policy))


class StabilityExtension:
    """The stability extension of Thomsen and Kraus (2015), for any engine that provides contacts, sleep and mass."""

    def __init__(
        self,
        port: StabilityPort,
        policy: str | Policy = "paper",
        gravity: Sequence[float] = (0.0, 0.0, -9.81),
        settings: Settings | None = None,
    ) -> None:
        """Attach the extension to the world behind ``port``.

        For a policy given by name, the first extension in a process compiles the kernels: see ``warm_up``.

        Args:
            port: the core's view of the engine.
            policy: a name of ``POLICIES``, or a policy of your own.
            gravity: gravity [m/s2], in any direction. Assign ``StabilityExtension.gravity`` when gravity changes.
            settings: the tolerances, or None for the defaults.

        Raises:
            UnknownNameError: if ``policy`` is an unknown name.
            ValueError: if gravity is not a finite vector, or zero.
        """
        self._gravity = checked_gravity(gravity)
        if isinstance(policy, str):
            warm_up(policy)
        self.port = port
        self.settings = settings or Settings()
        self._world = World(self.settings, self._gravity)
        strength = self._world.upright.strength
        self.policy = (
            look_up("policy", policy, POLICIES)(strength, self.settings) if isinstance(policy, str) else policy
        )
        if self.policy.gravity != strength:
            self.policy.set_gravity(strength)
        self._news: dict[int, str] = {}
        """Reason, by row, of each body that the next update must unfreeze."""
        self._is_pending = False
        """True after a change that no contact shows, because the next update must then judge the stack again."""
        self._leaving: list[int] = []
        """Ids of bodies that the host has removed since the last update."""
        self._left: frozenset[int] = frozenset()
        """Ids of bodies that the latest update dropped. An engine whose lists are a frame late may still list them."""
        self._dt = math.inf
        """Length of the latest frame [s]."""
        self._is_closed = False
        self._reasons: dict[int, str] = {}
        """Reason of each body's last freezing or unfreezing."""
        self.dropped = 0
        """Number of contact and mass rows dropped so far, because these rows name a body removed in the same frame or
        the previous frame."""

    @property
    def frozen(self) -> IntArray:
        """Ids of all frozen bodies in rising order, shape (n,)."""
        table = self._world.graph.bodies
        ids: IntArray = np.sort(table["id"][table["state"] == FROZEN])
        return ids

    @property
    def gravity(self) -> tuple[float, float, float]:
        """Gravity [m/s2], in the coordinates of the port.

        Set this value before ``update`` whenever gravity changes. Small changes add up. After a total change above
        ``gravity_tilt`` or ``gravity_change``, the next update judges every frozen body again: O(bodies).
        """
        return self._gravity

    @gravity.setter
    def gravity(self, gravity: Sequence[float]) -> None:
        """Set gravity.

        Raises:
            ValueError: if gravity is not a finite vector, or zero.
        """
        self._gravity = checked_gravity(gravity)

    def __enter__(self) -> Self:
        """Return the extension. ``__exit__`` closes the extension at the end of the ``with`` block."""
        return self

    def __exit__(self, *_: object) -> None:
        """Close the extension."""
        self.close()

    def close(self) -> None:
        """Unfreeze every frozen body, so that another extension can take over the port.

        Afterwards ``update``, ``adopt`` and ``wake`` raise RuntimeError. A second call does nothing.
        """
        if self._is_closed:
            return
        frozen = tuple(self.frozen.tolist())
        if frozen:
            self.port.wake(frozen)
        for row in self._world.rows_of(frozen).tolist():
            unfreeze(self._world, row)
        self._is_closed = True

    def wake(self, bodies: Iterable[int]) -> Change:
        """Unfreeze ``bodies`` and the frozen bodies on them immediately, as an impact would.

        Call this method in two cases:

        - before you apply an impulse or an explosion, so that the bodies move in the same frame;
        - when a support starts to move in a way that the port cannot show. For example, pass the id of a conveyor belt
          under frozen bodies.

        An unfrozen body at rest may freeze again, once it has moved or has stayed calm for ``calm_s``.

        Raises:
            KeyError: for a body that the port has never listed, or has removed.
            RuntimeError: if the extension is closed.
        """
        self._check_open()
        batch = Batch(self._world, self.policy)
        batch.wake_above(self._world.rows_of(bodies), "woken by the host")
        for row in batch.woken:
            self._news.pop(row, None)
        return self._send(batch)

    def disturb(self, bodies: Iterable[int]) -> None:
        """Keep ``bodies`` live while a user holds or pushes these bodies.

        The next update unfreezes the frozen bodies of ``bodies``, and judges the bodies on them again. End this state
        with ``release``.

        Raises:
            KeyError: for a body that the port has never listed, or has removed.
        """
        table = self._world.graph.bodies
        for row in self._world.rows_of(bodies).tolist():
            self._detach(row)
            table["held"][row] = True
            if table["state"][row] == FROZEN:
                self._news[row] = "disturbed"

    def release(self, bodies: Iterable[int]) -> None:
        """Let ``bodies`` freeze again once they are at rest, after the user has released these bodies.

        Raises:
            KeyError: for a body that the port has never listed, or has removed.
        """
        self._world.graph.bodies["held"][self._world.rows_of(bodies)] = False

    def why(self, body: int) -> str:
        """Explain why a body is live (such as "0.31 mm deep in its support"), or why the core froze the body.

        Raises:
            KeyError: for a body that the port has never listed, or has removed.
        """
        row = self._world.graph.bodies[self._world.rows_of([body])[0]]
        return explain(row, self.settings, self.policy, self._dt, self._reasons.get(body, ""))

    def update(self, dt: float) -> Change:
        """Read the world after a step of ``dt`` seconds, and freeze and unfreeze bodies.

        In a frame without changes, the cost depends only on the bodies and contacts that the port lists, not on the
        number of frozen bodies. While the port lists no body and no contact, and the host makes no change, the core
        only reads the port. If the input is malformed, no body freezes or unfreezes. If the port's ``sleep`` or
        ``wake`` raises, the port may have carried out a part of the call, and the next update repeats the unfreezing.
        If ``sleep`` raises, the bodies of this call count as live, and must come to rest again.

        Raises:
            ValueError: if dt is not positive and finite, or the port returns malformed contacts or masses.
            RuntimeError: if the extension is closed.
        """
        self._check_open()
        if not 0.0 < dt < math.inf:
            raise ValueError(f"dt must be positive and finite, got {dt} s: pass the time since the previous update()")
        self._dt = dt
        seen = self._look(dt)
        if seen is None:
            skip_frame(self._world.buffers, dt)
            return UNCHANGED
        due, contacts = seen
        if due == 0 and not self._is_pending and not self.policy.is_waiting:
            return UNCHANGED
        self._is_pending = False
        return self._settle(contacts, self.settings.budget)

    def adopt(self, bodies: Iterable[int] | None = None) -> Change:
        """Judge bodies in place by statics, and freeze the bodies that stand, even before these bodies are at rest.

        Use this method for stacks that exist when the simulation starts, and for stacks that you place as a whole. Call
        the method before the first step, with an engine that lists the contacts of the present poses. Bodies stay live
        if they cannot stand, if they move, if they slide at a contact, or if a user holds them. Policies that do not
        judge statics (``at_rest``, ``pile``) adopt nothing.

        Args:
            bodies: the bodies to judge, of which only live bodies count, or None for all live bodies.

        Raises:
            KeyError: for a body that the port has never listed, or has removed.
            ValueError: if the port returns malformed contacts or masses.
            RuntimeError: if the extension is closed.
        """
        self._check_open()
        if not self.policy.judges_statics:
            return UNCHANGED
        seen = self._look(MOMENT_S)
        if seen is None:
            return UNCHANGED
        table = self._world.graph.bodies
        wanted = np.flatnonzero(table["state"] == LIVE) if bodies is None else self._world.rows_of(bodies)
        self._make_due(wanted[self._is_in_place(table[wanted])])
        self._is_pending = False
        return self._settle(seen[1], math.inf)

    def _check_open(self) -> None:
        if self._is_closed:
            raise RuntimeError(CLOSED)

    def _is_in_place(self, rows: Bodies) -> BoolArray:
        """Return a mask (k,): True for a live body that no user holds, without sliding and without known motion."""
        fall_speed = np.sqrt(self._world.limits["gravity"] * rows["size"])
        moves = np.isfinite(rows["speed"]) & (rows["speed"] > self.settings.rest_speed * fall_speed)
        slides = rows["slip"] > self.settings.rest_slip * fall_speed
        in_place: BoolArray = (rows["state"] == LIVE) & ~rows["held"] & ~moves & ~slides
        return in_place

    def _make_due(self, wanted: IntArray) -> None:
        """Put the live bodies ``wanted``, shape (k,), on the worklist of every rule."""
        table, worklist = self._world.graph.bodies, self._world.buffers.worklist
        table["unsettled"][wanted] = False
        table["load_s"][wanted], table["quiet_s"][wanted] = self.settings.load_s, math.inf
        for rule in (AT_REST, LEANING, LYING):
            together = np.union1d(worklist[rule, 1 : 1 + worklist[rule, 0]], wanted)
            worklist[rule, 0], worklist[rule, 1 : 1 + len(together)] = len(together), together

    def _look(self, dt: float) -> tuple[int, int] | None:
        """Read one frame, and return the worklist's length and the number of kept contacts.

        The result is None if the port lists nothing and the host has changed nothing.

        Raises:
            ValueError: if the port returns malformed contacts or masses.
        """
        if self._gravity is not self._world.upright.gravity:
            self._follow_gravity()
        contacts, masses = self.port.contacts(), self.port.masses()
        if len(masses.removed):
            self._leaving += checked_removals(masses.removed)
        if self._leaving or self._left:
            contacts, masses = self._without_removed(contacts, masses)
        if len(masses.body) == 0 and len(contacts) == 0 and not (self._is_pending or self._leaving):
            self._left = frozenset()
            return None
        due, kept, frozen = self._world.observe(contacts, masses, dt)
        if frozen:
            self._follow_frozen(masses)
        if self._leaving or self._left:
            self._forget(self._leaving)
            self._left, self._leaving = frozenset(self._leaving), []
        return due, kept

    def _follow_gravity(self) -> None:
        """Request a new judgement of all bodies if gravity has changed by more than its tolerances."""
        if self._world.turn(self._gravity):
            self.policy.set_gravity(self._world.upright.strength)
            self._is_pending = True

    def _without_removed(self, contacts: Contacts, masses: Masses) -> tuple[Contacts, Masses]:
        """Return the port's arrays without the rows of recently removed bodies, and count the dropped rows.

        Raises:
            ValueError: if the shapes or the types of the arrays do not fit together.
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

    def _follow_frozen(self, masses: Masses) -> None:
        """Compare the listed frozen bodies with the table, and record changes of mass and place for this update."""
        bodies = self._world.graph.bodies
        for row, mass, moved in self._world.frozen_listed(masses):
            if math.isinf(mass) or moved > self.settings.steady_shift * bodies["size"][row]:
                self._detach(row)
                self._news[row] = "moved by the host" if math.isinf(mass) else "moved"
            elif mass != bodies["mass"][row]:
                bodies["mass"][row] = mass
                note_change(self._world.graph, row)
                self._is_pending = True

    def _settle(self, contacts: int, budget: float) -> Change:
        """Let the policy freeze stable bodies, and unfreeze unbalanced bodies and the bodies on them.

        The ``budget`` [bodies] limits the work of the policy: see ``Policy``. The number of kept ``contacts`` bounds
        the number of new patches.
        """
        batch, worklist = Batch(self._world, self.policy), self._world.buffers.worklist
        if self._news:
            news, self._news = self._news, {}
            batch.wake(news)
        if moved := worklist.item(MOVED, 0):
            batch.leave_moved(worklist[MOVED, 1 : 1 + moved])
        self._world.make_room(contacts)
        self.policy.budget = budget
        batch.frozen, unbalanced, batch.deferred = self.policy.settle(self._world.graph, self._world.buffers)
        if struck := worklist.item(STRUCK, 0):
            batch.wake_struck(worklist[STRUCK, 1 : 1 + struck].copy())
        if len(unbalanced):
            batch.wake_above(unbalanced, "unbalanced")
        return self._send(batch)

    def _send(self, batch: Batch) -> Change:
        """Send a batch to the engine, and record the reasons of its changes.

        If the port raises, the next update unfreezes the bodies in ``batch.woken``, and the method raises again.
        """
        try:
            change = batch.hand_over(self.port)
        except BaseException:
            self._news.update(batch.woken)
            self._is_pending |= len(batch.woken) > 0
            raise
        self._reasons.update(change.reasons)
        self._is_pending |= batch.is_unfinished
        return change

    def _detach(self, row: int) -> None:
        self._is_pending = True
        self._world.detach(row)

    def _forget(self, removed: Sequence[int]) -> None:
        """Drop bodies that left the world."""
        rows = self._world.forget(removed)
        self._is_pending |= len(rows) > 0
        for row in rows.tolist():
            self._news.pop(row, None)
        for body in removed:
            self._reasons.pop(body, None)
