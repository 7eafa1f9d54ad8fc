"""Rapier: soft contacts in small substeps, in single precision.

Freezing: the adapter stops the body and makes it ``FIXED`` (``stability_core.ports.rapier_calls``).

Contacts: the adapter moves Rapier's points and normals with the bodies to the poses after the step, and measures the
separation there. Rapier also lists points within its prediction distance. The adapter omits points with a gap of more
than 0.1 mm. ``find_contacts`` detects collisions in a copy of the world.

Friction: the coefficient of a pair is the mean of both colliders' coefficients (as shipped). If a body has its own
coefficient, the pair has the geometric mean. All other colliders have the world's coefficient. The law is a cone, with
one constraint per manifold for sliding and one constraint for twist. (``FrictionModel.COULOMB``, with one constraint
per point, gives too little friction across a plank.)

Shapes: the axis of Rapier's cylinders is y. Therefore the adapter turns the collider of a cylinder in its body. While a
pair moves by less than 1 mm, Parry (Rapier's collision library) keeps the pair's points. Therefore a lying cylinder may
start to roll by itself. Parry uses at most four vertices of a face, so that a hexagonal prism stands on half of its
face, and rocks. Therefore the adapter cuts a polyhedron with such faces into pieces, as a compound collider.

Stiffness: contacts are springs. The sag under load is inversely proportional to the square of the springs' natural
frequency. The solver makes ``num_solver_iterations`` substeps per step, and resolves a frequency of up to a quarter of
the rate of these substeps.

Traps:

- While two bodies turn together, Rapier keeps the normal of their contacts in the world's frame. On a tilting platform
  a brick stuck at 30 deg, with a friction angle of 24 deg. The adapter makes Rapier detect the contacts of a turning
  moved body again in each step. Between live bricks that turn together the normals stay outdated.
- Many limits are multiples of ``length_unit``, for example the distance of predicted contacts and the greatest speed.
- Parry keeps a pair's points while they move by less than 1 mm. No setting changes this constant. Planks 0.78 mm thick
  topple from the second level on, and stand with ``scale=10``.
- Rapier silently resets a state that is not finite, and disables the body. The adapter then reports poses as NaN.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
import rapier3d

from adapters._rapier_contacts import in_bodies, in_world
from adapters._rapier_world import RapierWorld, knows
from adapters.hooks import Pair
from adapters.profile import Capabilities, KnobValue
from adapters.profile_files import load_settings
from adapters.shared.box_contacts import NEAR
from adapters.shared.contact_forces import SubstepForces
from adapters.shared.live_pairs import live_pairs
from adapters.shared.vectors import dot, rows_of, scalar_last
from adapters.substeps import SubstepSimulation
from scenarios.model import Brick, Quaternion, Vector
from stability_core.port import Contacts, FloatArray, IntArray
from stability_core.ports.rapier_calls import copy_of, freeze, local_points, stop, unfreeze
from stability_core.ports.rapier_rotation import settle_rotation

_SETTINGS = load_settings("rapier", knows)


class RapierSimulation(SubstepSimulation):
    """One world of Rapier."""

    engine = "rapier"
    profiles = _SETTINGS.profiles
    sleep_knobs = _SETTINGS.sleep_knobs
    knows_knob = staticmethod(_SETTINGS.knows)
    iterations = "num_solver_iterations"
    capabilities = Capabilities(
        contact_points="up to 8 points",
        near_contacts=True,
        separation=True,
        relative_velocity="from the velocities before the step",
        forces="normal, and friction by the bodies' momentum",
        freeze="fixed body",
        frozen_contacts=False,
        friction_law="cone",
        moved="kinematic",
        deterministic="across processes",
        shapes=("box", "cylinder", "capsule", "sphere", "polyhedron"),
        own_friction=True,
        restitution=True,
        own_moments=True,
        weld="a fixed joint",
    )

    def _open(self) -> None:
        self._engine = RapierWorld(self.world, self.info.profile)
        self._views = self._engine.views
        self._still_active: set[int] = set()  # frozen bodies that Rapier still processes in each step
        self._turning: set[int] = set()  # moved bodies that turned in the latest substep
        self._has_diverged = False
        for body, box in self._fixed_boxes():
            self._engine.add_fixed(body, box)

    def _read_knobs(self) -> Mapping[str, KnobValue]:
        return self._engine.read_knobs(self.info.profile.knobs)

    # -- bodies ---------------------------------------------------------------------------------------

    def _spawn(self, body: int, brick: Brick) -> None:
        self._engine.add_live(body, brick)

    def _spawn_moved(self, body: int, brick: Brick) -> None:
        self._engine.add_moved(body, brick)

    def _remove(self, body: int) -> None:
        self._still_active.discard(body)
        self._turning.discard(body)
        self._engine.remove(body)

    def _move(self, body: int, position: Vector, quaternion: Quaternion) -> None:
        view = self._views[body]
        view.position = rapier3d.Isometry3(position, scalar_last(quaternion))
        stop(view)
        view.wake_up()
        if body in self.frozen:
            settle_rotation(view)

    # -- actions --------------------------------------------------------------------------------------

    def _push(self, body: int, impulse: Vector) -> None:
        self._views[body].apply_impulse(impulse)

    def _press(self, body: int, force: Vector) -> None:
        view = self._views[body]
        view.reset_forces(True)
        view.add_force(force, True)

    def _drive(self, body: int, linear: Vector, angular: Vector, seconds: float) -> None:  # noqa: ARG002
        view = self._views[body]
        view.linvel, view.angvel = rapier3d.Vec3(*linear), rapier3d.Vec3(*angular)
        if any(angular) or body in self._turning:
            self._engine.find_anew(body)
            (self._turning.add if any(angular) else self._turning.discard)(body)

    def _set_gravity(self, gravity: Vector) -> None:
        self._engine.set_gravity(gravity)

    # -- time -----------------------------------------------------------------------------------------

    def _begin_frame(self, substep_s: float) -> None:
        if not self.bodies.live:
            for body in sorted(self._still_active):
                self._engine.replace_by_fixed(body, self.bricks[body])
            self._still_active.clear()
        self._engine.world.integration_parameters.dt = substep_s

    def _forces_of_substep(self) -> SubstepForces:
        listed = list(self._live_pairs(self._engine.world.narrow_phase))
        body_a, body_b = np.array([pair[:2] for pair in listed], np.int64).reshape(-1, 2).T
        impulses = rows_of([pair.total_impulse().to_tuple() for _, _, pair in listed], 3)
        return SubstepForces(body_a, body_b, impulses / self._substep_s)

    def _substep(self) -> None:
        self._engine.world.step()
        self._has_diverged |= not self._engine.world.quarantine.is_empty()

    # -- state ----------------------------------------------------------------------------------------

    def _poses(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]:
        views = [self._views[body] for body in bodies.tolist()]
        rows = rows_of([view.translation.to_tuple() + view.rotation.to_tuple() for view in views], 7)
        if self._has_diverged:
            rows[:] = np.nan
        return rows[:, :3], rows[:, [6, 3, 4, 5]]

    def _positions(self, bodies: IntArray) -> FloatArray:
        views = self._views
        return rows_of([views[body].translation.to_tuple() for body in bodies.tolist()], 3)

    def _velocities(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]:
        views = [self._views[body] for body in bodies.tolist()]
        rows = rows_of([view.linvel.to_tuple() + view.angvel.to_tuple() for view in views], 6)
        return rows[:, :3], rows[:, 3:]

    # -- called by the port ---------------------------------------------------------------------------

    def _freeze(self, body: int) -> None:
        freeze(self._views[body])
        self._still_active.add(body)

    def _unfreeze(self, body: int) -> None:
        self._still_active.discard(body)
        unfreeze(self._views[body])

    def _join(self, pair: Pair) -> None:
        self._engine.join(pair)

    def _part(self, pair: Pair) -> None:
        self._engine.part(pair)

    def _contacts(self) -> Contacts:
        return self._read_contacts(self._engine.world.narrow_phase)

    def _find_contacts(self) -> Contacts:
        copied = copy_of(self._engine.world)
        copied.detect_collisions()
        return self._read_contacts(copied.narrow_phase)

    # -- the end --------------------------------------------------------------------------------------

    def _close(self) -> None:
        self._engine.close()

    # -- helpers --------------------------------------------------------------------------------------

    def _read_contacts(self, narrow_phase: rapier3d.NarrowPhase) -> Contacts:
        pairs, local, impulses = local_points(self._live_pairs(narrow_phase))
        if not len(pairs):
            return Contacts.empty()
        local = in_bodies(pairs, local, self._engine.turned)
        normals, points_a, points_b = in_world(pairs, local, self._engine.fixed_poses, self._poses)
        separations = dot(points_b - points_a, normals)
        near = np.flatnonzero(separations <= NEAR * self.scale)
        point, normal = (points_a[near] + points_b[near]) / 2, normals[near]
        has_forces = self.reads_forces and self._substep_s
        force = normal * impulses[near, None] / self._substep_s if has_forces else None
        body_a, body_b = pairs[near].T
        return self._with_friction(self._contacts_of_step((body_a, body_b), point, normal, separations[near], force))

    def _live_pairs(self, narrow_phase: rapier3d.NarrowPhase) -> Iterator[tuple[int, int, rapier3d.ContactPair]]:
        """Yield bodies a and b, and the pair, of each pair of near colliders with a live body, without duplicates."""
        body_of, colliders = self._engine.body_of, self._engine.colliders
        return live_pairs(
            self.bodies,
            narrow_phase.contact_pairs,
            lambda body: narrow_phase.contact_pairs_with(colliders[body]),
            lambda pair: (body_of.get(pair.collider1), body_of.get(pair.collider2)),
        )
