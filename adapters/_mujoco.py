"""MuJoCo 4: soft contacts, solved to convergence by Newton's method.

Slots. MuJoCo compiles its model beforehand, so every expected brick has a slot: a free body that is
parked until it is spawned (``_mujoco_slots.py``). A brick that fits no free slot makes the model be
compiled anew, with the state carried over.

Freezing. MuJoCo has no static switch, so each slot has a ghost, a mocap body with the same box. To
freeze is to let the ghost stand and collide where the brick is, and to park the brick. Nothing moves a
mocap body, so the drift is exactly zero. A ghost belongs to the world, so contacts among ghosts and
with the ground vanish. A world without a port has no ghosts.

Contacts are those at the start of the latest substep, and ``cvel`` holds the velocities of that
moment: together they tell the approach before the solver stops it.

``find_contacts`` runs MuJoCo's kinematics and collision on a copy of the state and changes nothing. Speculative
contacts and sleeping are off meanwhile, so that distances are measured and sleeping pairs are listed.

Friction. A pair has the larger coefficient of its two geoms; all geoms have the world's.

Traps. Divergence silently resets the world unless ``autoreset`` is off. A speculative contact carries
a made-up distance, reported as unknown. MuJoCo does not see that a sleeping brick's support went
away. Its warnings go to a file in the working directory unless they are caught.
"""

from __future__ import annotations

import copy
import logging
from collections import defaultdict, deque
from collections.abc import Mapping, Sequence
from typing import ClassVar

import mujoco
import numpy as np

from adapters._mujoco_approaches import Approaches
from adapters._mujoco_geoms import NOBODY, Geoms
from adapters._mujoco_slots import CONTACT_STEPS, Shape, SlotModel, shape_of
from adapters.profile import Capabilities, Profile, Sleeping
from adapters.profile_files import load_settings
from adapters.shared.contact_forces import mean_force
from adapters.shared.driven_pose import advanced
from adapters.shared.vectors import rotate
from adapters.substeps import SubstepSimulation
from scenarios.model import Brick, Quaternion, Vector, World
from stability_core.port import Contacts, FloatArray, IntArray

mujoco.set_mju_user_warning(logging.getLogger(__name__).warning)

_SLEEPING_OR_SPECULATIVE = mujoco.mjtEnableBit.mjENBL_SLEEP.value | mujoco.mjtEnableBit.mjENBL_SPECULATIVE.value
"""Flags with which MuJoCo leaves out sleeping pairs, or lists distances that it did not measure."""


def _knows(knob: str) -> bool:
    """Tell whether there is a knob of this name; MuJoCo itself refuses an unknown attribute of its XML."""
    return "." in knob or knob in (CONTACT_STEPS, "sleep")


_SETTINGS = load_settings("mujoco", _knows)


