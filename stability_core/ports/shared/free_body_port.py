"""``FreeBodyPort``: a port to a user's world of free rigid bodies, for several engines.

Bodies that the port does not control are obstacles. An obstacle that touches a controlled body counts as a body that
the host moves. A half space counts as the ground. The port uses the velocities after the previous update as the
velocities before a step. Therefore approach speeds are accurate if ``update`` follows each step. If several steps make
a frame, approach speeds lack the fall of the frame.

The engines do not collide a frozen body with a kinematic body. The port therefore unfreezes the frozen bodies beside a
kinematic body that moves. The engine gives the normal forces. The changes of the bodies' momentum give
the friction forces.
"""

from __future__ import annotations

from collections.abc import Collection, Hashable, Iterable, Sequence
from dataclasses import replace

import numpy as np

from stability_core.port import Contacts, FloatArray, IntArray, Masses
from stability_core.ports.shared.approach import Motions, fastest_approach
from stability_core.ports.shared.body_motions import (
    CENTER,
    COLUMNS,
    POSE,
    SPIN,
    VELOCITY,
    check_finite,
    motions_of,
    rows_of_ids,
    turned_bodies,
)
from stability_core.ports.shared.free_bodies import FreeBodies
from stability_core.ports.shared.free_body_world import FreeBodyWorld, Vector
from stability_core.ports.shared.free_flight import FreeFlight, check_steps
from stability_core.ports.shared.friction_forces import Borne, with_friction
from stability_core.ports.shared.nothing import NO_CONTACTS, NO_MASSES
from stability_core.ports.shared.shapes import compile_kernels

CALM_S = 1.0
"""Time [s] for which obstacles must have kept their places before the port omits them in frames without live bodies.
The core counts a body that the host has moved as ground after ``Settings.still_s``, 0.5 s, and must see the body until
then."""


