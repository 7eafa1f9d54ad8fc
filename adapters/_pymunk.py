"""pymunk, which is Chipmunk: a planar engine. It plays the x-z plane; every brick is centred on y = 0.

Units: one engine unit is a millimetre. Chipmunk allows overlaps of 0.1 units as shipped and its makers think
of units as pixels: a plank is then some hundred units long, as a game would draw it. In metres the shipped
slop would be deeper than a plank is thick.

Angle: Chipmunk turns +x towards its second axis, our +z. A rotation about +y turns +z towards +x, so the two
differ in sign.

Freezing: a frozen brick is a static body. Turning it dynamic again makes Chipmunk forget mass and moment, so
both are set by hand. Static bodies also keep the push that was to cure their overlap (``v_bias``), which would
move them when woken; an integration over no time at all clears it.

Contacts: pairs that overlap, two points at most, none across a gap: a brick at rest overlaps by the slop and
stays listed. The arbiters of two static bodies are kept for ever, with points in memory that other contacts
soon reuse: taking a newly frozen body's shape out and in again drops them. Arbiters, and ``Body.id``, follow
memory addresses: they are sorted, or two runs would differ. Each point stands for a line across the bricks'
depth and is handed to the core as that line's two ends.

``find_contacts`` runs Chipmunk's shape query for each live brick, the collision of a step without its arbiters, and
changes nothing. Its normals between corners that meet are rounding, up to 90 degrees off: ``BoxTable`` replaces them.

Friction: the pair's is the product of both shapes', so each has the square root.

Traps: ``Body.sleep()`` on part of an island corrupts memory; a change of type in a callback aborts the process.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import pymunk

from adapters._pymunk_arrays import lift_contacts
from adapters._pymunk_plane import UNITS_PER_METRE, halt, in_plane, lift, moment, planar_gravity
from adapters._pymunk_reader import SpaceReader
from adapters.profile import Capabilities, Profile, Sleeping
from adapters.profile_files import load_settings
from adapters.shared.contact_completion import fixed_id
from adapters.substeps import SubstepSimulation
from scenarios.model import Brick, Quaternion, Vector, World
from stability_core.port import GROUND, Contacts, FloatArray, IntArray

_GROUND_SIZE = (20_000.0, 1_000.0)  # [mm]: wider than any scene, and too thick to fall through

_SETTINGS = load_settings("pymunk", lambda name: isinstance(getattr(pymunk.Space, name, None), property))

_SLEEPING: Mapping[Sleeping, Mapping[str, float]] = {
    "off": {},  # Chipmunk ships with sleeping off: its time threshold is infinite
    # The time that Chipmunk's own demos use; it then guesses the idle speed as gravity times the step.
    "native": {"sleep_time_threshold": 0.5},
    # About twice that guess at 60 steps a second (163 mm/s): users raise it where a pile never comes to rest.
    "raised": {"sleep_time_threshold": 0.5, "idle_speed_threshold": 300.0},
}


class PymunkSimulation(SubstepSimulation):
    """One Chipmunk space."""

    engine = "pymunk"
    profiles = _SETTINGS.profiles
    iterations = "iterations"
    capabilities = Capabilities(
        contact_points="up to 2 points in the plane, lifted to the ends of the bricks' common depth",
        near_contacts=False,
        separation=True,
        relative_velocity="from the velocities before each substep",
        forces="no",
        freeze="static body",
        frozen_contacts=False,
        friction_law="Coulomb, product of both shapes' coefficients",
        moved="kinematic",
        deterministic="across processes",
        planar=True,
    )

    def __init__(self, profile: Profile, world: World, sleeping: Sleeping, expected: Sequence[Brick]) -> None:
        super().__init__(profile, world, sleeping, expected)
        self.info = replace(self.info, unit_scale=UNITS_PER_METRE)
        self._space = pymunk.Space()
        self._space.gravity = planar_gravity(world.gravity)
        for setting, knob in profile.knobs.items():
            setattr(self._space, setting, knob.value)
        for setting, value in _SLEEPING[sleeping].items():
            setattr(self._space, setting, value)

        self._bodies: dict[int, pymunk.Body] = {}
        self._new_statics: list[int] = []
        self._velocities_before: list[FloatArray] = []  # each substep of the latest frame, by id, shape (n, 3)
        self._fixed_rows = 1 + len(world.fixed)
        """Rows of the ground and the fixed boxes, behind those of the bodies, where negative ids find them."""
        self._reader = SpaceReader(self._space, self._fixed_rows)
        self._depths = np.array([*(box.size[1] for box in reversed(world.fixed)), np.inf])  # [m]
        width, thickness = (edge * self.scale for edge in _GROUND_SIZE)
        self._add_fixed(GROUND, (width, thickness), (0.0, -thickness / 2), 0.0)
        for index, box in enumerate(world.fixed):
            size = box.size[0] * UNITS_PER_METRE, box.size[2] * UNITS_PER_METRE
            self._add_fixed(fixed_id(index), size, *in_plane(box.position, box.quaternion))
        self._contacts()  # none yet: this loads the compiled code before any frame is timed

    # -- bodies ---------------------------------------------------------------------------------------

    def _spawn(self, body: int, brick: Brick) -> None:
        self._insert(body, brick, pymunk.Body(brick.mass, moment(brick)))

    def _spawn_moved(self, body: int, brick: Brick) -> None:
        self._insert(body, brick, pymunk.Body(body_type=pymunk.Body.KINEMATIC))

    def _remove(self, body: int) -> None:
        planar = self._bodies.pop(body)
        self._space.remove(*planar.shapes, planar)
        self._reader.remove(body)

    def _move(self, body: int, position: Vector, quaternion: Quaternion) -> None:
        planar = self._bodies[body]
        planar.position, planar.angle = in_plane(position, quaternion)
        halt(planar)
        self._space.reindex_shapes_for_body(planar)
        self._reader.note_change()

    # -- actions --------------------------------------------------------------------------------------

    def _push(self, body: int, impulse: Vector) -> None:
        x, y, z = impulse
        if y != 0.0:
            raise ValueError(f"pymunk is planar: an impulse must lie in the x-z plane, got {impulse} N s")
        planar = self._bodies[body]
        planar.apply_impulse_at_world_point((x * UNITS_PER_METRE, z * UNITS_PER_METRE), planar.position)
        self._reader.note_change()

    def _press(self, body: int, force: Vector) -> None:
        x, _, z = force
        planar = self._bodies[body]
        planar.apply_force_at_world_point((x * UNITS_PER_METRE, z * UNITS_PER_METRE), planar.position)

    def _drive(self, body: int, linear: Vector, angular: Vector, seconds: float) -> None:  # noqa: ARG002
        planar = self._bodies[body]
        planar.velocity = linear[0] * UNITS_PER_METRE, linear[2] * UNITS_PER_METRE
        planar.angular_velocity = -angular[1]
        self._reader.note_change()

    def _set_gravity(self, gravity: Vector) -> None:
        self._space.gravity = planar_gravity(gravity)

    # -- time -----------------------------------------------------------------------------------------

    def _begin_frame(self, substep_s: float) -> None:  # noqa: ARG002
        self._forget_static_pairs()
        self._velocities_before.clear()

    def _record_motions(self, bodies: IntArray) -> None:  # noqa: ARG002 - all that there are, which costs one call
        self._velocities_before.append(self._reader.state()[:, 3:])

    def _substep(self) -> None:
        self._space.step(self._substep_s)
        self._reader.note_change()

    # -- state ----------------------------------------------------------------------------------------

    def _poses(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]:
        state = self._reader.state()[bodies]
        half = -state[:, 2] / 2
        quaternions = np.zeros((len(bodies), 4))
        quaternions[:, 0], quaternions[:, 2] = np.cos(half), np.sin(half)
        return lift(state[:, :2] / UNITS_PER_METRE), quaternions

    def _positions(self, bodies: IntArray) -> FloatArray:
        return lift(self._reader.state()[bodies, :2] / UNITS_PER_METRE)

    def _velocities(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]:
        state = self._reader.state()[bodies]
        angular = np.zeros((len(bodies), 3))
        angular[:, 1] = -state[:, 5]
        return lift(state[:, 3:5] / UNITS_PER_METRE), angular

    # -- called by the port ---------------------------------------------------------------------------

    def _freeze(self, body: int) -> None:
        planar = self._bodies[body]
        halt(planar)
        planar.body_type = pymunk.Body.STATIC
        self._new_statics.append(body)
        self._reader.note_change()

    def _thaw(self, body: int) -> None:
        planar, brick = self._bodies[body], self.bricks[body]
        planar.body_type = pymunk.Body.DYNAMIC
        planar.mass, planar.moment = brick.mass, moment(brick)

    def _contacts(self) -> Contacts:
        state = self._reader.state()  # read first: it passes through the same buffer
        return self._lifted(*self._reader.arbiters(), state)

    def _find_contacts(self) -> Contacts:
        found = self._reader.query(self._bodies[body] for body in self.bodies.live)
        return self._lifted(*found, self._reader.state()) if len(found[0]) else Contacts.empty()

    # -- the end --------------------------------------------------------------------------------------

    def _close(self) -> None:
        self._bodies.clear()
        del self._space, self._reader

    # -- helpers --------------------------------------------------------------------------------------

    def _add_fixed(self, body: int, size: tuple[float, float], place: tuple[float, float], angle: float) -> None:
        """Add the ground or a fixed box, which contacts name ``body``; lengths in engine units."""
        planar = pymunk.Body(body_type=pymunk.Body.STATIC)
        planar.position, planar.angle = place, angle
        self._add(planar, size)
        self._reader.add(planar, body)

    def _add(self, body: pymunk.Body, size: tuple[float, float]) -> None:
        shape = pymunk.Poly.create_box(body, size)
        shape.friction = math.sqrt(self.world.friction)
        self._space.add(body, shape)

    def _insert(self, body: int, brick: Brick, planar: pymunk.Body) -> None:
        """Add the engine's body for a brick."""
        place = in_plane(brick.position, brick.quaternion)
        planar.position, planar.angle = place
        self._add(planar, (brick.size[0] * UNITS_PER_METRE, brick.size[2] * UNITS_PER_METRE))
        self._bodies[body] = planar
        self._reader.add(planar, body)
        depths = np.full(self._reader.rows, np.inf)
        depths[: len(self._depths) - self._fixed_rows] = self._depths[: -self._fixed_rows]
        depths[-self._fixed_rows :] = self._depths[-self._fixed_rows :]
        depths[body] = brick.size[1]
        self._depths = depths

    def _forget_static_pairs(self) -> None:
        """Throw away the arbiters of newly frozen bodies, which the engine would keep, and list, for ever.

        Their contacts with live bodies are found again in the step that follows.
        """
        for body in self._new_statics:
            if body in self.frozen:
                shapes = self._bodies[body].shapes
                self._space.remove(*shapes)
                self._space.add(*shapes)
        self._new_statics.clear()

    def _lifted(self, arbiters: IntArray, numbers: FloatArray, state: FloatArray) -> Contacts:
        """Contacts of these arbiters, as ``lift_contacts`` takes them."""
        is_live = np.zeros(self._reader.rows, np.bool_)
        is_live[list(self.bodies.live)] = True
        before = np.array(self._velocities_before) if self._velocities_before else np.empty((0, self._reader.rows, 3))
        pairs, points, normals, separations, velocities = lift_contacts(
            self._reader.engine_ids, self._reader.ids, arbiters, numbers, is_live, self._fixed_rows,
            state, before, self._depths, UNITS_PER_METRE,
        )  # fmt: skip
        friction = np.full(len(pairs), self.world.friction)
        return Contacts(pairs[:, 0], pairs[:, 1], points, normals, separations, velocities, friction)
