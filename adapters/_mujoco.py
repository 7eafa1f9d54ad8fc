"""MuJoCo 3 and 4: soft contacts, solved by Newton's method.

Slots: MuJoCo compiles its model in advance, so that the adapter reserves a slot for every expected brick. A slot is a
free body. Until the host spawns the brick, the slot is "parked": without collisions or weight, and from MuJoCo 3.4 on
without cost (``_mujoco_slots.py``). If no free slot fits a brick, the adapter compiles a new model with more slots and
copies the state (``_mujoco_world.py``).

Freezing: MuJoCo cannot make a body static, so that each slot has a second body, a mocap body with the same shape (its
"ghost"). The adapter parks a frozen brick, and the ghost collides at the brick's pose. Nothing moves a mocap body: the
drift is exactly zero. MuJoCo lists no contacts among ghosts and the ground, because a ghost counts as a part of the
world body, like the ground. A world without a port has no ghosts.

Contacts: MuJoCo lists the contacts at the start of the latest substep, and ``cvel`` holds the velocities at that time.
Contacts and velocities together give the approach speed before the solver stops the bodies.

``find_contacts`` runs MuJoCo's kinematics and collision on a copy of the state and changes nothing. The call disables
speculative contacts and sleeping, so that MuJoCo measures all distances and lists sleeping pairs.

Friction: the coefficient of a pair is the larger of both geoms' coefficients, and every geom has the world's
coefficient.

Traps:

- Divergence silently resets the world unless ``autoreset`` is off.
- MuJoCo does not measure the distance of a speculative contact. The adapter reports this distance as unknown (NaN).
- MuJoCo does not wake a sleeping brick when the host removes its support.
- MuJoCo solves a step twice in which a body falls asleep. Therefore a freeze costs a second solve, and MuJoCo's own
  sleeping costs a second solve in nearly every step of a large pile, whose bricks fall asleep and wake in turn.
- A stiff contact is thin: with the profiles' ``solimp`` a brick at rest lies 0.03 mm deep, and falls up to 2.7 mm in a
  frame in which MuJoCo lists no contact at one of its edges. Therefore the bricks of a pile rock at one step a frame.
- Without a handler MuJoCo writes its warnings to a file in the working directory.
"""

from __future__ import annotations

import logging
from collections.abc import Mapping

import mujoco
import numpy as np

from adapters._mujoco_approaches import Approaches
from adapters._mujoco_slots import CONTACT_STEPS
from adapters._mujoco_world import MujocoWorld
from adapters.hooks import Pair
from adapters.profile import Capabilities, KnobValue
from adapters.profile_files import load_settings
from adapters.shared.contact_forces import mean_force
from adapters.shared.driven_pose import advanced
from adapters.shared.vectors import rotate
from adapters.substeps import SubstepSimulation
from scenarios.model import Brick, Quaternion, Vector
from stability_core.port import Contacts, FloatArray, IntArray
from stability_core.ports.mujoco_calls import speculative_rows
from stability_core.ports.mujoco_release import HAS_AUTORESET, HAS_SLEEP, HAS_SPECULATIVE, has_reset

mujoco.set_mju_user_warning(logging.getLogger(__name__).warning)


def _knows(knob: str) -> bool:
    """Return whether a knob of this name may exist. MuJoCo itself rejects an unknown attribute of its XML."""
    return "." in knob or knob in (CONTACT_STEPS, "sleep")


_MISSING_KNOBS = (
    *(() if HAS_AUTORESET else ("flag.autoreset",)),
    *(() if HAS_SLEEP else ("sleep", "option.sleep_tolerance")),
    *(() if HAS_SPECULATIVE else ("flag.speculative",)),
)
"""Knobs that this release does not have."""
_SETTINGS = load_settings("mujoco", _knows, missing=_MISSING_KNOBS)