class MujocoSimulation(SubstepSimulation):
    """One MuJoCo world."""

    engine: ClassVar[str] = "mujoco"
    profiles: ClassVar[Mapping[str, Profile]] = _SETTINGS.profiles
    sleep_knobs = _SETTINGS.sleep_knobs
    iterations: ClassVar[str] = "option.iterations"
    capabilities: ClassVar[Capabilities] = Capabilities(
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
    )

    def __init__(self, profile: Profile, world: World, sleeping: Sleeping, expected: Sequence[Brick]) -> None:
        super().__init__(profile, world, sleeping, expected)
        self._shapes: list[Shape] = [shape_of(brick) for brick in expected]
        self._slot: dict[int, int] = {}  # of every body
        self._places: dict[int, tuple[FloatArray, FloatArray]] = {}  # of moved bodies
        self._free: defaultdict[Shape, deque[int]] = defaultdict(deque)
        for slot, shape in enumerate(self._shapes):
            self._free[shape].append(slot)
        self._approaches = Approaches()
        self._compiled: SlotModel | None = None

    # -- bodies ---------------------------------------------------------------------------------------

    def _spawn(self, body: int, brick: Brick) -> None:
        self._let_live(self._occupy_slot(body, brick))

    def _spawn_moved(self, body: int, brick: Brick) -> None:
        self._places[body] = np.array(brick.position), np.array(brick.quaternion)
        slot = self._occupy_slot(body, brick)  # which may compile the engine anew
        self._engine.unpark_moved(slot)

    def _remove(self, body: int) -> None:
        if body in self.frozen:
            self._engine.hide_ghost(self._slot[body])
        slot = self._slot.pop(body)
        self._retire(slot)
        self._geoms.assign(slot, NOBODY)
        self._free[self._shapes[slot]].append(slot)
        self._rouse_all()

    def _move(self, body: int, position: Vector, quaternion: Quaternion) -> None:
        slot = self._slot[body]
        self._engine.set_pose(slot, position, quaternion)
        if body in self.frozen:
            self._engine.show_ghost(slot)
        if body in self.bodies.moved:
            self._places[body] = np.array(position), np.array(quaternion)
        self._geoms.assign(slot, body)
        self._rouse_all()

    # -- actions --------------------------------------------------------------------------------------

    def _push(self, body: int, impulse: Vector) -> None:
        slot = self._slot[body]
        self._engine.velocities[slot, :3] += np.asarray(impulse) / self.bricks[body].mass
        self._engine.rouse(slot)

    def _press(self, body: int, force: Vector) -> None:
        self._engine.data.xfrc_applied[1 + self._slot[body], :3] = force

    def _drive(self, body: int, linear: Vector, angular: Vector, seconds: float) -> None:
        slot = self._slot[body]
        position, quaternion = self._places[body]
        self._engine.poses[slot, :3], self._engine.poses[slot, 3:] = position, quaternion
        self._places[body] = advanced(position, quaternion, np.array(linear), np.array(angular), seconds)
        self._engine.velocities[slot, :3] = linear
        inverse = self._engine.poses[slot : slot + 1, 3:] * (1, -1, -1, -1)
        self._engine.velocities[slot, 3:] = rotate(inverse, np.array([angular]))[0]

    def _set_gravity(self, gravity: Vector) -> None:
        if self._compiled is not None:
            self._compiled.model.opt.gravity = gravity
            self._rouse_all()

    # -- time -----------------------------------------------------------------------------------------

    def _begin_frame(self, substep_s: float) -> None:
        self._engine.model.opt.timestep = substep_s
        self._geoms.begin_frame()
        self._approaches.clear()

    def _record_ended_substep(self) -> None:
        found = self._engine.data.contact
        rows = self._geoms.current_rows(found.geom)
        geoms = found.geom[rows]
        velocity = self._geoms.relative_velocities(geoms, found.pos[rows])
        self._approaches.add(geoms, found.frame[rows, :3], velocity)
        if self.reads_forces:
            self._earlier_forces.append(self._geoms.forces_at(rows, geoms))

    def _record_motions(self, bodies: IntArray) -> None:
        """Record nothing: MuJoCo keeps the velocities of its contacts itself."""

    def _substep(self) -> None:
        mujoco.mj_step(self._engine.model, self._engine.data)

    # -- state ----------------------------------------------------------------------------------------

    def _poses(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]:
        slots, data = self._slots(bodies), self._engine.data
        poses = self._engine.poses[slots]
        frozen = [row for row, body in enumerate(bodies.tolist()) if body in self.frozen]
        poses[frozen, :3] = data.mocap_pos[slots[frozen]]
        poses[frozen, 3:] = data.mocap_quat[slots[frozen]]
        return poses[:, :3], poses[:, 3:]

    def _positions(self, bodies: IntArray) -> FloatArray:
        return self._engine.poses[self._slots(bodies), :3]  # of live bodies, whose ghosts are elsewhere

    def _velocities(self, bodies: IntArray) -> tuple[FloatArray, FloatArray]:
        rows = self._engine.velocities[self._slots(bodies)]
        return rows[:, :3], rotate(self._poses(bodies)[1], rows[:, 3:])

    # -- called by the port ---------------------------------------------------------------------------

    def _freeze(self, body: int) -> None:
        if not self._engine.has_ghosts:
            self._compile(ghosts=True)
        slot = self._slot[body]
        self._engine.show_ghost(slot)
        self._retire(slot)

    def _thaw(self, body: int) -> None:
        slot = self._slot[body]
        self._engine.hide_ghost(slot)
        self._let_live(slot)

    def _contacts(self) -> Contacts:
        found = self._engine.data.contact
        rows = self._geoms.current_rows(found.geom)
        geoms, normals, separation = found.geom[rows], found.frame[rows, :3], found.dist[rows]
        velocity = self._geoms.relative_velocities(geoms, found.pos[rows])
        speculative = np.flatnonzero((found.efc_address[rows] >= 0) & (separation > found.includemargin[rows]))
        if len(speculative):  # a force before touch; the engine invents the distance that makes it stop the brick
            separation[speculative] = np.nan
            velocity[speculative] += self._geoms.fall(geoms[speculative])
        body_a, body_b = self._geoms.bodies_of(geoms)
        return Contacts(
            body_a,
            body_b,
            found.pos[rows],
            normals,
            separation,
            self._approaches.fastest(geoms, normals, velocity),
            found.friction[rows, 0],
            mean_force(self._geoms.forces_at(rows, geoms), normals, self._earlier_forces)
            if self.reads_forces
            else None,
        )

    def _find_contacts(self) -> Contacts:
        model, data = self._engine.model, copy.copy(self._engine.data)
        flags = model.opt.enableflags
        model.opt.enableflags = flags & ~_SLEEPING_OR_SPECULATIVE
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_collision(model, data)
        model.opt.enableflags = flags
        found = data.contact
        rows = self._geoms.live_rows(found.geom)
        points, normals = found.pos[rows], found.frame[rows, :3]
        body_a, body_b = self._geoms.bodies_of(found.geom[rows])
        unknown = np.full_like(points, np.nan)
        return Contacts(body_a, body_b, points, normals, found.dist[rows], unknown, found.friction[rows, 0])

    # -- the end --------------------------------------------------------------------------------------

    def _close(self) -> None:
        self._compiled = None

    # -- helpers --------------------------------------------------------------------------------------

    @property
    def _engine(self) -> SlotModel:
        """The compiled world, made when it is first needed: only then is it known whether the core looks on."""
        return self._compiled or self._compile(ghosts=self.is_observed)

    def _compile(self, *, ghosts: bool) -> SlotModel:
        """Compile a world for the present shapes, and carry the state over."""
        old, new = self._compiled, SlotModel(self._shapes, self.world, self.info.profile, ghosts=ghosts)
        if old is not None:
            for body in self.frozen:
                old.hide_ghost(self._slot[body])
            new.copy_state(old)
        self._compiled = new
        self._geoms = Geoms(new)
        for body, slot in self._slot.items():
            self._geoms.assign(slot, body)
            if body in self.frozen:
                new.show_ghost(slot)
            elif body in self.bodies.moved:
                new.unpark_moved(slot)
            else:
                self._let_live(slot)
        return new

    def _take_slot(self, shape: Shape) -> int:
        if not self._free[shape]:
            first, more = len(self._shapes), max(1, len(self._slot))  # doubling: few compilations, however many come
            self._shapes += [shape] * more
            self._free[shape].extend(range(first, first + more))
            if self._compiled is not None:
                self._compile(ghosts=self._compiled.has_ghosts)
        return self._free[shape].popleft()

    def _let_live(self, slot: int) -> None:
        self._engine.unpark(slot)
        self._geoms.set_live(slot, True)

    def _retire(self, slot: int) -> None:
        self._engine.park(slot)
        self._geoms.set_live(slot, False)

    def _rouse_all(self) -> None:
        for body, slot in self._slot.items():
            if body in self.bodies.live:
                self._engine.rouse(slot)

    def _slots(self, bodies: IntArray) -> IntArray:
        return np.array([self._slot[body] for body in bodies.tolist()], np.int64)

    def _occupy_slot(self, body: int, brick: Brick) -> int:
        """Put a brick into a slot that fits; returns the slot, still parked."""
        slot = self._take_slot(shape_of(brick))
        self._engine.set_pose(slot, brick.position, brick.quaternion)
        self._slot[body] = slot
        self._geoms.assign(slot, body)
        return slot
