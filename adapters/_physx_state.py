"""Poses and velocities of SAPIEN's bodies: from one packed block, or body by body where few are asked for."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from stability_core.port import FloatArray, IntArray

STATE_ALONE, POSITION_ALONE = 50, 15
"""What a body asked alone costs, in bodies of the packed block, of which each in the world costs 0.2 us: 10 us for its
state, 3 us for its position."""


class BodyStates:
    """Reads the states of the bodies of a system; ``components`` and ``bodies`` are the adapter's own records."""

    def __init__(self, system: Any, components: Mapping[int, Any], bodies: Mapping[Any, int]) -> None:
        self._system = system
        self._components = components
        self._bodies = bodies
        self._rows = np.empty(0, np.int64)

    def count_rows(self) -> None:
        """Compute the row of each body in the packed block, by id, because SAPIEN's order changes with the bodies."""
        listed = [self._bodies[component] for component in self._system.rigid_dynamic_components]
        self._rows = np.full(max(listed, default=-1) + 1, -1)
        self._rows[listed] = np.arange(len(listed))

    def read(self, bodies: IntArray) -> FloatArray:
        """Return quaternion (w, x, y, z), position [m], velocity [m/s] and spin [rad/s], shape (n, 13)."""
        if 0 < len(bodies) * STATE_ALONE < len(self._components):
            return self._read_one_by_one(bodies)
        packed = np.frombuffer(self._system.pack(), np.float32).reshape(-1, 13)
        state: FloatArray = packed[self._rows[bodies]].astype(np.float64)
        return state

    def positions(self, bodies: IntArray) -> FloatArray:
        """Return the positions alone, shape (n, 3) [m]."""
        if len(bodies) * POSITION_ALONE < len(self._components):
            poses = [self._components[body].entity_pose.p for body in bodies.tolist()]
            return np.array(poses, np.float64).reshape(-1, 3)
        return self.read(bodies)[:, 4:7]

    def _read_one_by_one(self, bodies: IntArray) -> FloatArray:
        """Return the same numbers as the packed block, which holds every frozen body as well."""
        vectors: list[FloatArray] = []
        for body in bodies.tolist():
            component = self._components[body]
            pose = component.entity_pose
            vectors += (pose.q, pose.p, component.linear_velocity, component.angular_velocity)
        return np.concatenate(vectors, dtype=np.float64).reshape(-1, 13)
