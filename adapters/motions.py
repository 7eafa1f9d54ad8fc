"""Velocities from before each substep: engines report contacts when their solver has already stopped the approach."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stability_core.port import FloatArray, IntArray


@dataclass(frozen=True, slots=True)
class Motion:
    """Where m bodies are, and how fast."""

    position: FloatArray
    """Centres of mass [m], shape (m, 3)."""
    linear: FloatArray
    """Velocities [m/s], shape (m, 3)."""
    angular: FloatArray
    """Angular velocities [rad/s], shape (m, 3)."""


class Motions:
    """How the m live bodies of a frame moved before each of its s substeps."""

    def __init__(self, bodies: IntArray, motions: Sequence[Motion]) -> None:
        """Args: bodies: ids, rising, shape (m,); motions: one a substep, its rows in the order of ``bodies``."""
        self._bodies = bodies
        self._position = np.stack([motion.position for motion in motions])
        self._linear = np.stack([motion.linear for motion in motions])
        self._angular = np.stack([motion.angular for motion in motions])

    def fastest_approach(self, a: IntArray, b: IntArray, point: FloatArray, normal: FloatArray) -> FloatArray:
        """Velocity [m/s] of b against a, shape (n, 3), before the substep in which they approached each other fastest.

        Args:
            a: ids, shape (n,).
            b: ids, shape (n,).
            point: contact points [m], shape (n, 3).
            normal: unit normals from a to b, shape (n, 3).
        """
        if not len(self._bodies):
            return np.full(point.shape, np.nan)  # all were woken after the latest step
        velocity = self._at(b, point) - self._at(a, point)
        fastest = np.einsum("sni,ni->sn", velocity, normal).argmin(axis=0)
        chosen: FloatArray = velocity[fastest, np.arange(len(fastest))]
        return chosen

    def _at(self, bodies: IntArray, points: FloatArray) -> FloatArray:
        """Velocity [m/s] of each body at its point, shape (s, n, 3); zero for what is frozen and for the ground."""
        row = np.minimum(np.searchsorted(self._bodies, bodies), len(self._bodies) - 1)
        velocity = self._linear[:, row] + np.cross(self._angular[:, row], points - self._position[:, row])
        return np.where((self._bodies[row] == bodies)[:, None], velocity, 0.0)
