"""A port to a PyBullet world that the user owns.

Ids are PyBullet's body ids. The port controls free bodies without joints. All other bodies are obstacles: robots,
platforms, and bodies that the user leaves out. An obstacle, or a link of an obstacle, that touches a controlled body
counts as a body that the host moves. A plane counts as the ground.

Contacts: Bullet lists some points of a contact area, for example one point across a gap. The port adds the missing
corners of contact areas between boxes, cylinders, convex meshes and planes. The port uses the velocities after the
previous update as the velocities before a step. Therefore approach speeds are accurate if ``update`` follows each step.
If several steps make a frame, approach speeds lack the fall of the frame.

Bullet's own sleep is off for controlled bodies, because a sleeping body does not wake when its support leaves the
world.
"""

from __future__ import annotations

import operator
from collections.abc import Collection, Hashable, Iterable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pybullet

from stability_core.port import Contacts, FloatArray, IntArray, Masses
from stability_core.ports.pybullet_bodies import PybulletBodies
from stability_core.ports.pybullet_calls import Row, forces_of, freeze, geometry_of, pairs_of, unfreeze
from stability_core.ports.shared.approach import Motions, fastest_approach
from stability_core.ports.shared.body_motions import check_finite, motions_of, turned_bodies
from stability_core.ports.shared.free_flight import FreeFlight, check_steps
from stability_core.ports.shared.nothing import NO_CONTACTS, NO_MASSES
from stability_core.ports.shared.shapes import compile_kernels
from stability_core.ports.shared.vectors import rows_of

AWAKE = pybullet.ACTIVATION_STATE_DISABLE_SLEEPING
"""Activation state of a live body."""
_BASE = -1
_FRICTION = 1  # column of getDynamicsInfo
CALM_S = 1.0
"""Time [s] for which obstacles must have kept their places before the port omits them in frames without live bodies.
The core counts a body that the host has moved as ground after ``Settings.still_s``, 0.5 s, and must see the body until
then."""
NEAR = 1e-3
"""Greatest gap [m] at which ``find_contacts`` measures the distance of two bodies."""


def open_port(world: Any, bodies: Collection[int] | None) -> PybulletPort:
    """Return a port to a world of PyBullet.

    Args:
        world: client id, or a client object of ``pybullet_utils.bullet_client``.
        bodies: ids of the bodies to control; None for all bodies that can freeze.

    Raises:
        ValueError: if the client is not connected, a body cannot freeze, or ``bodies`` lists a body twice.
    """
    client = operator.index(getattr(world, "_client", world))
    if not pybullet.isConnected(client):
        raise ValueError(f"PyBullet client {client} is not connected: pass the id that pybullet.connect() returned")
    compile_kernels()
    return PybulletPort(client, bodies)


