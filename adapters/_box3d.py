"""Box3D: Erin Catto's soft contacts in small substeps, in single precision, through the C API of ``robox3d``.

Freezing: the body is stopped and made static; made dynamic again it has the mass and inertia of its shape. Static
bodies are not collided with one another.

Contacts are found anew at the present poses whenever they are read: a step of length 0 runs collision detection and
solves nothing, so that later motion does not change by a bit. ``find_contacts`` does the same. Box3D lists points
within its prediction distance as well; points that are further apart than a tenth of a millimetre are left out. Forces
are those of the solver's latest iteration, times the number of iterations: exact where the load is steady. A point
that the step of length 0 sees as a new one has none.

Friction: as shipped a pair has the geometric mean of both shapes' coefficients, and all shapes have the world's. The
law is a cone: one constraint a manifold, and one against twist.

Stiffness: contacts are springs whose sag under load falls with the square of their natural frequency, ``contactHertz``.
Box3D silently caps it at an eighth of the rate of its iterations (which it calls substeps), and at twice that against
static bodies.

Traps: ``b3SetLengthUnitsPerMeter`` is global in the process and read whenever it is used, also as shapes are made and
bodies change their type: it is set anew before each such call. Tolerances are multiples of it, among them the slop
(5 mm), the distance of predicted contacts (20 mm) and that within which contacts are recycled (50 mm): too much for a
plank of 8 mm. The package's own ``World`` hides most of the API.
``pybox3d`` is another engine. A definition must be held while it is used: a pointer into a temporary crashes later. A
state that is not finite is only logged, and the step after it never ends: from then on nothing is stepped, and poses
are reported as NaN.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

import numpy as np
from robox3d._ffi import lib
from robox3d.core import _log

from adapters._box3d_arrays import ContactReader, Manifolds, poses_of, raw_handle, velocities_of, with_room
from adapters._box3d_world import WORLD_KNOBS, add_box, open_world, set_velocity, split
from adapters.profile import Capabilities, Profile, Sleeping
from adapters.profile_files import load_settings
from adapters.shared.contact_completion import fixed_id
from adapters.shared.contact_forces import SubstepForces
from adapters.substeps import SubstepSimulation
from scenarios.model import UPRIGHT, Brick, Quaternion, Vector, World
from stability_core.port import GROUND, Contacts, FloatArray, IntArray

_NEAR = 1e-4
"""Points further apart than this [m] do not touch."""

_SETTINGS = load_settings("box3d", (*WORLD_KNOBS, "subStepCount", "sleepThreshold").__contains__)


class Box3dSimulation(SubstepSimulation):
    """One world of Box3D."""

    engine: ClassVar[str] = "box3d"
    profiles: ClassVar[Mapping[str, Profile]] = _SETTINGS.profiles
    sleep_knobs = _SETTINGS.sleep_knobs
    iterations: ClassVar[str] = "subStepCount"
    solver_noise: ClassVar[float] = 1e-5
    capabilities: ClassVar[Capabilities] = Capabilities(
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
    )

    def __init__(self, profile: Profile, world: World, sleeping: Sleeping, expected: Sequence[Brick]) -> None:
        super().__init__(profile, world, sleeping, expected)
        self._knobs = {name: knob.value for name, knob in self.info.profile.knobs.items()}
        self._iterations = int(self._knobs["subStepCount"])
        self._handles: dict[int, Any] = {}
        self._shapes: dict[int, int] = {}
        self._raw_handles = np.zeros(64, np.uint64)  # by body, as batch functions take them
        self._body_of = np.full(64, GROUND)  # by shape
        self._reader = ContactReader()
        self._solved: Manifolds | None = None  # contacts of the latest substep, once read
        self._has_diverged = False
        self._engine = open_world(world, self._knobs)
        x, y, z = self.ground_half_edges
        self._create(GROUND, Brick((2 * x, 2 * y, 2 * z), 1.0, (0.0, 0.0, -z), UPRIGHT), lib.b3_staticBody)
        for index, box in enumerate(world.fixed):
            self._create(fixed_id(index), box, lib.b3_staticBody)

    # -- bodies ---------------------------------------------------------------------------------------

    def _spawn(self, body: int, brick: Brick) -> None:
        self._insert(body, brick, lib.b3_dynamicBody)

    def _spawn_moved(self, body: int, brick: Brick) -> None:
        self._insert(body, brick, lib.b3_kinematicBody)

    def _remove(self, body: int) -> None:
        self._body_of[self._shapes.pop(body)] = GROUND
        lib.b3DestroyBody(self._handles.pop(body))

    def _move(self, body: int, position: Vector, quaternion: Quaternion) -> None:
        handle = self._handle(body)
        lib.b3Body_SetTransform(handle, position, split(quaternion))
        set_velocity(handle)
        lib.b3Body_SetAwake(handle, True)

    # -- actions --------------------------------------------------------------------------------------

    def _push(self, body: int, impulse: Vector) -> None:
        lib.b3Body_ApplyLinearImpulseToCenter(self._handle(body), impulse, True)

    def _press(self, body: int, force: Vector) -> None:
        lib.b3Body_ApplyForceToCenter(self._handle(body), force, True)

    def _drive(self, body: int, linear: Vector, angular: Vector, seconds: float) -> None:  # noqa: ARG002
        set_velocity(self._handle(body), linear, angular)

    def _set_gravity(self, gravity: Vector) -> None:
        lib.b3World_SetGravity(self._engine, gravity)
        for body in self.bodies.live:
            lib.b3Body_SetAwake(self._handle(body), True)

    # -- time -----------------------------------------------------------------------------------------

    def _begin_frame(self, substep_s: float) -> None:  # noqa: ARG002 - told to each step
        self._solved = None

    def _forces_of_substep(self) -> SubstepForces:
        read = self._read()
        return SubstepForces(self._body_of[read.shape_a], self._body_of[read.shape_b], read.impulse / self._iteration_s)

    def _substep(self) -> None:
        self._advance(self._substep_s, self._iterations)

    # -- state ----------------------------------------------------------------------------------------

    def _poses(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]:
        rows = poses_of(self._raw_handles[bodies])
        if self._has_diverged:
            rows[:] = np.nan
        return rows[:, :3], rows[:, [6, 3, 4, 5]]

    def _velocities(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]:
        rows = velocities_of(self._raw_handles[bodies])
        return rows[:, :3], rows[:, 3:]

    # -- called by the port ---------------------------------------------------------------------------

    def _freeze(self, body: int) -> None:
        handle = self._handle(body)
        set_velocity(handle)
        lib.b3Body_SetType(handle, lib.b3_staticBody)

    def _thaw(self, body: int) -> None:
        handle = self._handle(body)
        lib.b3Body_SetType(handle, lib.b3_dynamicBody)
        lib.b3Body_SetAwake(handle, True)

    def _contacts(self) -> Contacts:
        if self.reads_forces and self._solved is None and self._substep_s:
            self._solved = self._read()  # finding contacts drops some of the impulses
        self._advance(0.0, 1)
        fresh = self._read()
        listed = fresh.exists & (fresh.separation <= _NEAR * self.scale)
        row, point = np.nonzero(listed)
        body_a, body_b = self._body_of[fresh.shape_a[row]], self._body_of[fresh.shape_b[row]]
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
        lib.b3DestroyWorld(self._engine)

    # -- helpers --------------------------------------------------------------------------------------

    def _set_length_unit(self) -> None:
        """Set the unit of the engine's tolerances, which all worlds of the process share."""
        lib.b3SetLengthUnitsPerMeter(self._knobs["lengthUnitsPerMeter"])

    def _handle(self, body: int) -> Any:
        """Return the handle of a body that is about to be changed."""
        self._set_length_unit()
        return self._handles[body]

    def _create(self, body: int, brick: Brick, kind: int) -> tuple[Any, int]:
        """Add a box, which contacts name ``body``; returns its handle and the index of its shape."""
        self._set_length_unit()
        handle, index = add_box(self._engine, brick, kind, self.world.friction, self._knobs.get("sleepThreshold", 1.0))
        self._body_of = with_room(self._body_of, index)
        self._body_of[index] = body
        return handle, index

    def _insert(self, body: int, brick: Brick, kind: int) -> None:
        handle, self._shapes[body] = self._create(body, brick, kind)
        self._handles[body] = handle
        self._raw_handles = with_room(self._raw_handles, body)
        self._raw_handles[body] = raw_handle(handle)

    def _advance(self, seconds: float, iterations: int) -> None:
        """Make one step, unless the world has diverged: the engine would never come back."""
        if not self._has_diverged:
            self._set_length_unit()
            lib.b3World_Step(self._engine, seconds, iterations)
            self._has_diverged = any("unstable" in message for message in _log.drain())

    @property
    def _iteration_s(self) -> float:
        return self._substep_s / self._iterations

    def _read(self) -> Manifolds:
        """Return the contacts that the latest step found, of live bodies."""
        return self._reader.read(self._handles[body] for body in self.bodies.live)
