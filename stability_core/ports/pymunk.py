"""A port to a pymunk space that the user owns.

The port controls dynamic bodies without joints. All other bodies are obstacles: static and kinematic bodies, bodies
with joints, and bodies that the user leaves out. The shapes of ``space.static_body`` are the ground. The port numbers
the bodies. The attachment's methods accept ``pymunk.Body``.

Plane: pymunk's axes x and y are the core's axes x and z. A contact point represents a line across the plane. The line
is as long as the reach of the smaller body, and the port lists both ends. The port keeps the units of the space,
because the core counts lengths in sizes of a body. Metre means the unit of the space, for example a pixel.

Contacts: Chipmunk lists overlapping pairs. Chipmunk lists no contact between a kinematic and a frozen body. Therefore
the port queries the shapes of kinematic and static bodies that have moved. Chipmunk lists an impact no earlier than in
the step of the impact. Therefore the port looks ahead of fast bodies. The port uses the velocities after the previous
update as the velocities before a step. If several steps make a frame, approach speeds lack the fall of the frame. While
all bodies are frozen, the port reads the space less often.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Hashable, Iterable, Sequence

import numpy as np
import pymunk

from stability_core.port import GROUND, BoolArray, Contacts, FloatArray, IntArray, Masses
from stability_core.ports.pymunk_bodies import PymunkBodies
from stability_core.ports.pymunk_checks import check_awake, check_finite, check_outside_step, check_time
from stability_core.ports.pymunk_contacts import Rows, lift_contacts
from stability_core.ports.pymunk_reader import Arbiters, SpaceReader, arbiters_of, at_centers
from stability_core.ports.pymunk_search import contacts_ahead, contacts_in_place, fast_rows
from stability_core.ports.shared.free_flight import FreeFlight
from stability_core.ports.shared.nothing import NO_CONTACTS, NO_MASSES

CALM_S = 1.0
"""Time [s] for which nothing must have moved before the port omits the obstacles. The core counts a body that the host
has moved as ground after ``Settings.still_s``, 0.5 s, and must see the body until then."""
LOOK_S = 0.05
"""Time [s] between two looks at the whole space while all controlled bodies are frozen and nothing moves. A look at a
hundred bodies costs more than Chipmunk's step of a hundred static bodies."""
_TURNED = 1e-4
"""Greatest change of an obstacle's angle [rad] without a turn."""


def open_port(world: pymunk.Space, bodies: Collection[pymunk.Body] | None) -> PymunkPort:
    """Return a port to a space of pymunk.

    Args:
        world: the space.
        bodies: the bodies to control; None for all bodies that can freeze.

    Raises:
        TypeError: if the world is no ``pymunk.Space``, or an object in ``bodies`` is no ``pymunk.Body``.
        ValueError: if Chipmunk's own sleeping is on, a body cannot freeze, ``bodies`` lists a body twice, or a pose or
            a velocity is not finite.
        RuntimeError: if the space is inside a step.
    """
    if not isinstance(world, pymunk.Space):
        raise TypeError(f"attach() needs pymunk's Space, got {type(world).__name__}: pass space = pymunk.Space()")
    return PymunkPort(world, bodies)


