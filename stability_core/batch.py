"""Collect the bodies that one frame freezes and unfreezes, and send them to the engine in at most two calls."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import NamedTuple

import numpy as np

from stability_core.manifold import supports_as_bits
from stability_core.policies.base import NOBODY
from stability_core.port import IntArray, StabilityPort
from stability_core.stack import FROZEN, LIVE, MOVING, PROVEN, around, drop_supports, with_all_above
from stability_core.world import World


class Change(NamedTuple):
    """The changes of one update."""

    frozen: tuple[int, ...]
    """Bodies frozen in this frame, by rising id."""
    woken: tuple[int, ...]
    """Bodies unfrozen in this frame, by rising id."""
    reasons: Mapping[int, str]
    """Reason for each frozen or unfrozen body, by id."""
    deferred: tuple[int, ...] = ()
    """Bodies at rest that the next frame judges, because this frame's budget was spent, by rising id."""


UNCHANGED = Change((), (), {})
DRAGGED_ALONG = 3
"""Number of contacts, counted from a body that a blow throws away, within which frozen bodies unfreeze with that body.
"""


def unfreeze(world: World, row: int) -> None:
    """Make a frozen body live. Until the body moves, the body still loads its supports."""
    body = world.graph.bodies[row]
    body["state"], body["unsettled"], body["leans"], body["doubt"] = LIVE, True, False, PROVEN
    body["rest_s"] = body["still_s"] = body["lean_s"] = body["steady_s"] = 0.0
    body["blow"] = body["slid"] = 0.0
    body["load_s"] = world.settings.load_s
    body["is_load"], body["load_center"], body["load_steady_s"] = True, body["center"], body["steady_s"]
    body["load_supported_by"] = supports_as_bits(world.graph, row)


class Batch:
    """The bodies that one frame freezes and unfreezes, by row, with the reasons."""

    __slots__ = ("_world", "deferred", "frozen", "woken")

    def __init__(self, world: World) -> None:
        """Start an empty batch for the bodies of ``world``."""
        self._world = world
        self.frozen: dict[int, str] = {}
        self.woken: dict[int, str] = {}
        self.deferred = NOBODY

    def wake(self, reasons: Mapping[int, str]) -> None:
        """Unfreeze the bodies in ``reasons``, by row, but not the bodies on them."""
        self.woken.update(reasons)
        for row in reasons:
            unfreeze(self._world, row)

    def wake_above(self, roots: IntArray, reason: str) -> None:
        """Unfreeze the ``roots``, shape (k,), and the bodies on them.

        If this batch also freezes one of these bodies, the engine gets neither the sleep nor the wake of the body.
        """
        graph = self._world.graph
        for row in with_all_above(graph, roots).tolist():
            if graph.bodies["state"][row] == FROZEN:
                unfreeze(self._world, row)
                graph.bodies["wakes"][row] += 1
                if self.frozen.pop(row, None) is None:
                    self.woken[row] = reason if row in roots else f"rested on what was {reason}"

    def wake_struck(self, struck: IntArray) -> None:
        """Unfreeze the ``struck`` bodies, shape (k,), and the bodies on them.

        If the slide of a blow exceeds the size of the struck body, the frozen bodies within ``DRAGGED_ALONG`` contacts
        of this body unfreeze too.
        """
        graph = self._world.graph
        rows = graph.bodies[struck]
        flung = struck[rows["blow"] > rows["size"]]
        self.wake_above(around(graph, flung, DRAGGED_ALONG), "struck")
        self.wake_above(struck, "struck")

    def leave_moved(self, moved: IntArray) -> None:
        """Unfreeze the ``moved`` bodies, shape (k,), and the bodies on them; drop the supports of kinematic bodies."""
        self.wake_above(moved, "moved by the host")
        graph = self._world.graph
        for row in moved.tolist():
            if graph.bodies["state"][row] == MOVING:
                drop_supports(graph, row)

    def hand_over(self, port: StabilityPort) -> Change:
        """Send one sleep and one wake batch to the engine; return the change by ids.

        The method undoes a call that raises. After a failed ``sleep``, the bodies of the batch have their former
        states. After a failed ``wake``, the bodies in ``woken`` are frozen. These bodies stay in ``woken``, so that the
        next update tries again.
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
        """Undo a batch that the port did not carry out: make ``asleep`` live, and freeze the bodies in ``woken``."""
        table = self._world.graph.bodies
        for row in asleep:
            unfreeze(self._world, row)
            table["unsettled"][row] = False
        for row in self.woken:
            table["state"][row] = FROZEN
