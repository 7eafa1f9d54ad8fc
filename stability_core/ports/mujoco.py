"""A port to a MuJoCo simulation that the user owns. The model must have ghosts: see ``prepare``.

Ids are MuJoCo's body ids. The port controls the bodies that ``prepare`` gave a ghost. Bodies with a fixed place in the
world are the ground. All other bodies are obstacles: robots, mocap bodies, and bodies that the user leaves out. An
obstacle that touches a controlled body counts as a body that the host moves.

The port returns MuJoCo's contacts, and adds the missing corners of contact areas between boxes, standing cylinders,
meshes and planes.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Hashable, Iterable, Sequence
from dataclasses import replace

import mujoco
import numpy as np

from stability_core.port import GROUND, Contacts, FloatArray, IntArray, Masses
from stability_core.ports.mujoco_calls import (
    Data,
    collided_copy,
    contact_forces,
    fall,
    relative_velocities,
    speculative_rows,
)
from stability_core.ports.mujoco_ghosts import FreeBody, geoms_of
from stability_core.ports.mujoco_prepare import SUFFIX, prepare
from stability_core.ports.mujoco_shapes import solid_of
from stability_core.ports.shared.approach import Motions, fastest_approach
from stability_core.ports.shared.nothing import NO_CONTACTS, NO_MASSES
from stability_core.ports.shared.shapes import ShapeTable, compile_kernels
from stability_core.ports.shared.vectors import dot, rotate, rows_of

__all__ = ["MujocoPort", "open_port", "prepare"]

NEAR = 1e-3
"""Greatest gap [m] at which ``find_contacts`` lists a pair, because MuJoCo lists no contact at a gap of zero."""
_NO_PLACES = np.empty(0, np.int64)
_MOVED = 1e-6
"""Greatest change of a frozen body's position [m], or of a component of its quaternion, without a move by the user."""
_TURNED = 1e-4
"""Greatest change of a component of an obstacle's quaternion without a turn: about 0.01 degrees."""
_STEP = 0.02
"""Greatest difference of ``dt`` from the simulated time [steps], because sums of time steps round."""
_NO_GHOSTS = (
    "this MuJoCo model has no ghosts, and MuJoCo cannot make a body static: build the model with spec = "
    "mujoco.MjSpec.from_file(...); stability_core.ports.mujoco.prepare(spec); model = spec.compile()"
)


def open_port(world: Data, bodies: Collection[int | str] | None) -> MujocoPort:
    """Return a port to a simulation of MuJoCo.

    Args:
        world: the ``MjData``.
        bodies: ids or names of the bodies to control; None for all bodies that ``prepare`` gave a ghost.

    Raises:
        TypeError: if the world is not an ``MjData``.
        ValueError: if the model or a body has no ghost, or ``bodies`` lists a body twice.
    """
    if not isinstance(world, mujoco.MjData):
        raise TypeError(f"attach() needs MuJoCo's MjData, got {type(world).__name__}: pass data = mujoco.MjData(model)")
    compile_kernels()
    return MujocoPort(world, bodies)


