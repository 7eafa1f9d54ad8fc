"""The core's view of a simulation: ``EnginePort``, which completes the engine's contacts and tracks bodies.

The hook ``_contacts`` returns the engine's contacts. The port adds missing contacts from the bodies' shapes, poses and
velocities, with the same code for every engine:

1. Missing corners of contact areas, and pairs that nearly touch, unless the engine lists both (``near_contacts``). For
   a pair with a body that is no box, the port adds missing corners on every engine (``convex_contacts``).
2. Contacts between host-driven and frozen bodies, because most engines list no contacts of two bodies that forces do
   not move.
3. Pairs that will meet within the next frames, while any body is fast.

In adapters each fixed body has its own id, because the port completes the contacts of each body separately. The port
then replaces these ids by ``GROUND`` for the core.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import replace

import numpy as np

from adapters.hooks import EngineHooks, Pair
from adapters.shared.bodies import NO_FORCE
from adapters.shared.contact_completion import BoxTable, edges_of, joined
from adapters.shared.convex_contacts import ConvexContacts
from adapters.shared.live_pairs import contact_pairs, of_live
from adapters.shared.refusals import check_weldable
from adapters.shared.swept_contacts import HORIZON
from scenarios.model import Brick
from scenarios.solids import reach_of
from stability_core.port import GROUND, Contacts, FloatArray, IntArray, Masses
from stability_core.ports.shared.approach import fastest_approach

MAX_REST_OVERLAP = 1e-3
"""Greatest overlap [m] of a frozen brick with a driven body, in addition to the driven body's motion in a frame. The
value exceeds 0.4 mm, the greatest overlap that engines leave at rest."""

IMPACT_SPEED = 0.01
"""Loss of approach speed [m/s] in a frame that is an impact, because bodies at rest tremble more slowly."""

NO_CONTACTS, NOWHERE = Contacts.empty(), np.empty((0, 3))
"""Empty results for a world without live bodies, so that the port does not query the engine."""


class EnginePort:
    """The core's view of a simulation: contacts and masses, and methods that freeze and unfreeze bodies.

    ``join`` and ``part`` are optional. No policy of the core uses these two methods (ADR-0030).
    """

    def __init__(self, engine: EngineHooks) -> None:
        self._engine = engine
        self._bodies = engine.bodies
        self._boxes = BoxTable(engine.world.fixed)
        self._solids = ConvexContacts(engine.world)
        self._found: Contacts | None = None  # the result of find_contacts, until the next step
        self._joined: set[Pair] = set()

    # -- called by the core ------------------------------------------------------------------------

    def contacts(self) -> Contacts:
        """Return the contacts after the latest step, or after a later call of ``find_contacts``.

        Each contact touches a live body, or lies between a driven body and a frozen body.
        """
        driven, live = self._bodies.driven(), self._bodies.live
        if not live and not driven:
            return NO_CONTACTS
        if self._found is not None:
            return self._for_core(self._of_live(self._found))
        contacts = self._engine._contacts() if live else NO_CONTACTS
        if live and not self._engine.capabilities.near_contacts:
            contacts = self._completed(contacts)
        contacts = self._solids.completed(contacts, self._engine._poses)
        if driven:
            contacts = self._with_driven(contacts, driven)
        return self._for_core(self._with_approaching(contacts))

    def masses(self) -> Masses:
        """Return the live and moved bodies at their present positions, and the ids removed since the previous call.

        The mass of a moved body is infinite.
        """
        bodies, mass = self._bodies.live_rows()
        removed = self._bodies.take_removed()
        if self._bodies.moved:
            live, live_mass, bodies = bodies, mass, self._bodies.moving()
            mass = np.full(len(bodies), np.inf)
            mass[np.isin(bodies, live)] = live_mass
        return Masses(bodies, mass, self._engine._positions(bodies) if len(bodies) else NOWHERE, removed)

    def sleep(self, bodies: Sequence[int]) -> None:
        """Freeze bodies exactly at their present poses; skip bodies that are not live.

        Raises:
            KeyError: if a body is not in the world.
        """
        self._bodies.check_known(bodies)
        for body in bodies:
            if body in self._bodies.live:
                self.part_from_all(body)
                if body in self._bodies.steady:
                    self._engine._press(body, NO_FORCE)
                self._engine._freeze(body)
                self._bodies.freeze(body)
        self._place_boxes(bodies)

    def wake(self, bodies: Sequence[int]) -> None:
        """Unfreeze bodies, at rest; skip bodies that are not frozen.

        Raises:
            KeyError: if a body is not in the world.
        """
        self._bodies.check_known(bodies)
        for body in bodies:
            if body in self._bodies.frozen:
                self._engine._unfreeze(body)
                self._bodies.unfreeze(body)
        self._bodies.sort_live()

    def join(self, pairs: Iterable[Pair]) -> None:
        """Join pairs of live bodies: from the next step on, each pair keeps its present relative pose.

        The port skips pairs that are joined. The order of the pairs, and of the bodies in a pair, does not matter. A
        pair parts when one of its bodies is frozen, removed, or moved by the host.

        Raises:
            NotImplementedError: if the engine joins no bodies.
            KeyError: if a body is not in the world.
            ValueError: if a body is not live, or a pair has one body twice. Earlier pairs of the call stay joined.
        """
        check_weldable(self._engine.engine, self._engine.capabilities)
        for a, b in pairs:
            self._bodies.check_known((a, b))
            if a == b or a not in self._bodies.live or b not in self._bodies.live:
                raise ValueError(
                    f"join() needs pairs of two different live bodies, got {(a, b)}: unfreeze both bodies first, and "
                    "leave out pairs of one body, or with a body that the host moves"
                )
            pair = (min(a, b), max(a, b))
            if pair not in self._joined:
                self._engine._join(pair)
                self._joined.add(pair)

    def part(self, pairs: Iterable[Pair]) -> None:
        """Part joined pairs, so that their bodies move freely from the next step on; skip pairs that are not joined."""
        for a, b in pairs:
            pair = (min(a, b), max(a, b))
            if pair in self._joined:
                self._engine._part(pair)
                self._joined.remove(pair)

    # -- called by the simulation ------------------------------------------------------------------

    def add(self, body: int, brick: Brick) -> None:
        """Add a new body."""
        self._solids.add(body, brick)
        self._boxes.add(body, edges_of(brick))

    def part_from_all(self, body: int) -> None:
        """Part a body from all bodies to which it is joined."""
        if self._joined:
            self.part([pair for pair in self._joined if body in pair])

    def remove(self, body: int) -> None:
        """Remove a body."""
        self._solids.remove(body)
        self._boxes.remove(body)

    def note_move(self, body: int) -> None:
        """Delete the found contacts of a body that the host has moved, and place its box if the body is frozen."""
        if self._found is not None:
            self._found = self._found.chosen((self._found.body_a != body) & (self._found.body_b != body))
        if body in self._bodies.frozen:
            self._place_boxes([body])

    def find_contacts(self) -> None:
        """Detect the contacts at the present poses: see ``Simulation.find_contacts``."""
        self._found = None
        if not self._bodies.live:
            return
        found = self._engine._find_contacts()
        self._place_boxes(self._bodies.bricks)
        whole = self._solids.completed(self._with_exact_faces(found), self._engine._poses)
        velocity = self._velocities_at(whole.body_b, whole.point) - self._velocities_at(whole.body_a, whole.point)
        self._found = replace(whole, relative_velocity=velocity, force=None)

    def forget_found(self) -> None:
        """Discard the result of ``find_contacts``, so that ``contacts`` returns the contacts of the engine's steps."""
        self._found = None

    # -- contacts that an engine leaves out --------------------------------------------------------

    def _completed(self, contacts: Contacts) -> Contacts:
        """Add the corners and the nearly touching pairs that are missing in the engine's contacts."""
        live = self._place_boxes(self._bodies.live)
        if self._bodies.moved:
            self._place_boxes(self._bodies.moved)
        whole = self._with_joined(self._boxes.with_missing_corners(contacts))
        near = self._boxes.with_near_pairs(whole, live, self._engine.world.friction, self._velocities_at)
        return self._with_impacts(near, len(whole))

    def _with_joined(self, contacts: Contacts) -> Contacts:
        """Add the contacts of joined pairs that the engine does not collide, because they may overlap."""
        if not self._joined:
            return contacts
        rows = np.unique(np.array(list(self._joined)))
        found = self._boxes.with_near_pairs(
            NO_CONTACTS, rows, self._engine.world.friction, self._velocities_at, MAX_REST_OVERLAP
        )
        unlisted = self._joined - set(contact_pairs(contacts))
        return joined(contacts, found.chosen(np.array([pair in unlisted for pair in contact_pairs(found)], np.bool_)))

    def _with_impacts(self, contacts: Contacts, first: int) -> Contacts:
        """Return the contacts with the approach before the impact, for near pairs that met and parted in the frame.

        After an early substep has stopped a body, the engine may list no contact of its pair at the frame's end. The
        body's velocity then no longer shows the impact.

        Args:
            contacts: contacts of the frame.
            first: row of the first contact of a near pair; near pairs come last.
        """
        before = self._engine._motions_before()
        if before is None or first == len(contacts):
            return contacts
        near = contacts.chosen(np.arange(first, len(contacts)))
        earlier = fastest_approach(before, near.body_a, near.body_b, near.point, near.normal)
        closing = -np.einsum("ni,ni->n", earlier, near.normal)
        present = -np.einsum("ni,ni->n", near.relative_velocity, near.normal)
        has_met = (closing > present + IMPACT_SPEED) & (closing * self._engine.info.frame_s > near.separation)
        velocity = contacts.relative_velocity.copy()
        velocity[first:][has_met] = earlier[has_met]
        return replace(contacts, relative_velocity=velocity)

    def _with_driven(self, contacts: Contacts, driven: list[int]) -> Contacts:
        """Add the contacts between ``driven`` and frozen bodies.

        Points, normals and separations come from the boxes at their present poses. The greatest gap is the greatest
        distance that a point of a driven body moves in a frame.
        """
        rows = self._place_boxes(driven)
        linear, angular = self._engine.velocities_now(rows)
        reach = np.array([reach_of(self._bodies.bricks[body]) for body in driven])
        speed = np.linalg.norm(linear, axis=1) + reach * np.linalg.norm(angular, axis=1)
        way = float(speed.max()) * self._engine.info.frame_s
        deep, frozen = way + MAX_REST_OVERLAP, self._bodies.frozen
        found = self._boxes.with_near_pairs(NO_CONTACTS, rows, self._engine.world.friction, self._velocities_at, deep)
        is_with_frozen = [
            (a in frozen or b in frozen) and separation <= way
            for a, b, separation in zip(
                found.body_a.tolist(), found.body_b.tolist(), found.separation.tolist(), strict=True
            )
        ]
        return joined(contacts, found.chosen(np.array(is_with_frozen, np.bool_)))

    def _with_approaching(self, contacts: Contacts) -> Contacts:
        """Add the pairs of bodies that will meet within the next frames, if any body is fast."""
        movers = self._bodies.moving()
        velocity, _ = self._engine.velocities_now(movers)
        if not self._boxes.are_fast(movers, velocity):
            return contacts
        self._place_boxes(movers.tolist())
        seconds = HORIZON * self._engine.info.frame_s
        live, _ = self._bodies.live_rows()
        return self._boxes.with_approaching(contacts, live, movers, velocity, seconds, self._engine.world.friction)

    def _with_exact_faces(self, contacts: Contacts) -> Contacts:
        """Replace the contacts of pairs that nearly touch by contacts from the boxes' geometry."""
        return self._boxes.with_exact_faces(contacts, self._bodies.live_rows()[0], self._engine.world.friction)

    def _of_live(self, contacts: Contacts) -> Contacts:
        """Return the contacts that touch a live body and no removed body."""
        return of_live(contacts, self._bodies)

    def _for_core(self, contacts: Contacts) -> Contacts:
        """Set the friction of each pair, and replace the ids of fixed bodies by ``GROUND`` for the core."""
        pairs = self._engine.pair_friction
        if not pairs.is_uniform:
            contacts = replace(contacts, friction=pairs.of(contacts.body_a, contacts.body_b))
        if not self._engine.world.fixed:
            return contacts
        body_a, body_b = np.maximum(contacts.body_a, GROUND), np.maximum(contacts.body_b, GROUND)
        return replace(contacts, body_a=body_a, body_b=body_b)

    def _place_boxes(self, bodies: Collection[int]) -> IntArray:
        """Write the present poses of ``bodies`` into the table of boxes; return the ids, shape (k,)."""
        rows = np.fromiter(bodies, np.int64, len(bodies))
        self._boxes.place(rows, *self._engine._poses(rows))
        return rows

    def _velocities_at(self, bodies: IntArray, points: FloatArray) -> FloatArray:
        """Return velocities (k, 3) [m/s] of bodies (k,) at points (k, 3) [m]: 0 for the ground and frozen bodies."""
        live, moved = self._bodies.live, self._bodies.moved
        velocities = np.zeros(points.shape)
        rows = np.flatnonzero([body in live or body in moved for body in bodies.tolist()])
        linear, angular = self._engine.velocities_now(bodies[rows])
        velocities[rows] = linear + np.cross(angular, points[rows] - self._engine._positions(bodies[rows]))
        return velocities
