"""pymunk, the Python package of Chipmunk: a planar engine in the scene's x-z plane, with every brick centred on y = 0.

Units: one engine unit is a millimetre. As shipped Chipmunk allows overlaps of 0.1 units, because its authors consider a
unit to be a pixel. A plank is then about a hundred units long, as in a game. In metres the shipped slop would exceed
the thickness of a plank.

Angle: a positive angle of Chipmunk turns +x towards its second axis, the scene's +z. A rotation about +y turns +z
towards +x, so that the two angles differ in sign.

Freezing: a frozen brick is a static body (``stability_core.ports.pymunk_calls``). A body that becomes dynamic again has
lost its mass and moment of inertia, so that the adapter sets both.

Contacts: Chipmunk lists overlapping pairs, with at most two points, and no pair across a gap. A brick at rest overlaps
its support by the slop, so that its contacts stay listed. Chipmunk's record of a pair is an arbiter. The order of
arbiters and of ``Body.id`` depends on memory addresses. The adapter sorts both, so that runs repeat. A point in the
plane represents a line across the bricks' depth, and the adapter reports both ends of that line.

``find_contacts`` runs Chipmunk's shape query for each live brick. The query detects contacts as a step does, but
creates no arbiters and changes nothing. Between corners that meet, rounding determines the query's normals, with errors
of up to 90 degrees. ``BoxTable`` replaces these contacts.

Friction: the coefficient of a pair is the product of both shapes' coefficients. Therefore the adapter gives each shape
the square root of its brick's own coefficient, or of the world's coefficient if the brick has none. Restitution follows
the same rule.

Shapes: a sphere is a circle with a sphere's inertia. A polyhedron must be a prism with its axis along y.

Trap: ``Body.sleep()`` on a part of an island corrupts memory.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pymunk

from adapters._pymunk_plane import UNITS_PER_METRE, lift
from adapters._pymunk_world import PymunkWorld
from adapters.profile import Capabilities, KnobValue
from adapters.profile_files import load_settings
from adapters.substeps import SubstepSimulation
from scenarios.model import Brick, Quaternion, Vector
from stability_core.port import Contacts, FloatArray, IntArray
from stability_core.ports.pymunk_contacts import lift_contacts

_SETTINGS = load_settings("pymunk", lambda name: isinstance(getattr(pymunk.Space, name, None), property))


class PymunkSimulation(SubstepSimulation):
    """One world of Chipmunk."""

    engine = "pymunk"
    profiles = _SETTINGS.profiles
    sleep_knobs = _SETTINGS.sleep_knobs
    knows_knob = staticmethod(_SETTINGS.knows)
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
        shapes=("box", "sphere", "polyhedron"),
        other_shapes="in its plane a round body is a circle, and the adapter turns bodies about y only",
        own_friction=True,
        restitution=True,
        own_moments=True,
    )

    def _open(self) -> None:
        self.info = replace(self.info, unit_scale=UNITS_PER_METRE)
        self._engine = PymunkWorld(self.world, self.info.profile)
        self._velocities_before: list[FloatArray] = []  # before each substep of the frame, by id, shape (n, 3)
        for body, box in self._fixed_boxes():
            self._engine.add_fixed(body, box)
        self._contacts()  # compiles or loads the kernels before any frame is timed; there are no contacts yet

    def _read_knobs(self) -> Mapping[str, KnobValue]:
        return {name: getattr(self._engine.space, name) for name in self.info.profile.knobs}

    # -- bodies ---------------------------------------------------------------------------------------

    def _spawn(self, body: int, brick: Brick) -> None:
        self._engine.add_live(body, brick)

    def _spawn_moved(self, body: int, brick: Brick) -> None:
        self._engine.add_moved(body, brick)

    def _remove(self, body: int) -> None:
        self._engine.remove(body)

    def _move(self, body: int, position: Vector, quaternion: Quaternion) -> None:
        self._engine.move(body, position, quaternion)

    # -- actions --------------------------------------------------------------------------------------

    def _push(self, body: int, impulse: Vector) -> None:
        x, _, z = impulse
        planar = self._engine.bodies[body]
        planar.apply_impulse_at_world_point((x * UNITS_PER_METRE, z * UNITS_PER_METRE), planar.position)
        self._engine.reader.note_change()

    def _press(self, body: int, force: Vector) -> None:
        x, _, z = force
        planar = self._engine.bodies[body]
        planar.apply_force_at_world_point((x * UNITS_PER_METRE, z * UNITS_PER_METRE), planar.position)

    def _drive(self, body: int, linear: Vector, angular: Vector, seconds: float) -> None:  # noqa: ARG002
        planar = self._engine.bodies[body]
        planar.velocity = linear[0] * UNITS_PER_METRE, linear[2] * UNITS_PER_METRE
        planar.angular_velocity = -angular[1]
        self._engine.reader.note_change()

    def _set_gravity(self, gravity: Vector) -> None:
        self._engine.set_gravity(gravity)

    # -- time -----------------------------------------------------------------------------------------

    def _begin_frame(self, substep_s: float) -> None:  # noqa: ARG002
        self._engine.forget_static_pairs()
        self._velocities_before.clear()

    def _record_motions(self, bodies: IntArray) -> None:  # noqa: ARG002 - one call reads all bodies
        self._velocities_before.append(self._engine.reader.state()[:, 3:])

    def _substep(self) -> None:
        self._engine.step(self._substep_s)

    # -- state ----------------------------------------------------------------------------------------

    def _poses(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]:
        state = self._engine.reader.state()[bodies]
        half = -state[:, 2] / 2
        quaternions = np.zeros((len(bodies), 4))
        quaternions[:, 0], quaternions[:, 2] = np.cos(half), np.sin(half)
        return lift(state[:, :2] / UNITS_PER_METRE), quaternions

    def _positions(self, bodies: IntArray) -> FloatArray:
        return lift(self._engine.reader.state()[bodies, :2] / UNITS_PER_METRE)

    def _velocities(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]:
        state = self._engine.reader.state()[bodies]
        angular = np.zeros((len(bodies), 3))
        angular[:, 1] = -state[:, 5]
        return lift(state[:, 3:5] / UNITS_PER_METRE), angular

    # -- called by the port ---------------------------------------------------------------------------

    def _freeze(self, body: int) -> None:
        self._engine.freeze(body)

    def _unfreeze(self, body: int) -> None:
        self._engine.unfreeze(body, self.bricks[body])

    def _contacts(self) -> Contacts:
        state = self._engine.reader.state()  # read before the arbiters, because both use the same buffer
        return self._lifted(*self._engine.reader.arbiters(), state)

    def _find_contacts(self) -> Contacts:
        found = self._engine.reader.query(self._engine.bodies[body] for body in self.bodies.live)
        return self._lifted(*found, self._engine.reader.state()) if len(found[0]) else Contacts.empty()

    # -- the end --------------------------------------------------------------------------------------

    def _close(self) -> None:
        self._engine.close()

    # -- helpers --------------------------------------------------------------------------------------

    def _lifted(self, arbiters: IntArray, numbers: FloatArray, state: FloatArray) -> Contacts:
        """Return the contacts of arbiters, in three dimensions and SI units: see ``lift_contacts``."""
        reader, fixed = self._engine.reader, self._engine.fixed_rows
        is_live = np.zeros(reader.rows, np.bool_)
        is_live[list(self.bodies.live)] = True
        before = np.array(self._velocities_before) if self._velocities_before else np.empty((0, reader.rows, 3))
        pairs, points, normals, separations, velocities = lift_contacts(
            reader.engine_ids, reader.ids, arbiters, numbers, is_live, fixed,
            state, before, self._engine.depths, UNITS_PER_METRE,
        )  # fmt: skip
        friction = np.full(len(pairs), self.world.friction)
        return Contacts(pairs[:, 0], pairs[:, 1], points, normals, separations, velocities, friction)
