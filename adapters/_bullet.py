"""PyBullet: Bullet's sequential impulses, on rigid bodies in maximal coordinates or, as shipped, on multibodies.

Freezing: the adapter stops the body, sets its mass to 0 and its activation state to asleep. The body is then static:
nothing moves it by a single bit. Bullet does not collide two frozen bodies, but may still list their earlier contacts.
Unfreezing restores the mass, and Bullet then computes inertia and gravity again. Bullet applies no gravity to a body
created with mass 0. Therefore the adapter creates every brick with its mass.

Contacts: Bullet reports the contacts that the latest step solved, detected at the poses before that step. Bullet lists
penetrating points only, often three of a face's four corners. The port adds the missing corners. Bullet reports no
approach speed, so that ``SubstepSimulation`` records the pose and the velocity of every live body before each substep.

``find_contacts`` runs ``performCollisionDetection`` in a second world with the same bodies and changes nothing in the
first. In the first world the call would refresh Bullet's cached points. This refresh displaced a falling pile by 10 mm
after 1 s. The second world has no cached points. Therefore ``find_contacts`` may list other corners than the next step
solves.

Friction: the coefficient of a pair is the product of both bodies' coefficients. Therefore the adapter gives each body
the square root of its own coefficient, or of the world's coefficient if the body has none. The law is a cone.
Restitution follows the same rule.

Shapes: Bullet gives a capsule and a convex hull the inertia of a box. Therefore the adapter sets the inertia, together
with the mass, because the inertia alone makes the next pose NaN. The adapter sets the margin of a hull to 0, because
Bullet would add 1 mm around its vertices.

Traps:

- The ground is a box, because on a plane Bullet needs ten steps to detect four contact points.
- Bullet reuses the handles of removed bodies.
- ``numSubSteps`` divides the reported forces, so that the adapter makes the substeps one by one.
- The engine's own sleep does not end when the host removes a support. The adapter cannot set the speed threshold of
  this sleep (between 0.2 and 0.3 m/s, for 2 s), because ``sleepThreshold`` works on multibodies only. The profile
  ``default`` keeps multibodies, PyBullet's standard. Multibodies stack worse than rigid bodies, and have a damping of
  0.04.
- A moved body is heavy, not kinematic. The adapter disables its collisions with the ground and with fixed, frozen and
  other moved bodies, because these collisions would stop the moved body.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import partial

from adapters._bullet_world import KNOBS, BulletWorld
from adapters.hooks import Pair
from adapters.profile import Capabilities, KnobValue
from adapters.profile_files import load_settings
from adapters.shared.contact_forces import SubstepForces
from adapters.shared.live_pairs import live_pairs
from adapters.shared.quiet_import import silenced_stderr
from adapters.shared.vectors import rows_of, scalar_last
from adapters.substeps import SubstepSimulation
from scenarios.model import Brick, Quaternion, Vector
from stability_core.port import GROUND, Contacts, FloatArray, IntArray

with silenced_stderr():
    import pybullet

    from stability_core.ports.pybullet_calls import Listed, forces_of, geometry_of, pairs_of, unfreeze

_SETTINGS = load_settings("bullet", KNOBS.__contains__)


class BulletSimulation(SubstepSimulation):
    """A world of PyBullet in DIRECT mode."""

    engine = "bullet"
    profiles = _SETTINGS.profiles
    knows_knob = staticmethod(_SETTINGS.knows)
    iterations = "numSolverIterations"
    capabilities = Capabilities(
        contact_points="up to 4 points",
        near_contacts=False,
        separation=True,
        relative_velocity="from the velocities before the step",
        forces="normal and friction",
        freeze="mass 0 and asleep",
        frozen_contacts=True,
        friction_law="cone",
        moved="a heavy body whose velocity is set before each step",
        deterministic="across processes",
        shapes=("box", "cylinder", "capsule", "sphere", "polyhedron"),
        own_friction=True,
        restitution=True,
        own_moments=True,
        weld="three point-to-point constraints",
    )

    def _open(self) -> None:
        if self.info.sleeping == "raised":
            raise NotImplementedError(
                "policy 'raised' needs a sleep threshold that the adapter can raise, but PyBullet sets the threshold "
                "on multibodies only: use policy 'none' or 'native', or sleeping='off' or 'native'"
            )
        self._engine = BulletWorld(self.world, self.info)
        self._client = self._engine.client
        self._handles = self._engine.handles
        self._has_old_gravity: set[int] = set()
        self._islands: Sequence[Mapping[str, float]] = ()  # the solver's report on the latest step
        for body, box in self._fixed_boxes():
            self._engine.add_fixed(body, box)

    def _read_knobs(self) -> Mapping[str, KnobValue]:
        return self._engine.read_knobs(self.info.profile.knobs)

    # -- bodies ---------------------------------------------------------------------------------------

    def _spawn(self, body: int, brick: Brick) -> None:
        self._engine.add_live(body, brick)

    def _spawn_moved(self, body: int, brick: Brick) -> None:
        self._engine.add_moved(body, brick)
        for handle, other in self._engine.body_of.items():
            if other <= GROUND or other in self.bodies.moved or other in self.frozen:
                self._engine.let_collide(self._handles[body], handle, do=False)

    def _remove(self, body: int) -> None:
        self._has_old_gravity.discard(body)
        self._engine.remove(body)

    def _move(self, body: int, position: Vector, quaternion: Quaternion) -> None:
        handle = self._handles[body]
        if body not in self.frozen:
            self._engine.wake(handle)
        pybullet.resetBasePositionAndOrientation(handle, position, scalar_last(quaternion), self._client)
        self._engine.stop(handle)

    # -- actions --------------------------------------------------------------------------------------

    def _push(self, body: int, impulse: Vector) -> None:
        handle = self._handles[body]
        (vx, vy, vz), angular = pybullet.getBaseVelocity(handle, self._client)
        mass = self.bricks[body].mass
        linear = (vx + impulse[0] / mass, vy + impulse[1] / mass, vz + impulse[2] / mass)
        self._engine.wake(handle)
        pybullet.resetBaseVelocity(handle, linear, angular, self._client)

    def _press(self, body: int, force: Vector) -> None:
        handle, frame = self._handles[body], pybullet.WORLD_FRAME
        if self.info.sleeping != "off":
            self._engine.wake(handle)
        place, _ = pybullet.getBasePositionAndOrientation(handle, self._client)
        pybullet.applyExternalForce(handle, -1, force, place, frame, self._client)

    def _drive(self, body: int, linear: Vector, angular: Vector, seconds: float) -> None:  # noqa: ARG002
        handle = self._handles[body]
        self._engine.cancel_gravity(handle, self.world.gravity)
        pybullet.resetBaseVelocity(handle, linear, angular, self._client)

    def _set_gravity(self, gravity: Vector) -> None:
        for body in self.bodies.live:
            self._engine.wake(self._handles[body])
        self._engine.set_gravity(gravity)
        self._has_old_gravity |= set(self.frozen)

    # -- time -----------------------------------------------------------------------------------------

    def _begin_frame(self, substep_s: float) -> None:
        self._engine.set_step(substep_s)

    def _forces_of_substep(self) -> SubstepForces:
        listed = self._listed()
        return SubstepForces(*pairs_of(listed), forces_of(listed))

    def _substep(self) -> None:
        self._islands = pybullet.stepSimulation(self._client)

    def _solver_iterations(self) -> int:
        return int(max((island["numIterationsUsed"] for island in self._islands), default=0))

    # -- state ----------------------------------------------------------------------------------------

    def _poses(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]:
        read, client, handles = pybullet.getBasePositionAndOrientation, self._client, self._handles
        rows = rows_of([sum(read(handles[body], client), ()) for body in bodies.tolist()], 7)
        return rows[:, :3], rows[:, [6, 3, 4, 5]]

    def _positions(self, bodies: IntArray) -> FloatArray:
        read, client, handles = pybullet.getBasePositionAndOrientation, self._client, self._handles
        return rows_of([read(handles[body], client)[0] for body in bodies.tolist()], 3)

    def _velocities(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]:
        read, client, handles = pybullet.getBaseVelocity, self._client, self._handles
        rows = rows_of([sum(read(handles[body], client), ()) for body in bodies.tolist()], 6)
        return rows[:, :3], rows[:, 3:]

    # -- called by the port ---------------------------------------------------------------------------

    def _freeze(self, body: int) -> None:
        handle = self._handles[body]
        self._engine.freeze(handle)
        for other in self.bodies.moved:  # heavy, not kinematic: the brick would stop it, and be kicked when unfrozen
            self._engine.let_collide(self._handles[other], handle, do=False)

    def _unfreeze(self, body: int) -> None:
        handle = self._handles[body]
        brick = self.bricks[body]
        unfreeze(handle, self._client, brick.mass, self._engine.awake)
        self._engine.restore_inertia(handle, brick)
        for other in self.bodies.moved:
            self._engine.let_collide(self._handles[other], handle, do=True)
        if body in self._has_old_gravity:  # Bullet changes the gravity of active bodies only
            self._has_old_gravity.remove(body)
            self._engine.set_gravity(self.world.gravity)

    def _join(self, pair: Pair) -> None:
        self._engine.join(pair, math.hypot(*self.bricks[pair[0]].size) / 4)
        if all(self.bricks[body].shape == "box" for body in pair):  # whose contacts the port adds
            self._let_collide(pair, do=False)

    def _part(self, pair: Pair) -> None:
        self._engine.part(pair)
        self._let_collide(pair, do=True)

    def _contacts(self) -> Contacts:
        listed = self._listed()
        if not listed:
            return Contacts.empty()
        force = forces_of(listed) if self.reads_forces else None
        return self._contacts_of_step(pairs_of(listed), *geometry_of(listed), force)

    def _find_contacts(self) -> Contacts:
        twin = self._twin()
        try:
            pybullet.performCollisionDetection(twin._client)
            return twin._contacts()
        finally:
            twin.close()

    # -- the end --------------------------------------------------------------------------------------

    def _close(self) -> None:
        self._engine.close()

    # -- helpers --------------------------------------------------------------------------------------

    def _let_collide(self, pair: Pair, *, do: bool) -> None:
        """Set whether a pair collides.

        Joint and contact together make a stack at rest tremble, by 0.02 to 0.2 mm/s in ``tuned``.
        """
        self._engine.let_collide(*(self._handles[body] for body in pair), do=do)

    def _listed(self) -> list[Listed]:
        """Return every contact that touches a live body, without duplicates: bodies a and b, and Bullet's row."""
        body_of, handles = self._engine.body_of, self._handles
        read = partial(pybullet.getContactPoints, physicsClientId=self._client)
        pairs = live_pairs(
            self.bodies, read, lambda body: read(handles[body]), lambda row: (body_of[row[1]], body_of[row[2]])
        )
        return list(pairs)
