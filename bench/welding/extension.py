"""The loop of the welding policies: read contacts, part struck bodies, and review all bodies ten times a second."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple, Protocol

import numpy as np

from bench.welding.balance import Touches, residuals
from bench.welding.bodies import NOBODY, BodyTable
from bench.welding.joints import Pair, new_joints
from bench.welding.recent_contacts import RecentContacts
from bench.welding.settings import CORE, FAILURES, MAX_RESIDUAL, REVIEW_S
from stability_core.blows import AHEAD
from stability_core.extension import MOMENT_S
from stability_core.port import BoolArray, Contacts, FloatArray, IntArray, StabilityPort
from stability_core.settings import ROUNDING_S

Load = Literal["own", "carried"]
"""Load of a body in the test of equilibrium: its own weight, or also the weight of the bodies on it."""


class WeldPort(StabilityPort, Protocol):
    """A port that can also join bodies."""

    def join(self, pairs: Iterable[Pair]) -> None:
        """Join pairs of live bodies, so that each pair keeps its present relative pose; skip joined pairs."""
        ...

    def part(self, pairs: Iterable[Pair]) -> None:
        """Part joined pairs; skip pairs that are not joined."""
        ...


class WeldChange(NamedTuple):
    """The changes since the previous update."""

    joined: tuple[Pair, ...]
    """Pairs that this update joined."""
    parted: tuple[Pair, ...]
    """Pairs parted since the previous update, without pairs of a body that left the world."""
    reasons: Mapping[int, str]
    """Reason for each parting of a body from all its neighbours, by id: "held", "struck" or "out of balance"."""


@dataclass(frozen=True, slots=True)
class _Seen:
    """The contact points of one frame, by rows of the table."""

    a: IntArray
    b: IntArray
    contacts: Contacts
    approach: FloatArray
    """Approach speed along the normal [m/s], shape (n,); NaN if unknown."""
    size: FloatArray
    """Size [m] of the smaller body of the pair, shape (n,)."""


class WeldExtension:
    """The policy after Hsu and Keyser 2012: joints between bodies at rest that are in equilibrium.

    The test of a body's equilibrium uses only the contacts of this body (``bench.welding.balance``). The policy joins
    no body to the ground.
    """

    def __init__(self, port: WeldPort, load: Load, gravity: Sequence[float]) -> None:
        """Attach the extension to the world behind ``port``.

        Args:
            port: the view of the engine, with joints.
            load: load of a body in the test of equilibrium.
            gravity: gravity [m/s2], shape (3,), not zero.
        """
        self._port = port
        self._load = load
        self._gravity = np.array(gravity, np.float64)
        self._bodies = BodyTable()
        self._recent = RecentContacts()
        self.joined: set[Pair] = set()
        """Pairs that are joined."""
        self._since_s = 0.0  # time since the latest review
        self._is_due = False  # True to review in the next update
        self._parted: list[Pair] = []  # since the latest change was returned
        self._reasons: dict[int, str] = {}

    @property
    def gravity(self) -> FloatArray:
        """Return gravity [m/s2], shape (3,). The caller must assign the new gravity when gravity changes."""
        return self._gravity

    @gravity.setter
    def gravity(self, gravity: Sequence[float]) -> None:
        self._gravity = np.array(gravity, np.float64)
        self._is_due = True

    def disturb(self, bodies: Iterable[int]) -> None:
        """Part ``bodies`` from their neighbours while a user holds or pushes them, and join nothing to them.

        The effect lasts until ``release``.
        """
        self._hold(bodies, is_held=True)
        for body in bodies:
            self._release(body, "held")

    def release(self, bodies: Iterable[int]) -> None:
        """Let ``bodies`` be joined again once they are at rest, because the user has released them."""
        self._hold(bodies, is_held=False)

    def adopt(self, bodies: Iterable[int]) -> WeldChange:
        """Review all bodies at once, with ``bodies`` of a prebuilt stack counted as at rest; return the changes."""
        self._look(MOMENT_S)
        rows = self._bodies.rows_of(np.fromiter(bodies, np.int64))
        self._bodies.rows["rest_s"][rows[rows != NOBODY]] = CORE.rest_s
        return self._change(self._review())

    def update(self, dt: float) -> WeldChange:
        """Read the world after a step of ``dt`` seconds, part and join bodies, and return the changes."""
        seen = self._look(dt)
        for body in self._struck(seen, dt):
            self._release(body, "struck")
        self._since_s += dt
        is_due = self._is_due or self._since_s >= REVIEW_S - ROUNDING_S
        return self._change(self._review() if is_due else ())

    def _look(self, dt: float) -> _Seen:
        """Read bodies and contacts; update sizes and times at rest."""
        contacts, masses = self._port.contacts(), self._port.masses()
        table = self._bodies
        self._recent.forget(masses.removed)
        if table.follow(masses, dt):
            known = set(table.rows["id"].tolist())
            self.joined = {pair for pair in self.joined if known.issuperset(pair)}
            self._is_due = True
        a, b = table.rows_of(contacts.body_a), table.rows_of(contacts.body_b)
        for rows in (a, b):
            has = rows != NOBODY
            table.note_sizes(rows[has], contacts.point[has])
        size = np.append(table.rows["size"], np.inf)  # the last one for NOBODY
        along = np.einsum("ij,ij->i", contacts.relative_velocity, contacts.normal)
        sliding = np.linalg.norm(contacts.relative_velocity - along[:, None] * contacts.normal, axis=1)
        seen = _Seen(a, b, contacts, -along, np.minimum(size[a], size[b]))
        slip = np.zeros(len(table.rows) + 1)
        touches = self._touches(seen)
        self._recent.add(contacts.chosen(touches), dt)
        touching = touches & np.isfinite(sliding)
        for rows in (a, b):
            np.maximum.at(slip, rows[touching], sliding[touching])
        table.time_rest(slip[:-1], self._strength, dt)
        return seen

    @property
    def _strength(self) -> float:
        return float(np.linalg.norm(self._gravity))

    def _touches(self, seen: _Seen) -> BoolArray:
        """Return the mask of the contact points that may carry force, by the core's rules for gaps, shape (n,)."""
        gap = np.where(self._bears(seen.contacts), CORE.contact_gap, CORE.touch_gap) * seen.size
        mask: BoolArray = ~(seen.contacts.separation > gap)  # an unknown (NaN) separation counts as touch
        return mask

    def _bears(self, contacts: Contacts) -> BoolArray:
        """Return the mask of the load-bearing contacts, whose friction cone contains the vertical, shape (n,)."""
        upward = np.abs(contacts.normal @ self._gravity) / self._strength
        mask: BoolArray = upward >= 1.0 / np.sqrt(1.0 + contacts.friction**2)
        return mask

    def _struck(self, seen: _Seen, dt: float) -> list[int]:
        """Return the ids of the bodies that something strikes fast, or is about to strike fast."""
        unit = np.sqrt(self._strength * seen.size)
        limit = np.maximum(CORE.impact_speed * unit, CORE.impact_frames * self._strength * dt)
        hard = (seen.approach > limit) & ~(seen.contacts.separation > AHEAD * seen.approach * dt)
        if not hard.any():
            return []
        rows = np.unique(np.concatenate((seen.a[hard], seen.b[hard])))
        return self._ids(rows[rows != NOBODY])

    def _review(self) -> list[Pair]:
        """Test all bodies; part joined bodies after ``FAILURES`` failed tests, and return the pairs to join."""
        self._since_s, self._is_due = 0.0, False
        rows, touches = self._bodies.rows, self._recent_touches()
        center, size, mass = (np.ascontiguousarray(rows[name]) for name in ("center", "size", "mass"))
        lacking = residuals(center, size, mass, self._gravity, touches, self._load == "carried")
        passes = lacking <= MAX_RESIDUAL
        is_joined = np.isin(rows["id"], [body for pair in self.joined for body in pair])
        rows["failures"] = np.where(passes | ~is_joined, 0, rows["failures"] + 1)
        for body in self._ids(np.flatnonzero(rows["failures"] >= FAILURES)):
            self._release(body, "out of balance")
        self._is_due = bool(rows["failures"].any())
        ready = passes & (rows["rest_s"] >= CORE.rest_s - ROUNDING_S) & ~rows["held"]
        return new_joints(self._candidates(touches, ready), self.joined)

    def _recent_touches(self) -> Touches:
        """Return the contact points that may carry force, by rows of the table."""
        contacts = self._recent.latest_of_pairs()
        a, b = self._bodies.rows_of(contacts.body_a), self._bodies.rows_of(contacts.body_b)
        return Touches(a, b, contacts.point, contacts.normal, contacts.friction, self._bears(contacts))

    def _candidates(self, touches: Touches, ready: BoolArray) -> list[Pair]:
        """Return the touching pairs of ``ready`` bodies that are not joined, the lowest contact first."""
        is_ready = np.append(ready, False)  # the last one for NOBODY
        between = np.flatnonzero(is_ready[touches.a] & is_ready[touches.b])
        nearest = between[np.argsort(-(touches.point[between] @ self._gravity), kind="stable")]
        pairs = zip(self._ids(touches.a[nearest]), self._ids(touches.b[nearest]), strict=True)
        distinct = dict.fromkeys((min(pair), max(pair)) for pair in pairs)
        return [pair for pair in distinct if pair not in self.joined]

    def _release(self, body: int, reason: str) -> None:
        """Part a body from all its neighbours, and restart its time at rest and its count of failed tests."""
        pairs = [pair for pair in self.joined if body in pair]
        row = self._bodies.rows_of(np.array([body]))
        self._bodies.rows["rest_s"][row[row != NOBODY]] = 0.0
        self._bodies.rows["failures"][row[row != NOBODY]] = 0
        if not pairs:
            return
        self._port.part(pairs)
        self.joined.difference_update(pairs)
        self._parted += pairs
        self._reasons[body] = reason
        self._is_due = True

    def _change(self, pairs: Sequence[Pair]) -> WeldChange:
        """Join ``pairs``; return the changes since the previous call."""
        if pairs:
            self._port.join(pairs)
            self.joined.update(pairs)
        change = WeldChange(tuple(pairs), tuple(self._parted), self._reasons)
        self._parted, self._reasons = [], {}
        return change

    def _hold(self, bodies: Iterable[int], *, is_held: bool) -> None:
        rows = self._bodies.rows_of(np.fromiter(bodies, np.int64))
        self._bodies.rows["held"][rows[rows != NOBODY]] = is_held

    def _ids(self, rows: IntArray) -> list[int]:
        ids: list[int] = self._bodies.rows["id"][rows].tolist()
        return ids
