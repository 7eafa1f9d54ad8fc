"""An extension's memory of its world: the stack, the latest contacts, and the row of each body.

The port uses ids of bodies and world coordinates. The kernels use rows and upright coordinates. This module translates
between both.
"""

from __future__ import annotations

import operator
from collections.abc import Iterable, Sequence

import numpy as np

from stability_core.compiled import WrongTypeError
from stability_core.frame import observe
from stability_core.frame_arrays import IDS, NO_FORCES, NUMBERS, laid_out
from stability_core.frame_buffers import buffers_for, forget_contacts
from stability_core.manifold import count_faces
from stability_core.port import Contacts, IntArray, Masses
from stability_core.rows import find_rows, rows_for, take_row
from stability_core.settings import Settings
from stability_core.stack import BODY, FROZEN, NONE, drop_loads, drop_supports, empty_graph, grown
from stability_core.turning import turn_memory
from stability_core.upright import Upright
from stability_core.validation import BAD_SHAPE, FINE, NO_ROOM, check_ids, check_shapes, fault_of

PATCHES_OF_A_FACE = 4
"""Greatest number of patches that a frame builds for a face: for either body of a pair, as a live body and again as a
frozen body."""


class World:
    """The core's tables, buffers and limits, which the kernels fill from a port."""

    def __init__(self, settings: Settings, gravity: tuple[float, float, float]) -> None:
        """Create an empty world.

        Args:
            settings: the tolerances.
            gravity: gravity vector [m/s2], finite and not zero.
        """
        self.settings = settings
        self.upright = Upright(gravity)
        self.limits = settings.limits(self.upright.strength)
        self.graph = empty_graph()
        self.buffers = buffers_for(settings.longest_dwell, 32)
        self._rows = rows_for(0)
        self.ids: IntArray = self.graph.bodies["id"]
        """Id of the body in each row, shape (rows,): a view of the table."""

    def rows_of(self, bodies: Iterable[int]) -> IntArray:
        """Return the rows of bodies that the port has listed and not removed, shape (k,).

        Raises:
            KeyError: for other bodies. The message names these bodies.
        """
        wanted = np.array([operator.index(body) for body in bodies], np.int64)
        rows = self._find(wanted)
        if (rows < 0).any():
            unknown = ", ".join(map(str, wanted[rows < 0].tolist()))
            raise KeyError(
                f"unknown body {unknown}: masses() must list each body before a call names the body, and not as "
                "removed; list the body in masses(), and call update() first"
            )
        return rows

    def _find(self, ids: IntArray) -> IntArray:
        rows = np.empty(len(ids), np.int64)
        find_rows(self._rows.slots, ids, rows)
        return rows

    def observe(self, contacts: Contacts, masses: Masses, dt: float) -> tuple[int, int, int]:
        """Read one frame, and return the numbers of entries of the worklist, kept contacts, and listed frozen bodies.

        Raises:
            ValueError: if the port's arrays are malformed. In this case no body changes.
        """
        check_ids("masses.body", masses.body)
        check_ids("contacts.body_a", contacts.body_a)
        check_ids("contacts.body_b", contacts.body_b)
        room = 2 * len(contacts) + len(masses.body)
        if room >= self.buffers.worklist.shape[1]:
            self.buffers = buffers_for(self.settings.longest_dwell, 2 * room, self.buffers)
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
                    *self.buffers,
                    self.limits,
                    dt,
                    laid_out(bodies.body, IDS),
                    laid_out(seen.body_a, IDS),
                    laid_out(seen.body_b, IDS),
                    laid_out(bodies.mass, NUMBERS),
                    laid_out(bodies.center_of_mass, NUMBERS),
                    laid_out(seen.point, NUMBERS),
                    laid_out(seen.normal, NUMBERS),
                    laid_out(seen.separation, NUMBERS),
                    laid_out(seen.relative_velocity, NUMBERS),
                    laid_out(seen.friction, NUMBERS),
                    NO_FORCES if seen.force is None else laid_out(seen.force, NUMBERS),
                )
            except WrongTypeError:  # an array has more or fewer dimensions than required
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
        """Return the row, the mass [kg], and the distance [m] from the frozen position of each listed frozen body."""
        rows = self._find(laid_out(masses.body, IDS))
        center = self.upright.turn_masses(masses).center_of_mass
        table = self.graph.bodies
        places = np.flatnonzero(table["state"][rows] == FROZEN)
        moved = np.linalg.norm(center[places] - table["center"][rows[places]], axis=1)
        return list(zip(rows[places].tolist(), masses.mass[places].tolist(), moved.tolist(), strict=True))

    def make_room(self, contacts: int) -> None:
        """Provide enough free rows for the patches of the kept ``contacts``.

        A face has at most ``PATCHES_OF_A_FACE`` patches at a time. The number of contacts bounds the number of faces,
        and the exact count of the faces comes only if that bound exceeds the free rows.
        """
        if PATCHES_OF_A_FACE * contacts <= self.graph.spare.item(0):
            return
        faces = count_faces(self.buffers, self.settings.face_angle)
        self.graph = grown(self.graph, 0, PATCHES_OF_A_FACE * faces)

    def turn(self, gravity: tuple[float, float, float]) -> bool:
        """Turn the memory if gravity has changed by more than its tolerances, and return True in this case."""
        settings, before = self.settings, self.upright
        if not before.differs(gravity, settings.gravity_tilt, settings.gravity_change):
            return False
        self.upright = Upright(gravity)
        self.limits = settings.limits(self.upright.strength)
        turn_memory(self.graph, self.buffers, self.upright.rotation @ before.rotation.T, settings.level_tilt)
        return True

    def detach(self, row: int) -> None:
        """Remove all patches of a body: on its supports, and of its loads."""
        drop_supports(self.graph, row)
        drop_loads(self.graph, row)

    def forget(self, bodies: Sequence[int]) -> IntArray:
        """Drop bodies that left the world, and return their former rows, shape (k,).

        The method ignores unknown bodies.
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
            forget_contacts(self.graph.bodies, self.buffers)
        return rows
