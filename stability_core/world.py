"""What an extension remembers of its world: the stack, the latest contacts, and the row of each body.

The port speaks of bodies by their ids, in the coordinates of its world; the kernels work on rows, in the upright frame.
Both are translated here.
"""

from __future__ import annotations

import operator
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from stability_core.checks import BAD_SHAPE, FINE, NO_ROOM, check_ids, check_shapes, fault_of
from stability_core.compiled import WrongTypeError
from stability_core.frame import observe
from stability_core.port import Contacts, IntArray, Masses
from stability_core.rows import find_rows, rows_for, take_row
from stability_core.settings import Settings
from stability_core.stack import BODY, FROZEN, NONE, drop_loads, drop_supports, empty_graph, grown
from stability_core.turning import turn_memory
from stability_core.upright import Upright
from stability_core.watch import forget_contacts, watch_for

_UNTOLD = np.zeros((0, 3))
"""In place of the contact forces of an engine that does not tell them."""
_IDS, _NUMBERS = np.dtype(np.int64), np.dtype(np.float64)


def _laid_out(array: Any, dtype: np.dtype[Any]) -> Any:
    """Return an array as the kernels are compiled for it, whatever an adapter reads; copied only if it must be."""
    contiguous = np.ascontiguousarray(array, dtype)
    return contiguous if contiguous.flags.writeable else contiguous.copy()


class World:
    """Tables that the kernels work on, and all that is needed to fill them from a port."""

    def __init__(self, settings: Settings, gravity: tuple[float, float, float]) -> None:
        """Args: settings: the tolerances; gravity: [m/s2], finite and not zero."""
        self.settings = settings
        self.upright = Upright(gravity)
        self.limits = settings.limits(self.upright.strength)
        self.graph = empty_graph()
        self.watch = watch_for(settings.longest_dwell, 32)
        self._rows = rows_for(0)
        self.ids: IntArray = self.graph.bodies["id"]
        """The body of each row, shape (rows,): a view of the table."""

    def rows_of(self, bodies: Iterable[int]) -> IntArray:
        """The rows of bodies that an update has seen, shape (k,).

        Raises:
            KeyError: naming those that none has.
        """
        wanted = np.array([operator.index(body) for body in bodies], np.int64)
        rows = self._find(wanted)
        if (rows < 0).any():
            unknown = ", ".join(map(str, wanted[rows < 0].tolist()))
            raise KeyError(f"unknown body {unknown}: no update has seen it")
        return rows

    def _find(self, ids: IntArray) -> IntArray:
        rows = np.empty(len(ids), np.int64)
        find_rows(self._rows.slots, ids, rows)
        return rows

    def observe(self, contacts: Contacts, masses: Masses, dt: float) -> tuple[int, int, int]:
        """Take over one frame; how many bodies are due, contacts kept, and frozen bodies listed.

        Raises:
            ValueError: for what the port gave, if it is malformed: nothing changes.
        """
        check_ids("masses.body", masses.body)
        check_ids("contacts.body_a", contacts.body_a)
        check_ids("contacts.body_b", contacts.body_b)
        room = 2 * len(contacts) + len(masses.body)
        if room >= self.watch.due.shape[1]:
            self.watch = watch_for(self.settings.longest_dwell, 2 * room, self.watch)
        seen, bodies = contacts, masses
        if not self.upright.is_world:
            check_shapes(contacts, masses)
            seen, bodies = self.upright.turn_contacts(contacts), self.upright.turn_masses(masses)
        while True:
            try:
                fault, row, due, kept = observe(
                    self.graph.bodies,
                    self._rows.slots,
                    self._rows.spare,
                    *self.watch,
                    self.limits,
                    dt,
                    _laid_out(bodies.body, _IDS),
                    _laid_out(seen.body_a, _IDS),
                    _laid_out(seen.body_b, _IDS),
                    _laid_out(bodies.mass, _NUMBERS),
                    _laid_out(bodies.center_of_mass, _NUMBERS),
                    _laid_out(seen.point, _NUMBERS),
                    _laid_out(seen.normal, _NUMBERS),
                    _laid_out(seen.separation, _NUMBERS),
                    _laid_out(seen.relative_velocity, _NUMBERS),
                    _laid_out(seen.friction, _NUMBERS),
                    _UNTOLD if seen.force is None else _laid_out(seen.force, _NUMBERS),
                )
            except WrongTypeError:  # an array has more or fewer dimensions
                check_shapes(contacts, masses)
                raise
            if fault != NO_ROOM:
                break
            self.graph = grown(self.graph, len(self.graph.bodies) + row, 0)
            self._rows = rows_for(len(self.graph.bodies), self._rows)
            self.ids = self.graph.bodies["id"]
        if fault == BAD_SHAPE:
            check_shapes(contacts, masses)
        if fault != FINE:
            raise fault_of(fault, row, contacts, masses)
        return due, kept, row

    def frozen_listed(self, masses: Masses) -> list[tuple[int, float, float]]:
        """The frozen bodies that a port lists: row, mass [kg], and how far [m] each is from where it was frozen."""
        rows = self._find(_laid_out(masses.body, _IDS))
        center = self.upright.turn_masses(masses).center_of_mass
        table = self.graph.bodies
        places = np.flatnonzero(table["state"][rows] == FROZEN)
        moved = np.linalg.norm(center[places] - table["center"][rows[places]], axis=1)
        return list(zip(rows[places].tolist(), masses.mass[places].tolist(), moved.tolist(), strict=True))

    def make_room(self, patches: int) -> None:
        """Have at least so many free rows for patches."""
        if patches > self.graph.spare.item(0):
            self.graph = grown(self.graph, 0, patches)

    def turn(self, gravity: tuple[float, float, float]) -> bool:
        """Turn all that is remembered, if gravity has changed by more than its tolerances; True if so."""
        settings, before = self.settings, self.upright
        if not before.differs(gravity, settings.gravity_tilt, settings.gravity_change):
            return False
        self.upright = Upright(gravity)
        self.limits = settings.limits(self.upright.strength)
        turn_memory(self.graph, self.watch, self.upright.rotation @ before.rotation.T, settings.level_tilt)
        return True

    def detach(self, row: int) -> None:
        """Forget what a body rests on, and what rests on it."""
        drop_supports(self.graph, row)
        drop_loads(self.graph, row)

    def forget(self, bodies: Sequence[int]) -> IntArray:
        """Drop bodies that left the world; returns the rows that they had, shape (k,).

        One that was never seen leaves nothing behind.
        """
        ids = np.array(bodies, np.int64)
        rows = self._find(ids)
        rows, ids = rows[rows >= 0], ids[rows >= 0]
        blank = np.zeros((), BODY)
        blank["first_support"] = blank["first_load"] = NONE
        for row, body in zip(rows.tolist(), ids.tolist(), strict=True):
            self.detach(row)
            blank["changed"] = self.graph.bodies["changed"][row]
            self.graph.bodies[row] = blank
            take_row(*self._rows, body)
        if len(rows):
            forget_contacts(self.graph.bodies, self.watch)
        return rows