class FreeBodyPort:
    """The core's view of the free bodies of a world."""

    def __init__(self, world: FreeBodyWorld, identity: Hashable, bodies: Collection[int] | None) -> None:
        compile_kernels()
        self.engine = world.engine
        self.world = identity
        self._world = world
        self._bodies = FreeBodies(world, takes_all=bodies is None)
        self._before: Motions | None = None
        self._flight = FreeFlight()
        self._dt, self._calm_s = 0.0, 0.0
        self._finds = False
        self._obstacle_ids: IntArray = np.empty(0, np.int64)
        self._obstacle_poses: FloatArray = np.empty((0, 7))
        self._ids: IntArray = np.empty(0, np.int64)
        self._rows: FloatArray = np.empty((0, COLUMNS))
        self._bodies.follow()
        if bodies is not None:
            self.add(bodies)

    # -- called by the attachment ---------------------------------------------------------------------

    def gravity(self) -> Vector:
        """Return the world's gravity [m/s2]."""
        return self._world.gravity()

    def begin_update(self, dt: float) -> list[int]:
        """Follow the world, check the time, and return the bodies to wake.

        These bodies are obstacles that have turned, and frozen bodies beside a kinematic body that has moved.

        Raises:
            ValueError: if the world contradicts ``dt``, ``FreeBodyWorld.check`` fails, or a pose or a velocity is not
                finite. Without live bodies, the port makes the first two checks in the frames of looks only.
        """
        leaving = self._bodies.look(dt)
        if self._bodies.live or self._bodies.has_looked:
            check_steps(dt, self._world.step_s(), self.engine, self._world.setter)
            self._world.check()
            self._flight.check()
        self._dt = dt
        self.remove(leaving)
        return [*self._read_motions(), *self._bodies.beside_kinematic()]

    def add(self, bodies: Iterable[int]) -> None:
        """Control free bodies.

        Raises:
            ValueError: for a body that does not exist, cannot freeze, or is under control already.
        """
        self._bodies.add(bodies)

    def remove(self, bodies: Iterable[int]) -> None:
        """Stop controlling bodies; frozen bodies become live first. Skip bodies that are unknown to the port."""
        bodies = list(bodies)
        if bodies:
            self.wake(bodies)
            self._bodies.remove(bodies)

    def find_contacts(self) -> None:
        """Make the next ``contacts`` return the contacts of the present poses, without a change of the world."""
        self._finds = True

    # -- called by the core ---------------------------------------------------------------------------

    def contacts(self) -> Contacts:
        """Return the contacts that touch a live body, or join a frozen body and an obstacle that moves by forces.

        The port adds the missing corners of contact areas.
        """
        live, finds, self._finds = self._bodies.live, self._finds, False
        if not live and not self._bodies.movers:
            return NO_CONTACTS
        read = self._world.present_contacts if finds else self._world.step_contacts
        found = read(self._bodies.concerns, live.keys() | self._bodies.movers)
        a, b = self._bodies.sides(found.body_a), self._bodies.sides(found.body_b)
        self._flight.note(live, {*a.tolist(), *b.tolist()}, self._before, self._ids, self._rows, self._dt)
        if not len(a):
            return NO_CONTACTS
        point, normal, force = found.point, found.normal, found.force
        approach = fastest_approach(self._before, a, b, point, normal)
        if self._before is not None and self._dt > 0.0:
            force = with_friction((a, b), point, normal, force, found.friction, self._borne(self._before))
        contacts = Contacts(a, b, point, normal, found.separation, approach, found.friction, force)
        return self._bodies.shapes.completed(contacts)

    def masses(self) -> Masses:
        """Return the live bodies, the obstacles (of infinite mass), and frozen bodies that the host has moved.

        Without live and moved bodies, the port omits obstacles that have kept their places for ``CALM_S``.

        Raises:
            ValueError: if a pose or a velocity is not finite.
        """
        bodies, removed = self._bodies, self._bodies.take_removed()
        if bodies.has_new_obstacle:
            self._read_motions()
        ids, rows = self._with_movers()
        self._before = motions_of(ids, rows) if len(ids) else None
        if not len(self._ids):
            return replace(NO_MASSES, removed=removed) if removed else NO_MASSES
        mass = {**bodies.frozen, **bodies.live}
        masses = np.array([mass.get(body, np.inf) for body in self._ids.tolist()])
        return Masses(self._ids, masses, self._rows[:, CENTER], removed)

    def sleep(self, bodies: Sequence[int]) -> None:
        """Freeze bodies at their present poses; skip bodies that are not live."""
        for body in bodies:
            if body in self._bodies.live:
                self._bodies.freeze(body)

    def wake(self, bodies: Sequence[int]) -> None:
        """Return frozen bodies to the engine, at rest; skip other bodies, and bodies that have left the world."""
        if len(bodies):
            self._bodies.follow()
        for body in bodies:
            if body in self._bodies.frozen:
                self._bodies.unfreeze(body)

    # -- helpers --------------------------------------------------------------------------------------

    def _read_motions(self) -> list[int]:
        """Read the motions of live bodies, obstacles and moved frozen bodies; return the obstacles that have turned.

        Raises:
            ValueError: if a pose or a velocity is not finite.
        """
        live, obstacles, moved = self._bodies.live, self._bodies.obstacles, self._bodies.moved
        self._bodies.has_new_obstacle = False
        if not live and not moved and self._may_omit_obstacles():
            self._ids, self._rows = self._ids[:0], self._rows[:0]
            return []
        listed = sorted([*live, *obstacles, *moved])
        ids, rows = np.array(listed, np.int64), self._world.motions(listed)
        check_finite(ids, rows)
        turned: list[int] = []
        if obstacles:
            known = np.array([body in obstacles for body in listed], np.bool_)
            poses = rows[known, POSE]
            if not np.array_equal(poses, self._obstacle_poses):
                turned = turned_bodies(obstacles, ids[known], poses, self._obstacle_ids, self._obstacle_poses)
                self._obstacle_ids, self._obstacle_poses, self._calm_s = ids[known], poses, 0.0
            self._calm_s += self._dt
        self._ids, self._rows = ids, rows
        self._bodies.shapes.place(listed, rows[:, POSE])
        return turned

    def _may_omit_obstacles(self) -> bool:
        """Return True without obstacles, or if no obstacle has moved for ``CALM_S``.

        Without kinematic bodies and movers, the method reads the poses of obstacles in the frames of looks only.
        """
        bodies = self._bodies
        if not bodies.obstacles:
            return True
        if self._calm_s <= CALM_S:
            return False
        if not (bodies.has_looked or bodies.kinematic or bodies.movers):
            return True
        poses = self._world.motions(sorted(bodies.obstacles))[:, POSE]
        return np.array_equal(poses, self._obstacle_poses)

    def _with_movers(self) -> tuple[IntArray, FloatArray]:
        """Return the ids (n,) and motions (n, 13) of the bodies of ``_read_motions``, and of all movers."""
        movers = sorted(self._bodies.movers.difference(self._ids.tolist()))
        if not movers:
            return self._ids, self._rows
        ids = np.concatenate([self._ids, np.array(movers, np.int64)])
        order = np.argsort(ids)
        return ids[order], np.concatenate([self._rows, self._world.motions(movers)])[order]

    def _borne(self, before: Motions) -> Borne:
        """Return what the contacts of the live bodies of this and the previous frame bear, by their changed motion."""
        live = np.array([body in self._bodies.live for body in self._ids.tolist()], np.bool_)
        at, is_known = rows_of_ids(before.body, self._ids)
        rows = np.flatnonzero(live & is_known)
        bodies = self._ids[rows]
        mass = np.array([self._bodies.live[body] for body in bodies.tolist()], np.float64)
        linear = (self._rows[rows, VELOCITY] - before.linear[0, at[rows]]) / self._dt
        angular = (self._rows[rows, SPIN] - before.angular[0, at[rows]]) / self._dt
        force = mass[:, None] * (linear - np.array(self.gravity()))
        return Borne(bodies, force, self._rows[rows, CENTER], mass * np.linalg.norm(angular, axis=1))
