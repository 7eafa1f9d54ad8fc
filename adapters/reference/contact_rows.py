"""Rows of the contact problem: the velocities at the contacts as a linear function of the bodies' scaled velocities.

Scaled velocity of a live body with mass m, principal moments I and rotation R:

    w = [sqrt(m) v, sqrt(I) R^T omega] / (sqrt(M) U),

where M is the mean mass of the live bodies. U = g0 h is the velocity that the Earth's gravity g0 adds in a step of
length h. In these units the kinetic energy is |w|^2 / 2 and the mass matrix is the unit matrix. A row J of a contact in
direction d gives

    J w + drive = d . (velocity of b - velocity of a at the point) / U,

where drive holds the velocities of bodies that the host moves. An impulse x along d, in units of M U, changes w by
J^T x.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numba
import numpy as np

from adapters.reference.box_pair import axes_of, dot
from adapters.reference.boxes import LIVE, MOVED, BoxArrays, StateArray
from adapters.reference.detector import FoundContacts
from stability_core.port import FloatArray, IntArray

EARTH = 9.81
"""Gravity [m/s2] of the unit of velocity, also in a world without gravity."""
SLIDING = 0.01
"""Tangential speed, in units of U, above which the first tangent follows the sliding direction. Slower motion is a
remainder of the solver, so that the first tangent follows the pull of gravity along the contact instead."""


@dataclass(frozen=True, slots=True)
class ContactRows:
    """The contact problem of one step: n contacts among m live bodies."""

    body: IntArray
    """Index of the live bodies a and b of each contact, -1 for a body that contacts do not move, shape (n, 2)."""
    jacobian: FloatArray
    """Rows of each contact along normal, first and second tangent, for bodies a and b, shape (n, 3, 2, 6)."""
    drive: FloatArray
    """Velocities along the rows from bodies that the host moves, in units of U, shape (n, 3)."""
    axes: FloatArray
    """Unit vectors of the rows in the world's frame, shape (n, 3, 3)."""
    gap: FloatArray
    """Gaps divided by the length that U covers in a step, shape (n,)."""
    start: FloatArray
    """Scaled velocities after gravity and steady forces, before contacts, shape (m, 6)."""
    pull: FloatArray
    """The part of ``start`` that gravity and steady forces add in the step, shape (m, 6)."""
    rows: IntArray
    """Row in ``BoxArrays`` of each live body, shape (m,)."""
    impulse_unit: float
    """M U [N s]."""
    velocity_unit: float
    """U [m/s]."""

    def __len__(self) -> int:
        return len(self.gap)


def contact_rows(
    boxes: BoxArrays, found: FoundContacts, gravity: FloatArray, seconds: float, unit: float
) -> ContactRows:
    """Return the contact problem of a step.

    Args:
        boxes: the boxes, with their velocities before the step.
        found: the contacts.
        gravity: gravity [m/s2], shape (3,).
        seconds: length of the step [s].
        unit: the velocity U [m/s].
    """
    rows = np.flatnonzero(boxes.state[: boxes.count] == LIVE)
    index = np.full(boxes.count, -1)
    index[rows] = np.arange(len(rows))
    mean = float(boxes.mass[rows].mean()) if len(rows) else 1.0
    start, pull = np.empty((len(rows), 6)), np.zeros((len(rows), 6))
    _scale(rows, boxes.quaternion, boxes.velocity, boxes.spin, boxes.mass, boxes.inertia, boxes.force,
           gravity, seconds, mean, unit, start, pull)  # fmt: skip
    n = len(found)
    jacobian, drive, axes = np.zeros((n, 3, 2, 6)), np.zeros((n, 3)), np.empty((n, 3, 3))
    _write_rows(found.row_a, found.row_b, found.point, found.normal, boxes.position, boxes.quaternion, boxes.velocity,
                boxes.spin, boxes.mass, boxes.inertia, boxes.state, gravity, seconds, mean, unit, jacobian, drive,
                axes)  # fmt: skip
    body = np.stack([index[found.row_a], index[found.row_b]], axis=1) if n else np.empty((0, 2), np.int64)
    gap = found.gap / (unit * seconds)
    return ContactRows(body, jacobian, drive, axes, gap, start, pull, rows, mean * unit, unit)


def set_velocities(boxes: BoxArrays, problem: ContactRows, scaled: FloatArray) -> None:
    """Write the velocities of the live boxes from their scaled velocities (m, 6)."""
    rows = problem.rows
    mean = problem.impulse_unit / problem.velocity_unit
    _unscale(rows, boxes.quaternion, boxes.mass, boxes.inertia, mean, problem.velocity_unit, scaled, boxes.velocity,
             boxes.spin)  # fmt: skip