class MujocoSimulation(SubstepSimulation):
    """One world of MuJoCo."""

    engine = "mujoco"
    profiles = _SETTINGS.profiles
    sleep_knobs = _SETTINGS.sleep_knobs
    missing_knobs = _SETTINGS.missing
    knows_knob = staticmethod(_SETTINGS.knows)
    iterations = "option.iterations"
    capabilities = Capabilities(
        contact_points="up to 8 points between bricks, 4 on the ground",
        near_contacts=True,
        separation=True,
        relative_velocity="from the velocities before the step",
        forces="normal and friction",
        freeze="a mocap body with the same box collides in the brick's stead",
        frozen_contacts=False,
        friction_law="elliptic cone, regularised (as shipped: a 4-sided pyramid)",
        moved="a heavy body whose velocity is set before each step",
        deterministic="across processes",
        shapes=("box", "cylinder", "capsule", "sphere", "polyhedron"),
        own_moments=True,
        weld="a weld of the compiled model, assigned to the pair",
    )

    def _open(self) -> None:
        if self.info.sleeping != "off" and not HAS_SLEEP:
            raise NotImplementedError(
                f"MuJoCo {self.info.version} has no sleeping of its own: use policy 'none', or install mujoco 3.4 or "
                "later"
            )
        self._engine = MujocoWorld(
            self.world, self.info.profile, self.bodies, self.expected, needs_ghosts=lambda: self.is_observed
        )
        self._places: dict[int, tuple[FloatArray, FloatArray]] = {}  # poses of moved bodies
        self._approaches = Approaches()

    def _read_knobs(self) -> Mapping[str, KnobValue]:
        return self._engine.slots.read_knobs()

    # -- bodies ---------------------------------------------------------------------------------------

    def _spawn(self, body: int, brick: Brick) -> None:
        self._engine.add_live(body, brick)

    def _spawn_moved(self, body: int, brick: Brick) -> None:
        self._places[body] = np.array(brick.position), np.array(brick.quaternion)
        self._engine.add_moved(body, brick)

    def _remove(self, body: int) -> None:
        self._engine.remove(body)

    def _move(self, body: int, position: Vector, quaternion: Quaternion) -> None:
        self._engine.move(body, position, quaternion)
        if body in self.bodies.moved:
            self._places[body] = np.array(position), np.array(quaternion)

    # -- actions --------------------------------------------------------------------------------------

    def _push(self, body: int, impulse: Vector) -> None:
        slots, slot = self._engine.slots, self._engine.slot_of[body]
        slots.velocities[slot, :3] += np.asarray(impulse) / self.bricks[body].mass
        slots.wake(slot)

    def _press(self, body: int, force: Vector) -> None:
        self._engine.slots.data.xfrc_applied[1 + self._engine.slot_of[body], :3] = force

    def _drive(self, body: int, linear: Vector, angular: Vector, seconds: float) -> None:
        place = self._places[body]
        self._engine.slots.set_motion(self._engine.slot_of[body], *place, linear, angular)
        self._places[body] = advanced(*place, np.array(linear), np.array(angular), seconds)

    def _set_gravity(self, gravity: Vector) -> None:
        self._engine.set_gravity(gravity)

    # -- time -----------------------------------------------------------------------------------------

    def _begin_frame(self, substep_s: float) -> None:
        self._engine.slots.model.opt.timestep = substep_s
        self._engine.geoms.begin_frame()
        self._approaches.clear()

    def _record_ended_substep(self) -> None:
        found, record = self._engine.slots.data.contact, self._engine.geoms
        rows = record.current_rows(found.geom)
        geoms = found.geom[rows]
        self._approaches.add(geoms, found.frame[rows, :3], record.relative_velocities(geoms, found.pos[rows]))
        if self.reads_forces:
            self._earlier_forces.append(record.forces_at(rows, geoms))

    def _record_motions(self, bodies: IntArray) -> None:
        """Record nothing, because MuJoCo's own arrays hold the velocities at the start of the latest substep."""

    def _substep(self) -> None:
        data = self._engine.slots.data
        mujoco.mj_step(self._engine.slots.model, data)
        if not HAS_AUTORESET and has_reset(data):  # show the divergence, as releases do that can switch off the reset
            data.qpos[:] = np.nan

    def _solver_iterations(self) -> int:
        data = self._engine.slots.data
        return int(data.solver_niter[: max(data.nisland, 1)].max())

    # -- state ----------------------------------------------------------------------------------------

    def _poses(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]:
        slots, data = self._engine.slots_of(bodies), self._engine.slots.data
        poses = self._engine.slots.poses[slots]
        frozen = [row for row, body in enumerate(bodies.tolist()) if body in self.frozen]
        poses[frozen, :3] = data.mocap_pos[slots[frozen]]
        poses[frozen, 3:] = data.mocap_quat[slots[frozen]]
        return poses[:, :3], poses[:, 3:]

    def _positions(self, bodies: IntArray) -> FloatArray:
        return self._engine.slots.poses[self._engine.slots_of(bodies), :3]  # live bodies, so not at their ghosts

    def _velocities(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]:
        rows = self._engine.slots.velocities[self._engine.slots_of(bodies)]
        return rows[:, :3], rotate(self._poses(bodies)[1], rows[:, 3:])

    # -- called by the port ---------------------------------------------------------------------------

    def _freeze(self, body: int) -> None:
        self._engine.freeze(body)

    def _unfreeze(self, body: int) -> None:
        self._engine.unfreeze(body)

    def _join(self, pair: Pair) -> None:
        self._engine.join(pair)

    def _part(self, pair: Pair) -> None:
        self._engine.part(pair)

    def _contacts(self) -> Contacts:
        found, record = self._engine.slots.data.contact, self._engine.geoms
        rows = record.current_rows(found.geom)
        geoms, normals, separation = found.geom[rows], found.frame[rows, :3], found.dist[rows]
        velocity = record.relative_velocities(geoms, found.pos[rows])
        speculative = speculative_rows(found, rows)
        if len(speculative):  # forces before the bodies touch, at distances that MuJoCo has invented
            separation[speculative] = np.nan
            velocity[speculative] += record.fall(geoms[speculative])
        force = mean_force(record.forces_at(rows, geoms), normals, self._earlier_forces) if self.reads_forces else None
        body_a, body_b = record.bodies_of(geoms)
        return Contacts(
            body_a,
            body_b,
            found.pos[rows],
            normals,
            separation,
            self._approaches.fastest(geoms, normals, velocity),
            found.friction[rows, 0],
            force,
        )

    def _find_contacts(self) -> Contacts:
        found, record = self._engine.slots.collided_copy().contact, self._engine.geoms
        rows = record.live_rows(found.geom)
        points, normals = found.pos[rows], found.frame[rows, :3]
        body_a, body_b = record.bodies_of(found.geom[rows])
        unknown = np.full_like(points, np.nan)
        return Contacts(body_a, body_b, points, normals, found.dist[rows], unknown, found.friction[rows, 0])

    # -- the end --------------------------------------------------------------------------------------

    def _close(self) -> None:
        self._engine.close()
