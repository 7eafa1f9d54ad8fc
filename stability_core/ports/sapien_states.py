"""Poses and velocities of SAPIEN's bodies: from one packed block, or body by body if a call needs few bodies."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from stability_core.port import FloatArray, IntArray

STATE_ALONE, POSITION_ALONE = 50, 15
"""Times to read the state (10 us) and the position (3 us) of one body, each divided by the time per body of the packed
block (0.2 us). The packed block holds every body of the world."""


class BodyStates:
    """Reader of the states of a system's dynamic bodies."""

    def __init__(self, system: Any, components: Mapping[int, Any], bodies: Mapping[Any, int]) -> None:
        """Prepare to read bodies of ``system``.

        Args:
            system: SAPIEN's ``PhysxCpuSystem``.
            components: component of each body, by id.
            bodies: id of each component.
        """
        self._system = system
        self._components = components
        self._bodies = bodies
        self._rows = np.empty(0, np.int64)
        self._count = 0  # dynamic bodies come first in the packed block, before the articulations

    def count_rows(self) -> None:
        """Compute the row of each body in the packed block, by id, because SAPIEN's order changes with the bodies."""
        listed = [self._bodies[component] for component in self._system.rigid_dynamic_components]
        self._rows = np.full(max(listed, default=-1) + 1, -1)
        self._rows[listed] = np.arange(len(listed))
        self._count = len(listed)

    def read(self, bodies: IntArray) -> FloatArray:
        """Return quaternion (w, x, y, z), position [m], velocity [m/s] and spin [rad/s] of bodies, shape (n, 13)."""
        if 0 < len(bodies) * STATE_ALONE < len(self._components):
            return self._read_one_by_one(bodies)
        packed = np.frombuffer(self._system.pack(), np.float32, 13 * self._count).reshape(-1, 13)
        state: FloatArray = packed[self._rows[bodies]].astype(np.float64)
        return state

    def positions(self, bodies: IntArray) -> FloatArray:
        """Return the positions [m] of bodies (n,), shape (n, 3)."""
        if len(bodies) * POSITION_ALONE < len(self._components):
            poses = [self._components[body].entity_pose.p for body in bodies.tolist()]
            return np.array(poses, np.float64).reshape(-1, 3)
        return self.read(bodies)[:, 4:7]

    def _read_one_by_one(self, bodies: IntArray) -> FloatArray:
        """Return the array of ``read`` without the packed block, because the block holds every body of the world."""
        vectors: list[FloatArray] = []
        for body in bodies.tolist():
            component = self._components[body]
            pose = component.entity_pose
            vectors += (pose.q, pose.p, component.linear_velocity, component.angular_velocity)
        return np.concatenate(vectors, dtype=np.float64).reshape(-1, 13)
