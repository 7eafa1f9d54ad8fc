"""The adapter's table of MuJoCo's geoms, and the contacts between them in MuJoCo's arrays."""

from __future__ import annotations

import numpy as np

from adapters._mujoco_slots import SlotModel
from adapters.shared.contact_completion import fixed_id
from adapters.shared.contact_forces import SubstepForces
from stability_core.port import GROUND, FloatArray, IntArray
from stability_core.ports.mujoco_calls import contact_forces, fall, relative_velocities

NOBODY = np.iinfo(np.int64).min
"""Id that marks the geoms of an empty slot."""


class Geoms:
    """Record of the geoms of one compiled model: the body of each geom, and whether the body is live.

    The record also states whether the contacts of a geom are current. The contacts are current until the geom gets
    another body or another pose after the latest step.
    """

    def __init__(self, world: SlotModel) -> None:
        self._world = world
        self._body = np.full(world.geoms, NOBODY)
        self._body[0] = GROUND
        self._body[world.first_fixed :] = [fixed_id(index) for index in range(world.geoms - world.first_fixed)]
        self._is_live = np.zeros(world.geoms, bool)
        self._is_current = np.ones(world.geoms, bool)

    def assign(self, slot: int, body: int) -> None:
        """Record the body of a slot's geoms. The contacts of these geoms are not current until the next frame."""
        geoms = slice(1 + slot, self._world.first_fixed, self._world.slots)  # of the brick and of its ghost, if any
        self._body[geoms] = body
        self._is_current[geoms] = False

    def set_live(self, slot: int, is_live: bool) -> None:
        """Record whether the brick of a slot is live."""
        self._is_live[1 + slot] = is_live

    def begin_frame(self) -> None:
        """Record that the contacts of the next step are current for all geoms."""
        self._is_current[:] = True

    def bodies_of(self, geoms: IntArray) -> tuple[IntArray, IntArray]:
        """Return bodies a and b, each of shape (n,), of pairs of geoms (n, 2)."""
        body_a, body_b = self._body[geoms].T
        return body_a, body_b

    def live_rows(self, geoms: IntArray) -> IntArray:
        """Return the rows of pairs (n, 2) that touch a live body."""
        return np.flatnonzero(self._is_live[geoms].any(axis=1))

    def current_rows(self, geoms: IntArray) -> IntArray:
        """Return the rows of pairs (n, 2) that touch a live body and are current for both bodies."""
        return np.flatnonzero(self._is_live[geoms].any(axis=1) & self._is_current[geoms].all(axis=1))

    def relative_velocities(self, geoms: IntArray, points: FloatArray) -> FloatArray:
        """Return velocities (n, 3) [m/s] of the second geom relative to the first, at the start of the latest substep.

        Args:
            geoms: both geoms of each contact, shape (n, 2).
            points: contact points [m] in the world's frame, shape (n, 3).
        """
        return relative_velocities(self._world.model, self._world.data, geoms, points)

    def forces_at(self, rows: IntArray, geoms: IntArray) -> SubstepForces:
        """Return the forces of the given rows of MuJoCo's contacts in the latest substep, between ``geoms`` (n, 2)."""
        return SubstepForces(*self.bodies_of(geoms), contact_forces(self._world.model, self._world.data, rows))

    def fall(self, geoms: IntArray) -> FloatArray:
        """Return the change (n, 3) [m/s] of the relative velocities of ``geoms`` (n, 2) by gravity in one substep.

        A pair with a speculative contact falls freely during this substep, because the pair's bodies do not touch yet.
        """
        return fall(self._world.model, self._is_live[geoms])