class PybulletPort:
    """The core's view of the free bodies of a PyBullet world."""

    engine = "pybullet"

    def __init__(self, client: int, bodies: Collection[int] | None) -> None:
        self.client = client
        self.world: Hashable = (self.engine, client)
        self._bodies = PybulletBodies(client, takes_all=bodies is None)
        self._before: Motions | None = None
        self._flight = FreeFlight()
        self._dt = 0.0
        self._gravity = (0.0, 0.0, 0.0)
        self._read_parameters()
        self._finds = False
        self._places: list[object] = []
        self._calm_s = 0.0
        self._ids: IntArray = np.empty(0, np.int64)
        self._rows: FloatArray = np.empty((0, 13))
        self._read = self._ids, self._rows  # in the latest frame with obstacles
        if bodies is not None:
            self.add(bodies)

    # -- called by the attachment ------------------------------------------------------------------

    def gravity(self) -> tuple[float, float, float]:
        """Return the world's gravity [m/s2], as the port has last read it."""
        return self._gravity

    def _read_parameters(self) -> dict[str, Any]:
        """Return the parameters of the engine, and record gravity.

        Raises:
            pybullet.error: if the client is closed.
        """
        shown: dict[str, Any] = pybullet.getPhysicsEngineParameters(physicsClientId=self.client)
        self._gravity = (
            shown["gravityAccelerationX"],
            shown["gravityAccelerationY"],
            shown["gravityAccelerationZ"],
        )
        return shown

    def begin_update(self, dt: float) -> list[int]:
        """Follow bodies that come and go, and check the time; return obstacles that have turned.

        Raises:
            ValueError: if the client is closed, PyBullet runs by its own clock, or the world contradicts ``dt``; if a
                pose or a velocity is not finite; if a body under control can no longer freeze.
        """
        try:
            shown = self._read_parameters()
        except pybullet.error as error:
            raise ValueError(
                f"PyBullet client {self.client} is no longer connected: call close() before pybullet.disconnect()"
            ) from error
        if shown["useRealTimeSimulation"]:
            raise ValueError(
                "PyBullet steps this world by its own clock, so that the time between two updates is unknown: call "
                "setRealTimeSimulation(0), and stepSimulation() before each update()"
            )
        check_steps(dt, shown["fixedTimeStep"], "PyBullet", "setTimeStep()")
        self._flight.check()
        self._dt = dt
        self._bodies.follow()
        self._audit_next()
        return self._read_motions()

    def add(self, bodies: Iterable[int]) -> None:
        """Control free bodies.

        Raises:
            ValueError: for a body that does not exist, is static, has joints, or is under control already.
        """
        for body in bodies:
            self._bodies.add(body)
            pybullet.changeDynamics(body, _BASE, activationState=AWAKE, physicsClientId=self.client)

    def remove(self, bodies: Iterable[int]) -> None:
        """Stop controlling bodies; frozen bodies become live first."""
        bodies = list(bodies)
        self.wake(bodies)
        for body in bodies:
            self._bodies.remove(body)

    def find_contacts(self) -> None:
        """Make the next ``contacts`` return the contacts of the present poses, without a change of the world."""
        self._finds = True

    # -- called by the core ------------------------------------------------------------------------

    def contacts(self) -> Contacts:
        """Return the contacts that touch a live body, or join a frozen body and an obstacle that can move.

        After ``find_contacts`` the result has the contacts of live bodies only. The port adds the missing corners of
        contact areas.
        """
        if not self._bodies.live and not self._bodies.movers:
            return NO_CONTACTS
        rows = self._found_rows() if self._finds else self._step_rows()
        self._finds = False
        listed = [(a, b, row) for row in rows if (pair := self._bodies.pair_of(row)) for a, b in [pair]]
        touching = {body for a, b, _ in listed for body in (a, b)}
        self._flight.note(self._bodies.live, touching, self._before, self._ids, self._rows, self._dt)
        if not listed:
            return Contacts.empty()
        a, b = pairs_of(listed)
        point, normal, separation = geometry_of(listed)
        approach = fastest_approach(self._before, a, b, point, normal)
        friction = np.array([self._friction_of(row) for _, _, row in listed])
        return self._bodies.shapes.completed(
            Contacts(a, b, point, normal, separation, approach, friction, forces_of(listed))
        )

    def masses(self) -> Masses:
        """Return the live bodies, and the obstacles of infinite mass.

        Without live bodies, the port omits obstacles that have kept their places for ``CALM_S``.

        Raises:
            ValueError: if a pose or a velocity is not finite.
        """
        ids, rows = self._ids, self._rows
        if not len(ids) and not self._bodies.live:
            self._before = None
            removed = self._bodies.take_removed()
            return replace(NO_MASSES, removed=removed) if removed else NO_MASSES
        if len(self._bodies.obstacles) + len(self._bodies.live) != len(ids):
            self._read_motions()  # an obstacle touches a body for the first time
            ids, rows = self._ids, self._rows
        mass = np.array([self._bodies.mass_of(body) for body in ids.tolist()])
        self._before = motions_of(ids, rows)
        return Masses(ids, mass, rows[:, :3], self._bodies.take_removed())

    def sleep(self, bodies: Sequence[int]) -> None:
        """Freeze bodies at their present poses; skip bodies that are not live."""
        for body in [body for body in bodies if body in self._bodies.live]:
            self._bodies.freeze(body)
            freeze(body, self.client)

    def wake(self, bodies: Sequence[int]) -> None:
        """Return frozen bodies to Bullet, at rest, with their former mass and inertia; skip other bodies.

        If the client is closed, the method does nothing.
        """
        bodies = [body for body in bodies if body in self._bodies.frozen]
        if not pybullet.isConnected(self.client):
            return
        for body in bodies:
            kept = self._bodies.unfreeze(body)
            unfreeze(body, self.client, kept.mass, AWAKE)
            if pybullet.getDynamicsInfo(body, _BASE, self.client)[2] != kept.inertia:
                pybullet.changeDynamics(body, _BASE, localInertiaDiagonal=kept.inertia, physicsClientId=self.client)
        if bodies:  # otherwise these bodies keep the gravity of their freeze
            self._read_parameters()
            pybullet.setGravity(*self._gravity, physicsClientId=self.client)

    # -- helpers -----------------------------------------------------------------------------------

    def _audit_next(self) -> None:
        """Compare one controlled body with Bullet, in turn, because a removed body's id may belong to a new body.

        Raises:
            ValueError: if the body has changed and can no longer freeze. The port then no longer controls the body.
        """
        for body in self._bodies.next_changed():
            self._bodies.remove(body)
            self.add([body])

    def _step_rows(self) -> Iterable[Row]:
        """Yield Bullet's contacts of the latest step, at least of live bodies and movers, without duplicates."""
        bodies = self._bodies
        movers = [*bodies.live, *bodies.movers]
        if 2 * len(movers) > bodies.count:
            yield from pybullet.getContactPoints(physicsClientId=self.client)
            return
        done: set[int] = set()
        for body in movers:
            for row in pybullet.getContactPoints(body, physicsClientId=self.client):
                if row[1] not in done and row[2] not in done:
                    yield row
            done.add(body)

    def _found_rows(self) -> Iterable[Row]:
        """Yield the closest points of the pairs with a live body at the present poses, up to a gap of ``NEAR``."""
        bodies, done = self._bodies, set()
        margin = np.full(3, NEAR)
        for body in bodies.live:
            done.add(body)
            low, high = pybullet.getAABB(body, _BASE, self.client)
            near = pybullet.getOverlappingObjects(low - margin, high + margin, self.client) or ()
            for other in {other for other, _ in near} - done:
                yield from pybullet.getClosestPoints(body, other, NEAR, physicsClientId=self.client)

    def _read_motions(self) -> list[int]:
        """Read poses and velocities of live bodies and obstacles; return the obstacles that have turned.

        Raises:
            ValueError: if a pose or a velocity is not finite.
        """
        live, obstacles = self._bodies.live, self._bodies.obstacles
        if self._keep_places() and not live:
            self._ids, self._rows = self._ids[:0], self._rows[:0]
            return []
        ids = np.array(sorted([*live, *obstacles]), np.int64)
        rows = rows_of([self._motion_of(body, *obstacles.get(body, (body, _BASE))) for body in ids.tolist()], 13)
        check_finite(ids, rows)
        turned = turned_bodies(obstacles, ids, rows, *self._read)
        self._ids, self._rows = self._read = ids, rows
        self._bodies.shapes.place(ids.tolist(), rows[:, :7])
        return turned

    def _keep_places(self) -> bool:
        """Return True without obstacles, or if no obstacle has moved for ``CALM_S``."""
        places = [self._place_of(key) for key in self._bodies.obstacles]
        self._calm_s = self._calm_s + self._dt if places == self._places else 0.0
        self._places = places
        return self._calm_s > CALM_S or not places

    def _place_of(self, key: int) -> object:
        """Return the pose of an obstacle as Bullet returns it."""
        body, link = self._bodies.obstacles[key]
        if link == _BASE:
            return pybullet.getBasePositionAndOrientation(body, self.client)
        return pybullet.getLinkState(body, link, physicsClientId=self.client)[:2]

    def _motion_of(self, _: int, body: int, link: int) -> tuple[float, ...]:
        """Return centre [m], quaternion (x, y, z, w), velocity [m/s] and spin [rad/s] of a body or a link."""
        if link == _BASE:
            pose = pybullet.getBasePositionAndOrientation(body, self.client)
            velocity = pybullet.getBaseVelocity(body, self.client)
            return (*pose[0], *pose[1], *velocity[0], *velocity[1])
        state = pybullet.getLinkState(body, link, computeLinkVelocity=1, physicsClientId=self.client)
        return (*state[0], *state[1], *state[6], *state[7])

    def _friction_of(self, row: Row) -> float:
        bodies = self._bodies
        return bodies.friction_of(row[1], row[3]) * bodies.friction_of(row[2], row[4])