class PymunkPort:
    """The core's view of the free bodies of a pymunk space."""

    engine = "pymunk"

    def __init__(self, space: pymunk.Space, bodies: Collection[pymunk.Body] | None) -> None:
        self.space = space
        self.world: Hashable = (self.engine, id(space))
        check_outside_step(space, "attach()")
        check_awake(space)
        self._bodies = PymunkBodies(space, takes_all=bodies is None)
        self._reader = SpaceReader(space)
        self._flight = FreeFlight()
        self._flight_fault: str | None = None
        self._dt, self._finds, self._gravity = 0.0, False, space.gravity
        self._quiet_s = 0.0  # time for which nothing has moved
        self._look_s = math.inf  # time since the latest look that found nothing moved
        self._movers: list[int] = []
        self._known: set[int] = set()  # ids that the core knows
        self._dropped: list[int] = []  # ids that left in the latest update
        for planar in bodies or ():
            self._bodies.add(planar)
        self._bodies.follow()
        self._reader.assign(self._bodies.rows)
        self._state = self._earlier = self._read_state()
        self._touching = np.zeros(len(self._state), np.bool_)
        self._lifted(arbiters_of([], []), self._bodies.is_live, self._state[:, 3:])  # to compile now, not in a frame

    # -- called by the attachment ------------------------------------------------------------------

    def gravity(self) -> tuple[float, float, float]:
        """Return the space's gravity, as the port has last read it, along the core's axes and in the space's units."""
        x, y = self._gravity
        return x, 0.0, y

    def begin_update(self, dt: float) -> list[int]:
        """Follow bodies that come and go, and check the time; return frozen bodies that moved, and turned obstacles.

        While all bodies are at rest, the port reads and checks the space only after each ``LOOK_S``.

        Raises:
            ValueError: if the space contradicts ``dt``, Chipmunk's own sleeping is on, or a pose or a velocity is not
                finite.
            RuntimeError: if the space is inside a step.
        """
        check_outside_step(self.space, "update() or adopt()")
        bodies, ids, self._dt = self._bodies, self._bodies.ids, dt
        self._look_s += dt
        if 0.0 < dt <= self._look_s < LOOK_S and bodies.are_at_rest():
            self._quiet_s += dt
            return []
        check_awake(self.space)
        check_time(self.space, dt)
        self._gravity = self.space.gravity
        if self._flight_fault:
            fault, self._flight_fault = self._flight_fault, None
            raise ValueError(fault)
        if bodies.follow():
            self._follow_rows(ids)
        elif not (bodies.live or bodies.has_loose or self._reader.has_changed()):
            self._quiet_s, self._look_s = self._quiet_s + dt, 0.0
            self._movers.clear()
            return []
        self._quiet_s, self._look_s = 0.0, math.inf
        self._reader.note_change()
        self._state = state = self._read_state()
        change = state - self._earlier
        has_moved = change.any(axis=1)
        is_obstacle = ~(bodies.is_live | bodies.is_frozen)
        self._movers = np.flatnonzero(has_moved & is_obstacle & ~bodies.is_loose).tolist()
        turned = (has_moved & bodies.is_frozen) | (is_obstacle & (abs(change[:, 2]) > _TURNED))
        return [body for body in bodies.ids[turned].tolist() if body in self._known]

    def add(self, bodies: Iterable[pymunk.Body]) -> None:
        """Control dynamic bodies of the space.

        Raises:
            TypeError: for an object that is no body.
            ValueError: for a body that is not in the space, has joints, is static or kinematic, or is under control
                already.
        """
        for planar in bodies:
            self._bodies.add(planar)
        self._refresh()

    def remove(self, bodies: Iterable[int]) -> None:
        """Stop controlling bodies; frozen bodies become live first.

        Raises:
            KeyError: for an id that is not in the space.
            RuntimeError: if the space is inside a step.
        """
        check_outside_step(self.space, "remove()")
        self._bodies.leave_out(bodies)
        self._refresh()

    def find_contacts(self) -> None:
        """Make the next ``contacts`` return the contacts of the present poses, without a change of the space."""
        self._finds = True

    def id_of(self, body: pymunk.Body) -> int:
        """Return the id of a body.

        Raises:
            KeyError: if the body is not in the space, or is ``space.static_body``.
        """
        if body not in self._bodies.id_of and isinstance(body, pymunk.Body) and body.space is self.space:
            self._refresh()  # find the bodies that came after the latest update
        if body not in self._bodies.id_of:
            raise KeyError(
                f"{body!r} has no id in this pymunk space: pass a pymunk.Body that space.add(body, shape) has added"
            )
        return self._bodies.id_of[body]

    def body_of(self, body: int) -> pymunk.Body:
        """Return the body of an id.

        Raises:
            KeyError: if no body in the space has this id.
        """
        return self._bodies.body_of(body)

    # -- called by the core ------------------------------------------------------------------------

    def contacts(self) -> Contacts:
        """Return the contacts that touch a live body, or join a frozen body and an obstacle that moves.

        The contacts include coming impacts of fast bodies on frozen bodies: see ``contacts_ahead``.
        """
        bodies, finds, self._finds = self._bodies, self._finds, False
        if not (bodies.live or bodies.has_loose or self._movers):
            return NO_CONTACTS
        selected, earlier = bodies.is_live | bodies.is_loose, self._earlier[:, 3:]
        lists = []
        if bodies.live or bodies.has_loose:
            listed = contacts_in_place(self.space, bodies) if finds else self._reader.arbiters()
            lists.append((listed, selected, earlier))
        if self._movers and bodies.frozen:
            queried = self._reader.query(bodies.rows[row] for row in self._movers)
            lists.append((queried, bodies.is_frozen, earlier))
        if bodies.frozen and len(fast := fast_rows(bodies, self._state, self._dt)):
            ahead = contacts_ahead(self.space, bodies, fast, self._state, self._dt)
            lists.append((ahead, bodies.is_frozen, self._state[:, 3:]))
        if not lists:
            return NO_CONTACTS
        lifted = [self._lifted(*part) for part in lists]
        columns = lifted[0] if len(lifted) == 1 else [np.concatenate(part) for part in zip(*lifted, strict=True)]
        is_controlled = bodies.is_live | bodies.is_frozen
        if bodies.has_loose:
            rows = np.flatnonzero(is_controlled[columns[0]].any(axis=1))
            columns = [part[rows] for part in columns]
        pairs, points, normals, separations, velocities = columns
        a, b = pairs[:, 0], pairs[:, 1]
        self._note_flight(pairs)
        bodies.touched.update(bodies.ids[pairs[~is_controlled[pairs]]].tolist())
        bodies.touched.discard(GROUND)
        friction = bodies.friction[a] * bodies.friction[b]
        return Contacts(bodies.ids[a], bodies.ids[b], points, normals, separations, velocities, friction)

    def masses(self) -> Masses:
        """Return the live bodies, and the obstacles of infinite mass that have touched a controlled body.

        The port omits the obstacles once nothing has moved for ``CALM_S``.
        """
        bodies = self._bodies
        is_calm = self._quiet_s > CALM_S or not (bodies.live or bodies.touched or self._dropped)
        if is_calm and not bodies.has_news():
            self._earlier = self._state
            return NO_MASSES
        rows = np.flatnonzero(bodies.is_live)
        if bodies.touched:
            rows = np.union1d(rows, bodies.rows_of(bodies.touched)).astype(np.int64)
        removed, ids = bodies.take_removed(), bodies.ids[rows]
        self._earlier = self._state
        self._known.update(ids.tolist())
        self._known.difference_update(removed, self._dropped)
        self._dropped = removed
        centers = np.zeros((len(rows), 3))
        centers[:, ::2] = self._state[rows, :2]
        return Masses(ids, bodies.mass[rows], centers, removed)

    def sleep(self, bodies: Sequence[int]) -> None:
        """Freeze bodies at their present poses; skip bodies that are not live.

        Raises:
            RuntimeError: if the space is inside a step.
        """
        check_outside_step(self.space, "update()")
        for row in self._bodies.rows_of(bodies):
            if self._bodies.is_live[row]:
                self._bodies.freeze(row)
                self._state[row, 3:] = 0.0

    def wake(self, bodies: Sequence[int]) -> None:
        """Return frozen bodies to pymunk, at rest unless the user has set a velocity; skip other bodies.

        Raises:
            RuntimeError: if the space is inside a step.
        """
        check_outside_step(self.space, "wake() or close()")
        for row in self._bodies.rows_of(bodies):
            if self._bodies.is_frozen[row]:
                self._bodies.unfreeze(row)

    # -- helpers -----------------------------------------------------------------------------------

    def _refresh(self) -> None:
        ids = self._bodies.ids
        self._bodies.refresh()
        self._follow_rows(ids)
        self._state = self._read_state()

    def _follow_rows(self, ids: IntArray) -> None:
        """Carry the earlier states from the rows of ``ids`` to the present rows; a new body has its present state."""
        self._reader.assign(self._bodies.rows)
        earlier, touching = self._earlier, self._touching
        self._earlier = self._read_state()
        self._touching = np.ones(len(self._earlier), np.bool_)
        new = np.isin(self._bodies.ids, ids)
        old = np.isin(ids, self._bodies.ids)
        self._earlier[new], self._touching[new] = earlier[old], touching[old]

    def _read_state(self) -> FloatArray:
        """Return centre of mass (2), angle, velocity (2) and spin of each row in units of the space, shape (rows, 6).

        Raises:
            ValueError: if a number is not finite.
        """
        state = self._reader.state()
        check_finite(self._bodies.rows, state)
        return at_centers(state, self._bodies.centers)

    def _lifted(self, arbiters: Arbiters, selected: BoolArray, velocities: FloatArray) -> Rows:
        """Return the contacts of arbiters in three dimensions, with approaches by ``velocities`` (rows, 3).

        See ``lift_contacts``.
        """
        known = self._reader.engine_ids, self._reader.ids
        before = np.ascontiguousarray(velocities[None])
        return lift_contacts(*known, *arbiters, selected, 0, self._state, before, self._bodies.depths, 1.0)

    def _note_flight(self, pairs: IntArray) -> None:
        """Check ``dt`` by the live bodies without contacts in this and the previous frame.

        The next ``begin_update`` raises an error if ``dt`` contradicts their motion.
        """
        touching = np.zeros(len(self._state), np.bool_)
        touching[pairs] = True
        flying = self._bodies.is_live & ~touching & ~self._touching
        self._touching = touching
        if self._dt <= 0.0 or not flying.any():
            return
        way = self._state[:, :2] - self._earlier[:, :2]
        before, now = self._earlier[:, 3:5], self._state[:, 3:5]
        self._flight_fault = self._flight.fault(self._bodies.ids, flying, way, before, now, self._dt)
