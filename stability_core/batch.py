"""Collect the bodies to freeze and the bodies to unfreeze in a frame, and send each list to the engine in one call."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import NamedTuple

import numpy as np

from stability_core.manifold import supports_as_bits
from stability_core.policies.base import NOBODY, Policy
from stability_core.port import IntArray, StabilityPort
from stability_core.stack import FROZEN, LIVE, MOVING, PROVEN, around, drop_frozen_loads, drop_supports
from stability_core.world import World


class Change(NamedTuple):
    """The bodies that one call of ``update``, ``adopt`` or ``wake`` froze and unfroze."""

    frozen: tuple[int, ...]
    """Ids of the frozen bodies, in rising order."""
    woken: tuple[int, ...]
    """Ids of the unfrozen bodies, in rising order."""
    reasons: Mapping[int, str]
    """Reason of each freezing or unfreezing, by the body's id."""
    deferred: tuple[int, ...] = ()
    """Ids of the candidates beyond this frame's budget, in rising order. The next frame lists these bodies again."""


UNCHANGED = Change((), (), {})
DRAGGED_ALONG = 3
"""Number of contacts, counted from a body that a blow throws away, within which frozen bodies unfreeze too, because
friction drags the body's neighbours along."""


def unfreeze(world: World, row: int) -> None:
    """Make a frozen body live. The body keeps its patches, and counts as a load of its supports."""
    body = world.graph.bodies[row]
    body["state"], body["unsettled"], body["leans"], body["doubt"] = LIVE, True, False, PROVEN
    body["rest_s"] = body["still_s"] = body["lean_s"] = body["steady_s"] = body["idle_s"] = 0.0
    body["is_resting"] = False
    body["blow"] = body["slid"] = 0.0
    body["load_s"] = world.settings.load_s
    body["is_load"], body["load_center"], body["load_steady_s"] = True, body["center"], body["steady_s"]
    body["load_supported_by"] = body["stood_on"] = supports_as_bits(world.graph, row)
    body["shifts"], body["stood_on_s"] = 0, 0.0


class Batch:
    """The bodies to freeze and the bodies to unfreeze in one frame, by row, each with its reason."""

    __slots__ = ("_policy", "_world", "deferred", "frozen", "is_unfinished", "woken")

    def __init__(self, world: World, policy: Policy) -> None:
        """Start an empty batch for the bodies of ``world``, which the ``policy`` judges."""
        self._world, self._policy = world, policy
        self.frozen: dict[int, str] = {}
        self.woken: dict[int, str] = {}
        self.deferred = NOBODY
        self.is_unfinished = False
        """True if the next update must judge frozen bodies that lost a contact."""

    def wake(self, reasons: Mapping[int, str]) -> None:
        """Unfreeze the bodies whose rows are the keys of ``reasons``, but not the bodies on them."""
        self.woken.update(reasons)
        for row in reasons:
            unfreeze(self._world, row)

    def wake_above(self, roots: IntArray, reason: str) -> None:
        """Unfreeze the frozen bodies among the ``roots``, shape (k,), and the frozen bodies that rest on them.

        Frozen bodies that only touch these bodies lose their patches on them. If this batch also freezes one of these
        bodies, ``hand_over`` sends neither sleep nor wake for this body.
        """
        graph = self._world.graph
        rows = self._policy.resting_on(graph, roots)
        for row in rows.tolist():
            if graph.bodies["state"][row] == FROZEN:
                unfreeze(self._world, row)
                graph.bodies["wakes"][row] += 1
                if self.frozen.pop(row, None) is None:
                    self.woken[row] = reason if row in roots else f"rested on what was {reason}"
        self.is_unfinished |= drop_frozen_loads(graph, rows) > 0

    def wake_struck(self, struck: IntArray) -> None:
        """Unfreeze the ``struck`` bodies, shape (k,), and the bodies on them.

        If the slide of a blow exceeds the size of the struck body, the bodies within ``DRAGGED_ALONG`` contacts, and
        the bodies on them, unfreeze too.
        """
        graph = self._world.graph
        rows = graph.bodies[struck]
        flung = struck[rows["blow"] > rows["size"]]
        self.wake_above(around(graph, flung, DRAGGED_ALONG), "struck")
        self.wake_above(struck, "struck")

    def leave_moved(self, moved: IntArray) -> None:
        """Unfreeze the frozen bodies among ``moved``, shape (k,), and the frozen bodies on the moved bodies.

        The method also drops the patches of each MOVING body on its supports.
        """
        self.wake_above(moved, "moved by the host")
        graph = self._world.graph
        for row in moved.tolist():
            if graph.bodies["state"][row] == MOVING:
                drop_supports(graph, row)

    def hand_over(self, port: StabilityPort) -> Change:
        """Send at most one sleep call and one wake call to the engine, and return the change by ids.

        If the port raises, the method restores the former states in the core's table:

        - if ``sleep`` raises, the states of all bodies of the batch;
        - if ``wake`` raises, the states of the bodies in ``woken``: frozen.

        The bodies in ``woken`` stay there, so that the next update can unfreeze them. The method raises the port's
        exception again.
        """
        later = tuple(np.sort(self._world.ids[self.deferred]).tolist()) if len(self.deferred) else ()
        if not self.frozen and not self.woken:
            return UNCHANGED._replace(deferred=later) if later else UNCHANGED
        asleep, awake = self._by_id(self.frozen), self._by_id(self.woken)
        frozen, woken = tuple(asleep), tuple(awake)
        try:
            if frozen:
                port.sleep(frozen)
        except BaseException:
            self._take_back(self.frozen)
            raise
        try:
            if woken:
                port.wake(woken)
        except BaseException:
            self._take_back(())
            raise
        return Change(frozen, woken, asleep | awake if woken else asleep, later)

    def _by_id(self, reasons: Mapping[int, str]) -> dict[int, str]:
        """Return the ``reasons`` by body id instead of row, in rising order of the ids."""
        if not reasons:
            return {}
        ids = self._world.ids
        named = {ids.item(row): reason for row, reason in reasons.items()}
        return named if len(named) == 1 else dict(sorted(named.items()))

    def _take_back(self, asleep: Iterable[int]) -> None:
        """Undo a batch that the port did not carry out: make ``asleep`` live, and the bodies in ``woken`` frozen."""
        table = self._world.graph.bodies
        for row in asleep:
            unfreeze(self._world, row)
            table["unsettled"][row] = False
        for row in self.woken:
            table["state"][row] = FROZEN