class MujocoPort:
    """The core's view of the prepared bodies of a MuJoCo simulation."""

    engine = "mujoco"

    def __init__(self, data: Data, bodies: Collection[int | str] | None) -> None:
        self.data, self.model = data, data.model
        self.world: Hashable = (self.engine, id(data))
        model = self.model
        ghosts = {
            model.body(model.body(ghost).name.removesuffix(SUFFIX)).id: ghost
            for ghost in range(model.nbody)
            if model.body(ghost).name.endswith(SUFFIX)
        }
        if not ghosts:
            raise ValueError(_NO_GHOSTS)
        self._free = {body: FreeBody(model, data, body, ghost) for body, ghost in sorted(ghosts.items())}
        self._masks = {
            body: (model.geom_contype[free.geoms].copy(), model.geom_conaffinity[free.geoms].copy())
            for body, free in self._free.items()
        }
        self._settings = {
            body: (float(model.body_gravcomp[body]), int(model.tree_sleep_policy[free.tree]))
            for body, free in self._free.items()
        }
        self._id_of_geom: IntArray = model.geom_bodyid.astype(np.int64)
        self._id_of_geom[(model.body_weldid == 0)[self._id_of_geom] & (model.body_mocapid < 0)[self._id_of_geom]] = (
            GROUND
        )
        for body, free in self._free.items():
            self._id_of_geom[free.ghost_geoms] = body
        self._is_obstacle = self._id_of_geom >= 0
        self._is_live = np.zeros(model.ngeom, np.bool_)
        self._is_frozen = np.zeros(model.ngeom, np.bool_)
        self._live: dict[int, FreeBody] = {}
        self._frozen: dict[int, FreeBody] = {}
        self._obstacles: set[int] = set()
        self._removed: list[int] = []
        self._shapes = ShapeTable()
        self._before: Motions | None = None
        self._turns: dict[int, FloatArray] = {}
        self._time: float = data.time
        self._finds = False
        self._frozen_places: IntArray | None = None
        self._frozen_poses: FloatArray = np.empty(0)
        is_world = (model.body_weldid == 0) & (model.body_mocapid < 0)
        self._has_movers = 1 + 2 * len(self._free) < model.nbody - np.count_nonzero(is_world[1:])
        self.add(self._free if bodies is None else bodies)

    # -- called by the attachment ------------------------------------------------------------------

    def gravity(self) -> tuple[float, float, float]:
        """Return the world's gravity [m/s2]."""
        x, y, z = self.model.opt.gravity.tolist()
        return x, y, z

    def begin_update(self, dt: float) -> list[int]:
        """Check the time; return obstacles that have turned, and frozen bodies that the user pushes.

        ``xfrc_applied`` shows the pushes.

        Raises:
            ValueError: if ``dt`` is not the time since the previous update, the time went back, or a pose or a velocity
                is not finite. The first check omits ``dt`` = 0.
        """
        passed, self._time = self.data.time - self._time, self.data.time
        if passed < 0.0:
            raise ValueError(
                f"the time of this MuJoCo simulation went back by {-passed:g} s, because mj_resetData or a divergence "
                "reset the simulation, or the program set data.time: call close() of the extension before a reset, "
                "and attach() again after it"
            )
        if dt > 0.0 and abs(passed - dt) > _STEP * self.model.opt.timestep:
            raise ValueError(
                f"MuJoCo advanced by {passed:g} s since the previous update(), but dt is {dt:g} s: call update() after "
                "mj_step, and pass the time of all steps since the previous update()"
            )
        if not math.isfinite(self.data.qpos.sum() + self.data.qvel.sum()):
            raise ValueError(
                f"body {self._not_finite()!r} of this MuJoCo simulation has a pose or a velocity that is not finite, "
                "because the simulation has diverged or the program has set the value: use a smaller timestep or "
                "softer contacts, or correct the value"
            )
        turned = [body for body, turn in self._turns.items() if abs(self.data.xquat[body] - turn).max() > _TURNED]
        self._turns = {body: self.data.xquat[body].copy() for body in self._obstacles}
        forces = self.data.xfrc_applied
        pushed = [body for body in self._frozen if forces[body].any()] if forces.any() else []
        return turned + pushed

    def add(self, bodies: Iterable[int | str]) -> None:
        """Control prepared bodies, by ids or names.

        Raises:
            ValueError: for a body without a ghost, or a body that the port controls already.
        """
        for name in bodies:
            body = self._checked(name)
            self._live[body] = self._free[body]
            self._obstacles.discard(body)
            self._note(body)
            solid = solid_of(self.model, body)
            if solid is not None:
                self._shapes.add(body, solid)

    def remove(self, bodies: Iterable[int]) -> None:
        """Stop controlling bodies; frozen bodies become live first.

        Raises:
            KeyError: for a body without a ghost.
        """
        bodies = list(bodies)
        self.wake(bodies)
        for body in bodies:
            self._live.pop(body, None)
            self._shapes.remove(body)
            self._note(body)
            self._removed.append(body)

    def find_contacts(self) -> None:
        """Make the next ``contacts`` return the contacts of the present poses, without a change of the simulation."""
        self._finds = True

    # -- called by the core ------------------------------------------------------------------------

    def contacts(self) -> Contacts:
        """Return the contacts that touch a live body, or join a frozen body and an obstacle.

        The port adds the missing corners of contact areas.
        """
        if not self._live and not self._has_movers:
            return NO_CONTACTS
        data = self._collided_copy() if self._finds else self.data
        found, finds, self._finds = data.contact, self._finds, False
        rows = self._rows(found.geom)
        if not len(rows):
            return NO_CONTACTS
        geoms, points, normals, separation = found.geom[rows], found.pos[rows], found.frame[rows, :3], found.dist[rows]
        ids = self._id_of_geom[geoms]
        a, b = np.ascontiguousarray(ids[:, 0]), np.ascontiguousarray(ids[:, 1])
        velocity = relative_velocities(self.model, data, self.model.geom_bodyid[geoms], points)
        force = np.zeros(points.shape) if finds else contact_forces(self.model, data, rows)
        speculative = speculative_rows(found, rows)
        if len(speculative) and not finds:
            separation[speculative] = np.nan
            velocity[speculative] += fall(self.model, self._is_live[geoms[speculative]])
        earlier = fastest_approach(self._before, a, b, points, normals)
        faster = dot(earlier, normals) < dot(velocity, normals)  # False for NaN
        velocity[faster] = earlier[faster]
        self._follow_obstacles(ids)
        self._place(data)
        return self._shapes.completed(
            Contacts(a, b, points, normals, separation, velocity, found.friction[rows, 0], force)
        )

    def masses(self) -> Masses:
        """Return the live bodies, the obstacles (of infinite mass), and frozen bodies that the user moved."""
        removed, self._removed = self._removed, []
        moved = self._moved()
        if not self._live and not self._obstacles and not moved:
            self._before = None
            return replace(NO_MASSES, removed=removed) if removed else NO_MASSES
        listed = {**self._live, **moved}
        ids = np.array(sorted([*listed, *self._obstacles]), np.int64)
        motions = [self._motion_of(body, listed.get(body)) for body in ids.tolist()]
        rows = rows_of(motions, 9)
        mass = np.where(np.isin(ids, list(listed)), self.model.body_mass[ids], np.inf)
        self._before = Motions(ids, *(np.ascontiguousarray(rows[None, :, k : k + 3]) for k in (0, 3, 6)))
        return Masses(ids, mass, rows[:, :3], removed)

    def sleep(self, bodies: Sequence[int]) -> None:
        """Freeze bodies at their present poses; skip bodies that are not live."""
        for body in [body for body in bodies if body in self._live]:
            free = self._frozen[body] = self._live.pop(body)
            free.show_ghost(*self._masks[body])
            free.park()
            self._note(body)

    def wake(self, bodies: Sequence[int]) -> None:
        """Return frozen bodies to MuJoCo, at rest; skip other bodies."""
        for body in [body for body in bodies if body in self._frozen]:
            free = self._live[body] = self._frozen.pop(body)
            if not free.has_left_ghost(_MOVED):
                free.return_from_ghost()
            free.hide_ghost()
            free.stop()
            free.collide(*self._masks[body])
            free.unpark(*self._settings[body])
            self._note(body)

    # -- helpers -----------------------------------------------------------------------------------

    def _moved(self) -> dict[int, FreeBody]:
        """Return the frozen bodies that the user has moved."""
        if self._frozen_places is None:
            self._frozen_places = np.concatenate([free.places for free in self._frozen.values()] or [_NO_PLACES])
            ghosts = [free.mocap for free in self._frozen.values()]
            poses = np.concatenate([self.data.mocap_pos[ghosts], self.data.mocap_quat[ghosts]], axis=1)
            self._frozen_poses = poses.ravel()
        if (self.data.qpos[self._frozen_places] == self._frozen_poses).all():
            return {}
        return {body: free for body, free in self._frozen.items() if free.has_left_ghost(_MOVED)}

    def _not_finite(self) -> str | int:
        """Return the name, or the id without a name, of the first body with a velocity or pose that is not finite."""
        model, data = self.model, self.data
        is_bad = ~np.isfinite(data.qvel)
        if is_bad.any():
            body = int(model.dof_bodyid[is_bad.argmax()])
        else:
            joint = np.searchsorted(model.jnt_qposadr, (~np.isfinite(data.qpos)).argmax(), side="right") - 1
            body = int(model.jnt_bodyid[joint])
        return model.body(body).name or body

    def _checked(self, name: int | str) -> int:
        """Return the id of a body that the port can control and does not control yet.

        Raises:
            ValueError: for a body without a ghost, or a body that the port controls already.
        """
        names = {self.model.body(body).name: body for body in self._free}
        body = names.get(name, -1) if isinstance(name, str) else name
        if body not in self._free:
            raise ValueError(
                f"body {name!r} has no ghost in this MuJoCo model: call prepare(spec) before spec.compile(), or pass "
                f"one of {', '.join(map(repr, names))}"
            )
        if body in self._live or body in self._frozen:
            raise ValueError(f"the port controls body {name!r} already: list each body once, in attach() or in add()")
        return body

    def _note(self, body: int) -> None:
        """Record the state of a body's geoms."""
        free = self._free[body]
        self._frozen_places = None
        self._is_live[free.geoms] = body in self._live
        self._is_frozen[free.ghost_geoms] = body in self._frozen
        controlled = body in self._live or body in self._frozen
        self._is_obstacle[free.geoms] = self._is_obstacle[free.ghost_geoms] = not controlled

    def _rows(self, geoms: IntArray) -> IntArray:
        """Return the rows of pairs of geoms (n, 2) that touch a live body, or join a frozen body and an obstacle."""
        touches_live = self._is_live[geoms].any(axis=1)
        is_pushed = self._is_frozen[geoms].any(axis=1) & self._is_obstacle[geoms].any(axis=1)
        rows: IntArray = np.flatnonzero((touches_live | is_pushed) & (geoms >= 0).all(axis=1))
        return rows

    def _collided_copy(self) -> Data:
        """Return a copy of the state with the contacts of the present poses, up to a gap of ``NEAR``."""
        geoms = np.flatnonzero(self._is_live)
        margins = self.model.geom_margin[geoms].copy()
        self.model.geom_margin[geoms] = np.maximum(margins, NEAR)
        try:
            return collided_copy(self.model, self.data)
        finally:
            self.model.geom_margin[geoms] = margins

    def _follow_obstacles(self, ids: IntArray) -> None:
        """Add the obstacles among the bodies of contacts (n, 2)."""
        for body in np.unique(ids).tolist():
            if body == GROUND or body in self._live or body in self._frozen or body in self._obstacles:
                continue
            self._obstacles.add(body)
            solid = solid_of(self.model, body)
            if solid is not None:
                self._shapes.add(body, solid)

    def _place(self, data: Data) -> None:
        """Write the poses at the time of the contacts to the table of shapes, and add the ground if it is a plane."""
        if GROUND not in self._shapes and len(geoms_of(self.model, 0)) == 1:
            plane = solid_of(self.model, 0)
            if plane is not None and not len(plane.vertices):
                self._shapes.add(GROUND, plane)
        bodies = [*self._live, *self._obstacles]
        self._shapes.place(bodies, np.concatenate([data.xpos[bodies], np.roll(data.xquat[bodies], -1, axis=1)], axis=1))

    def _motion_of(self, body: int, free: FreeBody | None) -> FloatArray:
        """Return centre [m], velocity [m/s] and spin [rad/s] of a body, in the world's frame, shape (9,).

        Args:
            body: MuJoCo's id of the body.
            free: the body's state; None for an obstacle.
        """
        if free is None:
            velocity = np.empty(6)
            mujoco.mj_objectVelocity(self.model, self.data, mujoco.mjtObj.mjOBJ_BODY, body, velocity, 0)
            return np.concatenate([self.data.xipos[body], velocity[3:], velocity[:3]])
        turn = free.pose[None, 3:]
        arm = rotate(turn, self.model.body_ipos[None, body])[0]
        spin = rotate(turn, free.velocity[None, 3:])[0]
        return np.concatenate([free.pose[:3] + arm, free.velocity[:3] + np.cross(spin, arm), spin])
