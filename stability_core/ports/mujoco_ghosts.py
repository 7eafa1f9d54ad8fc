"""Freezing of a free body in MuJoCo, for the port and for the suite's adapter.

MuJoCo cannot make a body of a compiled model static. Each body therefore has a mocap body with the same geoms (its
"ghost"). ``park`` takes collisions and weight from a frozen body, and the ghost collides at the body's pose. From
MuJoCo 3.4.0 on, a parked body also sleeps, and a sleeping body costs no time. No step moves a mocap body, so that the
drift is zero. MuJoCo lists no contacts of ghosts with one another or with the ground, because MuJoCo counts ghosts and
ground as parts of the world body.
"""

from __future__ import annotations

import numpy as np

from stability_core.port import FloatArray, IntArray
from stability_core.ports.mujoco_calls import Data, Model
from stability_core.ports.mujoco_release import HAS_SLEEP, SLEEP_ALLOWED


class FreeBody:
    """A body with a free joint, and views of its state in MuJoCo's memory."""

    __slots__ = (
        "_data",
        "_model",
        "body",
        "geoms",
        "ghost",
        "ghost_geoms",
        "mocap",
        "places",
        "pose",
        "tree",
        "velocity",
        "warm",
    )

    def __init__(self, model: Model, data: Data, body: int, ghost: int | None) -> None:
        """Find the state of a body.

        Args:
            model: the compiled model.
            data: its state.
            body: MuJoCo's id of the body.
            ghost: MuJoCo's id of its ghost, whose geoms are in the same order; None without a ghost.
        """
        self._model, self._data = model, data
        self.body, self.ghost = body, ghost
        self.tree: int = model.body_treeid[body]
        joint = model.body_jntadr[body]
        place, dof = model.jnt_qposadr[joint], model.jnt_dofadr[joint]
        self.places: IntArray = np.arange(place, place + 7)
        self.pose: FloatArray = data.qpos[place : place + 7]
        self.velocity: FloatArray = data.qvel[dof : dof + 6]
        self.warm: FloatArray = data.qacc_warmstart[dof : dof + 6]
        self.geoms = geoms_of(model, body)
        self.ghost_geoms = np.empty(0, np.int64) if ghost is None else geoms_of(model, ghost)
        self.mocap: int = -1 if ghost is None else model.body_mocapid[ghost]

    def stop(self) -> None:
        """Set the velocity, the angular velocity and the solver's memory of the acceleration to zero."""
        self.velocity[:] = 0
        self.warm[:] = 0

    def collide(self, contype: IntArray, conaffinity: IntArray) -> None:
        """Set the collision masks of the body's geoms, each of shape (geoms,)."""
        set_masks(self._model, self.body, self.geoms, contype, conaffinity)

    def park(self) -> None:
        """Park the body: remove its collisions and its weight, and let it sleep if MuJoCo has sleeping."""
        self.stop()
        none = np.zeros(len(self.geoms), np.int64)
        self.collide(none, none)
        self._model.body_gravcomp[self.body] = 1
        self._set_sleep_policy(SLEEP_ALLOWED)
        if HAS_SLEEP and self._data.tree_asleep[self.tree] < 0:
            self._data.tree_asleep[self.tree] = -1  # end of MuJoCo's count-down: the body sleeps after the next step

    def unpark(self, gravcomp: float, sleep_policy: int) -> None:
        """Give the body its weight, its sleep policy and its place among the awake bodies, but no collisions."""
        self._model.body_gravcomp[self.body] = gravcomp
        self._set_sleep_policy(sleep_policy)
        self.wake()

    def wake(self) -> None:
        """Wake the body, and the island in which the body sleeps, if MuJoCo has sleeping."""
        if HAS_SLEEP:
            self._data.tree_awake[self.tree] = 1  # MuJoCo wakes a tree whose two sleep records disagree

    def _set_sleep_policy(self, policy: int) -> None:
        if HAS_SLEEP:
            self._model.tree_sleep_policy[self.tree] = policy

    def show_ghost(self, contype: IntArray, conaffinity: IntArray) -> None:
        """Place the ghost at the body's pose, and set the ghost's collision masks, each of shape (geoms,)."""
        self._data.mocap_pos[self.mocap] = self.pose[:3]
        self._data.mocap_quat[self.mocap] = self.pose[3:]
        set_masks(self._model, self.ghost, self.ghost_geoms, contype, conaffinity)

    def return_from_ghost(self) -> None:
        """Place the body at the ghost's pose."""
        self.pose[:3] = self._data.mocap_pos[self.mocap]
        self.pose[3:] = self._data.mocap_quat[self.mocap]

    def hide_ghost(self) -> None:
        """Stop the ghost's collisions."""
        none = np.zeros(len(self.ghost_geoms), np.int64)
        set_masks(self._model, self.ghost, self.ghost_geoms, none, none)

    def has_left_ghost(self, distance: float) -> bool:
        """Return True if a component of the body's pose differs by more than ``distance`` from the ghost's pose."""
        position = abs(self.pose[:3] - self._data.mocap_pos[self.mocap]).max()
        turn = abs(self.pose[3:] - self._data.mocap_quat[self.mocap]).max()
        return bool(max(position, turn) > distance)


def geoms_of(model: Model, body: int) -> IntArray:
    """Return MuJoCo's ids of a body's geoms, shape (n,)."""
    first: int = model.body_geomadr[body]
    return np.arange(first, first + model.body_geomnum[body])


def set_masks(model: Model, body: int | None, geoms: IntArray, contype: IntArray, conaffinity: IntArray) -> None:
    """Set the collision masks of geoms (n,) and of their body, because MuJoCo tests both.

    Two geoms collide if the type of one geom and the affinity of the other share a bit.
    """
    model.geom_contype[geoms], model.geom_conaffinity[geoms] = contype, conaffinity
    model.body_contype[body] = np.bitwise_or.reduce(contype, initial=0)
    model.body_conaffinity[body] = np.bitwise_or.reduce(conaffinity, initial=0)
