"""Box3D: Erin Catto's soft contacts in small substeps, in single precision, through the C API of ``robox3d``.

Freezing: the adapter stops the body and makes it static. When the body becomes dynamic again, Box3D computes the mass
and inertia of its shape. The adapter replaces these values unless the body is a homogeneous box. Box3D does not collide
static bodies with one another.

Contacts: before each reading, the adapter makes a step of length 0. This step detects the contacts at the present
poses, and solves nothing, so that later motion does not change by a bit. ``find_contacts`` makes the same step. Box3D
also lists points within its prediction distance. The adapter omits points with a gap of more than 0.1 mm. The force of
a contact is its impulse in the solver's latest iteration, divided by the duration of the iteration. Under a steady load
this force is exact. A contact that only the step of length 0 has detected has no force.

Friction: the coefficient of a pair is the geometric mean of both shapes' coefficients (as shipped). Every shape has the
coefficient of its brick, or the world's coefficient if the brick has none. The law is a cone, with one constraint per
manifold for sliding and one constraint for twist.

Stiffness: contacts are springs. The sag under load is inversely proportional to the square of the springs' natural
frequency, ``contactHertz``. Box3D silently caps this frequency. The cap is an eighth of the rate of Box3D's iterations
(Box3D calls these iterations substeps), and a quarter of that rate against static bodies.

Traps:

- ``b3SetLengthUnitsPerMeter`` is global in the process. Box3D reads this unit in every step, when Box3D creates a
  shape, and when a body changes its type. Therefore the adapter sets the unit before each of these calls. Tolerances
  are multiples of the unit: the slop (5 mm), the distance of predicted contacts (20 mm) and the distance within which
  Box3D recycles contacts (50 mm). With the shipped unit these distances are too large for a plank 8 mm thick.
- The package's own ``World`` hides most of the API, and ``pybox3d`` is another engine.
- Box3D only logs a state that is not finite, and the next step does not return. Therefore the adapter makes no step
  after such a state, and reports poses as NaN.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from robox3d._ffi import lib

from adapters._box3d_contacts import ContactReader, Manifolds
from adapters._box3d_state import poses_of, velocities_of
from adapters._box3d_world import KNOBS, Box3dWorld, set_velocity, split
from adapters.hooks import Pair
from adapters.profile import Capabilities, KnobValue
from adapters.profile_files import load_settings
from adapters.shared.box_contacts import NEAR
from adapters.shared.contact_forces import SubstepForces
from adapters.substeps import SubstepSimulation
from scenarios.model import Brick, Quaternion, Vector
from stability_core.port import GROUND, Contacts, FloatArray, IntArray

_SETTINGS = load_settings("box3d", KNOBS.__contains__)


class Box3dSimulation(SubstepSimulation):
    """One world of Box3D."""

    engine = "box3d"
    profiles = _SETTINGS.profiles
    sleep_knobs = _SETTINGS.sleep_knobs
    knows_knob = staticmethod(_SETTINGS.knows)
    iterations = "subStepCount"
    solver_noise = 1e-5
    """Margin [m/s] of ``fastest_approach``. Without a margin the profile ``tuned`` reported 13 mm/s between a brick at
    rest and a platform that moved below the brick at 50 mm/s."""
    capabilities = Capabilities(
        contact_points="up to 4 points",
        near_contacts=True,
        separation=True,
        relative_velocity="from the velocities before the step",
        forces="normal and friction",
        freeze="static body",
        frozen_contacts=False,
        friction_law="cone",
        moved="kinematic",
        deterministic="across processes",
        shapes=("box", "capsule", "sphere", "polyhedron"),
        other_shapes="Box3D's cylinder is a prism, on which it comes to rest",
        own_friction=True,
        own_moments=True,
        weld="a weld joint",
    )

    def _open(self) -> None:
        self._engine = Box3dWorld(self.world, self.info.profile)
        self._reader = ContactReader()
        self._solved: Manifolds | None = None  # contacts of the latest substep, once read
        for body, box in self._fixed_boxes():
            self._engine.add_fixed(body, box)

    def _read_knobs(self) -> Mapping[str, KnobValue]:
        return self._engine.read_knobs()

    # -- bodies ---------------------------------------------------------------------------------------

    def _spawn(self, body: int, brick: Brick) -> None:
        self._engine.add_live(body, brick)

    def _spawn_moved(self, body: int, brick: Brick) -> None:
        self._engine.add_moved(body, brick)

    def _remove(self, body: int) -> None:
        self._engine.remove(body)

    def _move(self, body: int, position: Vector, quaternion: Quaternion) -> None:
        handle = self._engine.handle(body)
        lib.b3Body_SetTransform(handle, position, split(quaternion))
        set_velocity(handle)
        lib.b3Body_SetAwake(handle, True)

    # -- actions --------------------------------------------------------------------------------------

    def _push(self, body: int, impulse: Vector) -> None:
        lib.b3Body_ApplyLinearImpulseToCenter(self._engine.handle(body), impulse, True)

    def _press(self, body: int, force: Vector) -> None:
        lib.b3Body_ApplyForceToCenter(self._engine.handle(body), force, True)

    def _drive(self, body: int, linear: Vector, angular: Vector, seconds: float) -> None:  # noqa: ARG002
        set_velocity(self._engine.handle(body), linear, angular)

    def _set_gravity(self, gravity: Vector) -> None:
        self._engine.set_gravity(gravity)
        for body in self.bodies.live:
            lib.b3Body_SetAwake(self._engine.handle(body), True)

    # -- time -----------------------------------------------------------------------------------------

    def _begin_frame(self, substep_s: float) -> None:  # noqa: ARG002 - an argument of each step
        self._solved = None

    def _forces_of_substep(self) -> SubstepForces:
        read = self._read()
        body_of = self._engine.body_of
        return SubstepForces(body_of[read.shape_a], body_of[read.shape_b], read.impulse / self._iteration_s)

    def _substep(self) -> None:
        self._engine.step(self._substep_s, self._engine.iterations)

    # -- state ----------------------------------------------------------------------------------------

    def _poses(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]:
        rows = poses_of(self._engine.raw_handles[bodies])
        if self._engine.has_diverged:
            rows[:] = np.nan
        return rows[:, :3], rows[:, [6, 3, 4, 5]]

    def _velocities(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]:
        rows = velocities_of(self._engine.raw_handles[bodies])
        return rows[:, :3], rows[:, 3:]

    # -- called by the port ---------------------------------------------------------------------------

    def _freeze(self, body: int) -> None:
        handle = self._engine.handle(body)
        set_velocity(handle)
        lib.b3Body_SetType(handle, lib.b3_staticBody)

    def _unfreeze(self, body: int) -> None:
        handle = self._engine.handle(body)
        lib.b3Body_SetType(handle, lib.b3_dynamicBody)
        self._engine.restore_inertia(body, self.bricks[body])
        lib.b3Body_SetAwake(handle, True)

    def _join(self, pair: Pair) -> None:
        self._engine.join(pair)

    def _part(self, pair: Pair) -> None:
        self._engine.part(pair)

    def _contacts(self) -> Contacts:
        if self.reads_forces and self._solved is None and self._substep_s:
            self._solved = self._read()  # before the step of length 0, which drops some of the impulses
        self._engine.step(0.0, 1)
        fresh = self._read()
        listed = fresh.exists & (fresh.separation <= NEAR * self.scale)
        row, point = np.nonzero(listed)
        body_a, body_b = self._engine.body_of[fresh.shape_a[row]], self._engine.body_of[fresh.shape_b[row]]
        is_fixed = body_a <= GROUND
        anchor = np.where(is_fixed[:, None], fresh.anchor_b[row, point], fresh.anchor_a[row, point])
        force = None
        if self._solved is not None:
            force = self._solved.impulses_at(fresh, listed)[row, point] / self._iteration_s
        return self._contacts_of_step(
            (body_a, body_b),
            self._positions(np.where(is_fixed, body_b, body_a)) + anchor,
            fresh.normal[row],
            fresh.separation[row, point],
            force,
        )

    _find_contacts = _contacts

    # -- the end --------------------------------------------------------------------------------------

    def _close(self) -> None:
        self._engine.close()

    # -- helpers --------------------------------------------------------------------------------------

    @property
    def _iteration_s(self) -> float:
        return self._substep_s / self._engine.iterations

    def _read(self) -> Manifolds:
        """Return the latest step's contacts of live bodies."""
        return self._reader.read(self._engine.handles[body] for body in self.bodies.live)
