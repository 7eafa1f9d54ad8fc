"""Advance of the poses of a reference engine's boxes by their velocities.

A live box turns about its spin by the exact rotation exp(h omega). Then free precession changes the spin omega: the
angular momentum R I R^T omega keeps its direction and size. If the kinetic energy would rise, the kernel shortens the
spin to its former energy.
"""

from __future__ import annotations

import math

import numba
import numpy as np

from adapters.reference.box_pair import axes_of, dot
from adapters.reference.boxes import LIVE, MOVED, BoxArrays, StateArray
from stability_core.port import FloatArray, IntArray


def advance(boxes: BoxArrays, seconds: float) -> None:
    """Move the live boxes and the boxes that the host moves by their velocities for ``seconds``."""
    n = boxes.count
    _advance(boxes.state[:n], boxes.position, boxes.quaternion, boxes.velocity, boxes.spin, boxes.inertia, seconds)


def displace(boxes: BoxArrays, rows: IntArray, shift: FloatArray, turn: FloatArray) -> None:
    """Shift boxes by ``shift`` (k, 3) [m] and turn them by ``turn`` (k, 3) [rad], without a change of velocities."""
    boxes.position[rows] += shift
    _turn_rows(rows, boxes.quaternion, turn)


@numba.njit(cache=True)
def _turned(quaternion: FloatArray, turn: FloatArray) -> FloatArray:
    """Return a quaternion (4,) after a rotation by a vector (3,) [rad] in the world's frame."""
    angle = math.sqrt(dot(turn, turn))
    share = math.sin(angle / 2) / angle if angle > 1e-12 else 0.5
    w, x, y, z = math.cos(angle / 2), share * turn[0], share * turn[1], share * turn[2]
    a, b, c, d = quaternion[0], quaternion[1], quaternion[2], quaternion[3]
    turned = np.empty(4)
    turned[0], turned[1] = w * a - x * b - y * c - z * d, w * b + x * a + y * d - z * c
    turned[2], turned[3] = w * c - x * d + y * a + z * b, w * d + x * c - y * b + z * a
    return turned / math.sqrt(turned[0] ** 2 + turned[1] ** 2 + turned[2] ** 2 + turned[3] ** 2)


@numba.njit(cache=True)
def _turn_rows(rows: IntArray, quaternion: FloatArray, turn: FloatArray) -> None:
    """Turn the boxes of ``rows`` (k,) by vectors (k, 3) [rad]."""
    for i in range(len(rows)):
        quaternion[rows[i]] = _turned(quaternion[rows[i]], turn[i])


@numba.njit(cache=True)
def _advance(
    state: StateArray,
    position: FloatArray,
    quaternion: FloatArray,
    velocity: FloatArray,
    spin: FloatArray,
    inertia: FloatArray,
    seconds: float,
) -> None:
    """Advance poses by velocities, and the spins of live boxes by free precession."""
    for row in range(len(state)):
        if state[row] != LIVE and state[row] != MOVED:
            continue
        position[row] += seconds * velocity[row]
        if dot(spin[row], spin[row]) == 0.0:
            continue
        before = axes_of(quaternion[row])
        quaternion[row] = _turned(quaternion[row], seconds * spin[row])
        if state[row] == MOVED:
            continue
        after = axes_of(quaternion[row])
        momentum = np.zeros(3)
        energy = 0.0
        for k in range(3):
            along = dot(before[k], spin[row])
            energy += inertia[row, k] * along * along
            momentum += inertia[row, k] * along * before[k]
        fresh = np.zeros(3)
        later = 0.0
        for k in range(3):
            along = dot(after[k], momentum) / inertia[row, k]
            later += inertia[row, k] * along * along
            fresh += along * after[k]
        spin[row] = fresh * min(1.0, math.sqrt(energy / later))
