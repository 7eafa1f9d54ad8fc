"""DART: a skeleton of one shape on a free joint for every brick, and one boxed LCP for the forces of all contacts.

An LCP is a linear complementarity problem. A boxed LCP also has bounds for the unknown forces.

Mechanisms:

- Freeze: an immobile skeleton (``stability_core.ports.dart_calls``), which costs almost nothing.
- Contacts: a step of DART collides first, then solves, then moves, so that the contacts belong to the poses before the
  latest substep.
- Friction: the coefficient of a pair is the smaller of both bodies' coefficients, and every body has the world's
  coefficient. The law is a box: along the diagonal of the two tangents, friction reaches sqrt(2) times its bound along
  a tangent. DART chooses the tangents: no call in Python turns the tangents, but a small tilt of the normal may turn
  them.
- Approach speed: DART reports no approach speed. The adapter records the velocities before each substep and reports the
  fastest approach.
- ``find_contacts`` collides the bodies of the world and stores the contacts in a separate result. DART's collision
  detection stores nothing between steps, so that the call changes nothing. The steps after a call still agree with the
  steps of a world without the call only within the solver's repeatability (see below).

Traps:

- As shipped DART keeps at most 1000 contacts of all pairs together. ``_dart_limits`` raises the limit.
- A penetration shrinks at a speed of at most 1 mm/s. Below a depth of 0.4 mm, the penetration shrinks by a hundredth of
  the depth in a step of 1/240 s. No knob in Python changes these rates. Only shorter steps keep a landing brick from
  sinking.
- If the matrix-free solver exhausts its iterations, DART starts again with the dense solver. The time of the dense
  solver grows with the cube of the number of contacts. For impulses below 1 N s the relative tolerance of the
  matrix-free solver is in effect absolute [N s].
- With DART's own collision detector the matrix-free solver is not repeatable on tens of bricks. The same contacts in
  the same order give impulses that differ within the tolerance, depending on memory addresses. With FCL's and Bullet's
  detectors the solver was repeatable. But there a brick on a frozen brick stuck 1 deg above the friction angle. A
  possible reason is another direction of the friction box.
- DART's own sleeping starts under ``default`` after 0.5 s at rest. Under the matrix-free solver a pile that rested
  below both speed thresholds was still awake after 3 s.
- A memory address identifies the Python wrapper of a collision object. DART may reuse the address after the removal of
  the skeleton. Therefore ``_remove`` first reads the contacts that still refer to the wrapper, and then deletes the
  wrapper.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import dartpy
import numpy as np

from adapters._dart_coordinates import coordinates_of, quaternions_of
from adapters._dart_settings import HAS_DEACTIVATION, KNOBS, MISSING_KNOBS
from adapters._dart_world import DartWorld
from adapters.hooks import Pair
from adapters.profile import Capabilities, KnobValue
from adapters.profile_files import load_settings
from adapters.shared.contact_forces import SubstepForces
from adapters.shared.live_pairs import of_live
from adapters.substeps import SubstepSimulation
from scenarios.model import Brick, Quaternion, Vector
from stability_core.port import Contacts, FloatArray, IntArray
from stability_core.ports.dart_calls import (
    CollisionObjects,
    forces_of,
    freeze,
    geometry_of,
    unfreeze,
)

_SETTINGS = load_settings("dart", KNOBS.__contains__, missing=MISSING_KNOBS)


class DartSimulation(SubstepSimulation):
    """One world of DART. The module's docstring describes freezing, contacts and friction."""

    engine = "dart"
    profiles = _SETTINGS.profiles
    sleep_knobs = _SETTINGS.sleep_knobs
    missing_knobs = _SETTINGS.missing
    knows_knob = staticmethod(_SETTINGS.knows)
    iterations = "matrix_free_max_iterations"
    capabilities = Capabilities(
        contact_points="4 points or more",
        near_contacts=False,
        separation=True,
        relative_velocity="from the velocities before each substep",
        forces="normal and friction",
        freeze="immobile skeleton",
        frozen_contacts=False,
        friction_law="box pyramid, the smaller coefficient of the pair",
        moved="a joint of prescribed velocity",
        deterministic="no",
        shapes=("box", "capsule", "sphere"),
        other_shapes="DART finds one point of a cylinder in a step, so that it sinks, and reads meshes from files only",
        own_moments=True,
        weld="a weld constraint, with the dense solver",
    )

    def _open(self) -> None:
        if self.info.sleeping != "off" and not HAS_DEACTIVATION:
            raise NotImplementedError(
                f"DART {self.info.version} has no sleeping of its own: use policy 'none', or install the "
                "version of dartpy in uv.lock (uv sync --group engines)"
            )
        self._engine = DartWorld(self.world, self.info.profile, self.expected)
        self._joints = self._engine.joints
        self._objects = CollisionObjects(lambda shape: int(shape.getSkeleton().getName()))
        self._latest: Contacts | None = None  # contacts of the latest step; None until they are read
        for body, box in self._fixed_boxes():  # a box, because box on box gives the best manifolds
            self._engine.add_fixed(body, box)

    def _read_knobs(self) -> Mapping[str, KnobValue]:
        return self._engine.read_knobs()

    # -- bodies ---------------------------------------------------------------------------------------

    def _spawn(self, body: int, brick: Brick) -> None:
        self._engine.add_live(body, brick)

    def _spawn_moved(self, body: int, brick: Brick) -> None:
        self._engine.add_moved(body, brick)

    def _remove(self, body: int) -> None:
        self._latest = self._read_contacts(self._listed())
        self._objects.forget(body)
        self._engine.remove(body)

    def _move(self, body: int, position: Vector, quaternion: Quaternion) -> None:
        joint = self._joints[body]
        joint.setPositions(coordinates_of(position, quaternion))
        joint.resetVelocities()

    # -- actions --------------------------------------------------------------------------------------

    def _push(self, body: int, impulse: Vector) -> None:
        joint = self._joints[body]
        velocities = joint.getVelocities()
        velocities[3:] += np.array(impulse) / self.bricks[body].mass
        joint.setVelocities(velocities)

    def _press(self, body: int, force: Vector) -> None:
        node = self._engine.skeletons[body].getBodyNode(0)
        node.addExtForce(list(force))

    def _drive(self, body: int, linear: Vector, angular: Vector, seconds: float) -> None:  # noqa: ARG002
        velocities = np.array((*angular, *linear))
        self._joints[body].setVelocities(velocities)  # the solver's contacts use these velocities
        self._joints[body].setCommands(velocities)

    def _set_gravity(self, gravity: Vector) -> None:
        self._engine.world.setGravity(list(gravity))
        self._engine.world.setTimeStep(
            self._engine.world.getTimeStep()
        )  # wakes every body that the engine put to sleep

    # -- time -----------------------------------------------------------------------------------------

    def _begin_frame(self, substep_s: float) -> None:
        if self._engine.world.getTimeStep() != substep_s:  # setting it wakes every body that the engine put to sleep
            self._engine.world.setTimeStep(substep_s)

    def _forces_of_substep(self) -> SubstepForces:
        contacts = self._listed()
        return SubstepForces(*self._objects.pairs_of(contacts), forces_of(contacts))

    def _substep(self) -> None:
        self._engine.world.step()

    def _end_frame(self) -> None:
        self._latest = None
        if self._before is not None:  # the contacts belong to the poses before the last substep, and so do all arms
            centers = self._before.position
            self._before = replace(self._before, position=np.repeat(centers[-1:], len(centers), axis=0))

    # -- state ----------------------------------------------------------------------------------------

    def _poses(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]:
        coordinates = self._engine.coordinates(bodies.tolist())
        return coordinates[:, 3:], quaternions_of(coordinates[:, :3])

    def _positions(self, bodies: IntArray) -> FloatArray:
        return self._engine.coordinates(bodies.tolist())[:, 3:]

    def _velocities(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]:
        rates = self._engine.rates(bodies.tolist())
        return rates[:, 3:], rates[:, :3]

    # -- called by the port ---------------------------------------------------------------------------

    def _freeze(self, body: int) -> None:
        freeze(self._engine.skeletons[body])

    def _unfreeze(self, body: int) -> None:
        unfreeze(self._engine.skeletons[body])

    def _join(self, pair: Pair) -> None:
        self._engine.join(pair)

    def _part(self, pair: Pair) -> None:
        self._engine.part(pair)

    def _contacts(self) -> Contacts:
        if self._latest is None:
            self._latest = self._read_contacts(self._listed())
        return of_live(self._latest, self.bodies)

    def _find_contacts(self) -> Contacts:
        solver, result = self._engine.world.getConstraintSolver(), dartpy.collision.CollisionResult()
        solver.getCollisionGroup().collide(solver.getCollisionOption(), result)
        return self._read_contacts(result.getContacts())

    # -- the end --------------------------------------------------------------------------------------

    def _close(self) -> None:
        self._objects.clear()
        self._engine.close()

    # -- helpers --------------------------------------------------------------------------------------

    def _listed(self) -> Sequence[Any]:
        """Return DART's contacts of the latest substep."""
        contacts: Sequence[Any] = self._engine.world.getLastCollisionResult().getContacts()
        return contacts

    def _read_contacts(self, contacts: Sequence[Any]) -> Contacts:
        """Convert DART's contacts to ``Contacts``, including contacts of frozen and of removed bodies."""
        if not contacts:
            return Contacts.empty()
        force = forces_of(contacts) if self.reads_forces else None
        return self._contacts_of_step(self._objects.pairs_of(contacts), *geometry_of(contacts), force)
