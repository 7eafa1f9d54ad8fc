"""Approach velocities from the motions before the solver acts, for engines that do not report these velocities."""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np

from stability_core.port import FloatArray, IntArray


@dataclass(frozen=True, slots=True)
class Motions:
    """Positions and velocities of m bodies before each of the frame's s substeps. All other bodies are at rest."""

    body: IntArray
    """Ids of the bodies, in rising order, shape (m,)."""
    position: FloatArray
    """Centres of mass [m] in the world's frame, shape (s, m, 3)."""
    linear: FloatArray
    """Velocities [m/s] of the centres of mass, shape (s, m, 3)."""
    angular: FloatArray
    """Angular velocities [rad/s] in the world's frame, shape (s, m, 3)."""


def fastest_approach(
    before: Motions | None, a: IntArray, b: IntArray, point: FloatArray, normal: FloatArray, noise: float = 0.0
) -> FloatArray:
    """Return velocities of b relative to a at n contact points, before the substep with the fastest approach.

    Args:
        before: motions in the frame; None without a record.
        a: first bodies, shape (n,).
        b: second bodies, shape (n,).
        point: contact points [m] in the world's frame, shape (n, 3).
        normal: unit normals from a to b, shape (n, 3).
        noise: margin [m/s] by which an approach must be faster to replace the approach of an earlier substep. The
            approaches of bodies at rest differ only by the solver's noise, so that the margin keeps the first substep.
            The first substep matters, because later substeps do not show the slip of a support that friction has
            stopped.

    Returns:
        Velocities [m/s], shape (n, 3); NaN if the frame has no recorded motions, for example without live bodies.
    """
    velocity = np.full(point.shape, np.nan)
    if before is not None and len(before.body):
        _fastest(before.body, before.position, before.linear, before.angular, a, b, point, normal, noise, velocity)
    return velocity


@numba.njit(
    "(int64[:], float64[:, :, :], float64[:, :, :], float64[:, :, :], int64[:], int64[:], float64[:, :], float64[:, :],"
    " float64, float64[:, :])",
    cache=True,
)
def _fastest(
    body: IntArray,
    position: FloatArray,
    linear: FloatArray,
    angular: FloatArray,
    a: IntArray,
    b: IntArray,
    point: FloatArray,
    normal: FloatArray,
    noise: float,
    chosen: FloatArray,
) -> None:
    """Write the velocities that ``fastest_approach`` returns into ``chosen`` (n, 3).

    Numba compiles the function, because a dozen NumPy calls take longer than an engine's step.
    """
    for row in range(len(point)):
        x, y, z = point[row]
        fastest = np.inf
        for substep in range(len(position)):
            velocity = (0.0, 0.0, 0.0)
            for sign, member in ((-1.0, a[row]), (1.0, b[row])):
                k = np.searchsorted(body, member)
                if k == len(body) or body[k] != member:
                    continue  # a frozen body or the ground
                (cx, cy, cz), (wx, wy, wz) = position[substep, k], angular[substep, k]
                vx, vy, vz = linear[substep, k]
                rx, ry, rz = x - cx, y - cy, z - cz
                velocity = (
                    velocity[0] + sign * (vx + (wy * rz - wz * ry)),
                    velocity[1] + sign * (vy + (wz * rx - wx * rz)),
                    velocity[2] + sign * (vz + (wx * ry - wy * rx)),
                )
            closing = velocity[0] * normal[row, 0] + velocity[1] * normal[row, 1] + velocity[2] * normal[row, 2]
            if closing < fastest - noise:
                fastest = closing
                chosen[row, 0], chosen[row, 1], chosen[row, 2] = velocity
