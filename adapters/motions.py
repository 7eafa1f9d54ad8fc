"""How the live bodies moved before the solver stopped them, for engines that report no approach speed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stability_core.port import FloatArray, IntArray


@dataclass(frozen=True, slots=True)
class Motions:
    """Where the m live bodies were, and how fast, before each of the frame's s substeps."""

    body: IntArray
    """Ids, rising, shape (m,)."""
    position: FloatArray
    """Centres of mass [m], shape (s, m, 3)."""
    linear: FloatArray
    """Velocities [m/s], shape (s, m, 3)."""
    angular: FloatArray
    """Angular velocities [rad/s], shape (s, m, 3)."""

    def at(self, bodies: IntArray, points: FloatArray) -> FloatArray:
        """Velocity [m/s] of each body at its point, shape (s, n, 3); zero for what is frozen and for the ground."""
        row = np.minimum(np.searchsorted(self.body, bodies), len(self.body) - 1)
        velocity = self.linear[:, row] + np.cross(self.angular[:, row], points - self.position[:, row])
        return np.where((self.body[row] == bodies)[:, None], velocity, 0.0)


def fastest_approach(
    before: Motions | None, a: IntArray, b: IntArray, point: FloatArray, normal: FloatArray
) -> FloatArray:
    """Velocity [m/s] of b against a at n contact points, before the substep in which they came closer fastest.

    Args:
        before: the frame's motions; None if nobody watched it.
        a: first bodies, shape (n,).
        b: second bodies, shape (n,).
        point: contact points [m], shape (n, 3).
        normal: unit normals from a to b, shape (n, 3).

    Returns:
        Velocities, shape (n, 3); NaN where nothing was live in that frame, for bodies that were woken since.
    """
    if before is None or not len(before.body):
        return np.full(point.shape, np.nan)
    velocity = before.at(b, point) - before.at(a, point)
    fastest = np.einsum("sni,ni->sn", velocity, normal).argmin(axis=0)
    chosen: FloatArray = velocity[fastest, np.arange(len(fastest))]
    return chosen
