"""PhysX 5 on the processor, through SAPIEN. The paper extended an earlier release, PhysX 3 inside Unity 4.

Freezing: the adapter makes the body kinematic (``stability_core.ports.sapien_calls``).

Contacts: PhysX reports up to four points per pair, detected before the latest substep. PhysX lists points with a gap of
up to the sum of both shapes' contact offsets. As shipped this sum exceeds the thickness of two planks. Therefore PhysX
also lists a brick and the ground with another brick between both, without impulse. The adapter omits points without
impulse at a gap of more than ``MAX_SEPARATION``. All poses and velocities come in one packed block of 32-bit floats.

``find_contacts`` makes one step of 1 us in a second world with the same bodies, weightless and at rest. A step is
necessary, because SAPIEN detects contacts in a step only. ``find_contacts`` reads the contacts that PhysX detected at
the start of that step, at the present poses. The first world does not change.

Friction: the coefficient of a pair is the mean of both materials' coefficients, and every material has the world's
coefficient, static and dynamic.

Traps:

- The scene's settings are global, and a system reads them at its creation. If gravity changes later, the adapter
  applies the difference times the mass of each body as a force.
- PhysX computes a box's inertia from its density, but at least 1e-6 kg m2. A plank has less, so that the adapter sets
  the inertia.
- Until the next step contacts refer to a removed component by its address. Therefore the adapter keeps the component.
- SAPIEN warns of a missing Vulkan on import, although the adapter renders nothing.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator, Mapping

import numpy as np

from adapters._physx_world import KNOBS, PhysxWorld
from adapters.hooks import Pair
from adapters.profile import Capabilities, KnobValue
from adapters.profile_files import load_settings
from adapters.shared.contact_forces import SubstepForces
from adapters.shared.driven_pose import advanced
from adapters.shared.quiet_import import silenced_stderr
from adapters.substeps import SubstepSimulation
from scenarios.model import Brick, Quaternion, Vector
from stability_core.port import Contacts, FloatArray, IntArray
from stability_core.ports.sapien_calls import (
    Listed,
    all_impulses,
    freeze,
    listed_pairs,
    stop,
    touching_points,
    unfreeze,
)

with silenced_stderr(), warnings.catch_warnings():
    warnings.simplefilter("ignore")
    import sapien

_INSTANT = 1e-6
"""Step [s] of the second world of ``find_contacts``. The step is short, so that the solver closes no gap."""

_SETTINGS = load_settings("physx", KNOBS.__contains__)


class PhysxSimulation(SubstepSimulation):
    """One world of PhysX 5."""

    engine = "physx"
    profiles = _SETTINGS.profiles
    sleep_knobs = _SETTINGS.sleep_knobs
    knows_knob = staticmethod(_SETTINGS.knows)
    iterations = "solver_position_iterations"
    capabilities = Capabilities(
        contact_points="up to 4 points",
        near_contacts=True,
        separation=True,
        relative_velocity="from the velocities before the step",
        forces="normal, and friction by the bodies' momentum",
        freeze="kinematic",
        frozen_contacts=False,
        friction_law="cone",
        moved="kinematic",
        deterministic="across processes",
        shapes=("box", "capsule", "sphere", "polyhedron"),
        other_shapes="SAPIEN's cylinder is a prism of 30 faces, on which it comes to rest",
        own_moments=True,
        weld="three joints, each of which locks a point",
    )

    def _open(self) -> None:
        self._engine = PhysxWorld(self.world, self.info.profile)
        self._components = self._engine.components
        self._places: dict[int, tuple[FloatArray, FloatArray]] = {}  # poses of moved bodies, in double precision
        for body, box in self._fixed_boxes():
            self._engine.add_fixed(body, box)

    def _read_knobs(self) -> Mapping[str, KnobValue]:
        return self._engine.read_knobs(self.info.profile.knobs)

    # -- bodies ---------------------------------------------------------------------------------------

    def _spawn(self, body: int, brick: Brick) -> None:
        self._engine.add_live(body, brick)

    def _spawn_moved(self, body: int, brick: Brick) -> None:
        self._engine.add_moved(body, brick)
        self._places[body] = np.array(brick.position), np.array(brick.quaternion)

    def _remove(self, body: int) -> None:
        self._engine.remove(body)

    def _move(self, body: int, position: Vector, quaternion: Quaternion) -> None:
        component = self._components[body]
        component.entity.pose = sapien.Pose(position, quaternion)
        if body in self.bodies.moved:
            self._places[body] = np.array(position), np.array(quaternion)
        elif body not in self.frozen:
            stop(component)

    # -- actions --------------------------------------------------------------------------------------

    def _push(self, body: int, impulse: Vector) -> None:
        component = self._components[body]
        component.wake_up()
        component.linear_velocity = component.linear_velocity + np.array(impulse) / self.bricks[body].mass

    def _press(self, body: int, force: Vector) -> None:
        self._components[body].add_force_torque(np.array(force, np.float32), np.zeros(3, np.float32))

    def _drive(self, body: int, linear: Vector, angular: Vector, seconds: float) -> None:
        place = advanced(*self._places[body], np.array(linear), np.array(angular), seconds)
        self._places[body] = place
        self._components[body].kinematic_target = sapien.Pose(*place)

    def _set_gravity(self, gravity: Vector) -> None:
        self._engine.set_gravity(gravity)
        for body in self.bodies.live:
            self._components[body].wake_up()

    # -- time -----------------------------------------------------------------------------------------

    def _begin_frame(self, substep_s: float) -> None:
        self._engine.system.timestep = substep_s

    def _forces_of_substep(self) -> SubstepForces:
        pairs, impulses = all_impulses(self._listed())
        return SubstepForces(*pairs, impulses / self._substep_s)

    def _motions_now(self, bodies: IntArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        state = self._engine.states.read(bodies)
        return state[:, 4:7], *self.as_driven(bodies, state[:, 7:10], state[:, 10:])

    def _substep(self) -> None:
        self._engine.add_gravity_change(self.bodies.live)
        self._engine.system.step()

    def _end_frame(self) -> None:
        self._engine.forget_removed()

    # -- state ----------------------------------------------------------------------------------------

    def _poses(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]:
        state = self._engine.states.read(bodies)
        return state[:, 4:7], state[:, :4]

    def _positions(self, bodies: IntArray) -> FloatArray:
        return self._engine.states.positions(bodies)

    def _velocities(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]:
        state = self._engine.states.read(bodies)
        return state[:, 7:10], state[:, 10:13]

    # -- called by the port ---------------------------------------------------------------------------

    def _freeze(self, body: int) -> None:
        freeze(self._components[body])

    def _unfreeze(self, body: int) -> None:
        unfreeze(self._components[body])

    def _join(self, pair: Pair) -> None:
        self._engine.join(pair, math.hypot(*self.bricks[pair[0]].size))

    def _part(self, pair: Pair) -> None:
        self._engine.part(pair)

    def _contacts(self) -> Contacts:
        pairs, numbers = touching_points(self._listed(), self.scale)
        if not len(numbers):
            return Contacts.empty()
        force = numbers[:, 7:] / self._substep_s if self.reads_forces and self._substep_s else None
        return self._with_friction(self._contacts_of_step(pairs, numbers[:, :3], numbers[:, 3:6], numbers[:, 6], force))

    def _find_contacts(self) -> Contacts:
        twin = self._twin()
        try:
            twin._engine.system.timestep = _INSTANT
            twin._engine.system.step()
            return twin._contacts()
        finally:
            twin.close()

    # -- the end --------------------------------------------------------------------------------------

    def _close(self) -> None:
        self._engine.close()

    # -- helpers --------------------------------------------------------------------------------------

    def _listed(self) -> Iterator[Listed]:
        """Yield every pair that touches a live body and has a point, by rising ids."""
        live = self.bodies.live
        return listed_pairs(
            self._engine.system.get_contacts(), self._engine.body_of.get, lambda a, b: a in live or b in live
        )