@numba.njit(cache=True)
def _scale(
    rows: IntArray,
    quaternion: FloatArray,
    velocity: FloatArray,
    spin: FloatArray,
    mass: FloatArray,
    inertia: FloatArray,
    force: FloatArray,
    gravity: FloatArray,
    seconds: float,
    mean: float,
    unit: float,
    start: FloatArray,
    pull: FloatArray,
) -> None:
    """Write the scaled velocities (m, 6) after gravity and steady forces, and the change by gravity and forces."""
    for i in range(len(rows)):
        row = rows[i]
        axes = axes_of(quaternion[row])
        root = math.sqrt(mass[row] / mean) / unit
        for k in range(3):
            pull[i, k] = root * seconds * (gravity[k] + force[row, k] / mass[row])
            start[i, k] = root * velocity[row, k] + pull[i, k]
            start[i, 3 + k] = math.sqrt(inertia[row, k] / mean) / unit * dot(axes[k], spin[row])


@numba.njit(cache=True)
def _unscale(
    rows: IntArray,
    quaternion: FloatArray,
    mass: FloatArray,
    inertia: FloatArray,
    mean: float,
    unit: float,
    scaled: FloatArray,
    velocity: FloatArray,
    spin: FloatArray,
) -> None:
    """Write the velocities of live boxes from their scaled velocities (m, 6)."""
    for i in range(len(rows)):
        row = rows[i]
        axes = axes_of(quaternion[row])
        root = unit * math.sqrt(mean / mass[row])
        for k in range(3):
            velocity[row, k] = root * scaled[i, k]
            spin[row, k] = 0.0
        for j in range(3):
            turn = unit * math.sqrt(mean / inertia[row, j]) * scaled[i, 3 + j]
            for k in range(3):
                spin[row, k] += turn * axes[j, k]


@numba.njit(cache=True)
def _write_rows(
    row_a: IntArray,
    row_b: IntArray,
    point: FloatArray,
    normal: FloatArray,
    position: FloatArray,
    quaternion: FloatArray,
    velocity: FloatArray,
    spin: FloatArray,
    mass: FloatArray,
    inertia: FloatArray,
    state: StateArray,
    gravity: FloatArray,
    seconds: float,
    mean: float,
    unit: float,
    jacobian: FloatArray,
    drive: FloatArray,
    axes: FloatArray,
) -> None:
    """Write the rows, the driven velocities and the directions of all contacts."""
    for c in range(len(point)):
        slip = np.zeros(3)
        for side in range(2):
            row, sign = (row_a[c], -1.0) if side == 0 else (row_b[c], 1.0)
            r, w = point[c] - position[row], spin[row]
            slip[0] += sign * (velocity[row, 0] + w[1] * r[2] - w[2] * r[1])
            slip[1] += sign * (velocity[row, 1] + w[2] * r[0] - w[0] * r[2])
            slip[2] += sign * (velocity[row, 2] + w[0] * r[1] - w[1] * r[0])
            if state[row] == LIVE:
                slip += sign * seconds * gravity
        _write_axes(normal[c], slip, gravity, SLIDING * unit, axes[c])
        for side in range(2):
            row, sign = (row_a[c], -1.0) if side == 0 else (row_b[c], 1.0)
            r, w = point[c] - position[row], spin[row]
            turn = axes_of(quaternion[row])
            for k in range(3):
                d = axes[c, k]
                if state[row] == MOVED:
                    at_point = (
                        d[0] * (velocity[row, 0] + w[1] * r[2] - w[2] * r[1])
                        + d[1] * (velocity[row, 1] + w[2] * r[0] - w[0] * r[2])
                        + d[2] * (velocity[row, 2] + w[0] * r[1] - w[1] * r[0])
                    )
                    drive[c, k] += sign * at_point / unit
                if state[row] != LIVE:
                    continue
                root = sign * math.sqrt(mean / mass[row])
                lever = np.array([r[1] * d[2] - r[2] * d[1], r[2] * d[0] - r[0] * d[2], r[0] * d[1] - r[1] * d[0]])
                for j in range(3):
                    jacobian[c, k, side, j] = root * d[j]
                    jacobian[c, k, side, 3 + j] = sign * math.sqrt(mean / inertia[row, j]) * dot(lever, turn[j])


@numba.njit(cache=True)
def _write_axes(normal: FloatArray, slip: FloatArray, gravity: FloatArray, slow: float, axes: FloatArray) -> None:
    """Write the normal and two tangents (3, 3).

    The first tangent follows, in this order:

    1. the slip, unless the slip is slow;
    2. the tangential part of gravity, unless this part is less than a thousandth of gravity;
    3. the tangential part of the coordinate axis that is most nearly tangential.
    """
    tangent = slip - dot(slip, normal) * normal
    if dot(tangent, tangent) < slow * slow:
        tangent = gravity - dot(gravity, normal) * normal
        if dot(tangent, tangent) < 1e-6 * (1e-12 + dot(gravity, gravity)):
            tangent = np.zeros(3)
            tangent[np.argmin(np.abs(normal))] = 1.0
            tangent -= dot(tangent, normal) * normal
    tangent /= math.sqrt(dot(tangent, tangent))
    axes[0], axes[1] = normal, tangent
    axes[2, 0] = normal[1] * tangent[2] - normal[2] * tangent[1]
    axes[2, 1] = normal[2] * tangent[0] - normal[0] * tangent[2]
    axes[2, 2] = normal[0] * tangent[1] - normal[1] * tangent[0]
