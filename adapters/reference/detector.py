"""Contact detection among the boxes of a world: sweep and prune along x, then ``box_pair.collide`` for each near pair.

Reach: a step needs the points that will touch before the end of the step. The detector lists a point with the gap g if

    g <= SLACK + h max(0, -n . v) + h^2 |n . gravity|,

where n is the normal from a to b, v the velocity of b relative to a at the point, and h the length of the step.

``box_pair`` compiles some of the kernels: see ADR-0002 on Numba's cache.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numba
import numpy as np

from adapters.reference.box_pair import FACE_PREFERENCE, MOST_POINTS, SAME_POINT, axes_of, collide, dot
from adapters.reference.boxes import ABSENT, LIVE, BoxArrays, StateArray
from stability_core.port import FloatArray, IntArray

SLACK = 0.1e-3
"""Gap [m] up to which the detector lists points at rest. The value is the port's gap of faces that nearly touch, so
that the core sees all corners of a contact area. Lengths of a larger world are larger: see ``BoxDetector``."""


@dataclass(frozen=True, slots=True)
class FoundContacts:
    """Points of n contacts. Rows are rows of ``BoxArrays``."""

    row_a: IntArray
    row_b: IntArray
    point: FloatArray
    """Middle of the gap [m], shape (n, 3)."""
    normal: FloatArray
    """Unit normals from a to b, shape (n, 3)."""
    gap: FloatArray
    """Separations [m], negative for overlaps, shape (n,)."""

    def __len__(self) -> int:
        return len(self.gap)


class BoxDetector:
    """Contact detection in a world whose lengths are ``scale`` times the scene's lengths."""

    def __init__(self, scale: float) -> None:
        self._lengths = np.array([SLACK, FACE_PREFERENCE, SAME_POINT]) * scale

    def find(self, boxes: BoxArrays, gravity: FloatArray, seconds: float) -> FoundContacts:
        """Return the contacts that touch a live box.

        Args:
            boxes: the boxes at their present poses.
            gravity: gravity [m/s2], shape (3,).
            seconds: length of the step [s]; 0 for the contacts at the present poses.
        """
        n = boxes.count
        columns = _find(
            boxes.position[:n], boxes.quaternion[:n], boxes.velocity[:n], boxes.spin[:n], boxes.half[:n],
            boxes.state[:n], gravity, seconds, self._lengths,
        )  # fmt: skip
        return FoundContacts(*columns)


@numba.njit(cache=True)
def _find(
    position: FloatArray,
    quaternion: FloatArray,
    velocity: FloatArray,
    spin: FloatArray,
    half: FloatArray,
    state: StateArray,
    gravity: FloatArray,
    seconds: float,
    lengths: FloatArray,
) -> tuple[IntArray, IntArray, FloatArray, FloatArray, FloatArray]:
    """Return rows a, rows b, points, normals and gaps of the contacts that touch a live box."""
    axes = np.empty((len(state), 3, 3))
    low, high = np.empty((len(state), 3)), np.empty((len(state), 3))
    pull = math.sqrt(dot(gravity, gravity)) * seconds * seconds
    for row in range(len(state)):
        if state[row] != ABSENT:
            axes[row] = axes_of(quaternion[row])
            turning = math.sqrt(dot(half[row], half[row]) * dot(spin[row], spin[row]))
            speed = math.sqrt(dot(velocity[row], velocity[row])) + turning
            _write_extent(position[row], axes[row], half[row], lengths[0] + seconds * speed + pull, low[row], high[row])
        else:
            low[row] = high[row] = np.inf
    pairs = _near_pairs(low, high, state)
    room = MOST_POINTS * len(pairs)
    rows, point, normal, gap = np.empty((room, 2), np.int64), np.empty((room, 3)), np.empty((room, 3)), np.empty(room)
    corner, depth, direction = np.empty((MOST_POINTS, 3)), np.empty(MOST_POINTS), np.empty(3)
    found = 0
    for pair in range(len(pairs)):
        a, b = pairs[pair]
        points = collide(
            position[a], axes[a], half[a], position[b], axes[b], half[b], lengths, corner, depth, direction
        )
        base = lengths[0] + seconds * seconds * abs(dot(gravity, direction))
        for k in range(points):
            closing = 0.0
            if seconds > 0.0:
                closing = max(0.0, -_approach(a, b, corner[k], direction, position, velocity, spin))
            if depth[k] <= base + seconds * closing:
                rows[found], point[found], normal[found], gap[found] = pairs[pair], corner[k], direction, depth[k]
                found += 1
    return rows[:found, 0].copy(), rows[:found, 1].copy(), point[:found], normal[:found], gap[:found]


@numba.njit(cache=True)
def _write_extent(
    center: FloatArray, axes: FloatArray, half: FloatArray, reach: float, low: FloatArray, high: FloatArray
) -> None:
    """Write the bounds (3,) of a box, enlarged by ``reach`` [m]."""
    for k in range(3):
        extent = reach
        for j in range(3):
            extent += half[j] * abs(axes[j, k])
        low[k], high[k] = center[k] - extent, center[k] + extent


@numba.njit(cache=True)
def _near_pairs(low: FloatArray, high: FloatArray, state: StateArray) -> IntArray:
    """Return the pairs (k, 2) of boxes whose bounds overlap, the lower row first, with at least one live box."""
    order = np.argsort(low[:, 0])
    pairs = np.empty((4 * len(order) + 16, 2), np.int64)
    count = 0
    for place in range(len(order)):
        i = order[place]
        for later in range(place + 1, len(order)):
            j = order[later]
            if not low[j, 0] <= high[i, 0] or state[j] == ABSENT:
                break
            if state[i] != LIVE and state[j] != LIVE:
                continue
            if low[i, 1] > high[j, 1] or low[j, 1] > high[i, 1] or low[i, 2] > high[j, 2] or low[j, 2] > high[i, 2]:
                continue
            if count == len(pairs):
                pairs = np.concatenate((pairs, np.empty_like(pairs)))
            pairs[count, 0], pairs[count, 1] = min(i, j), max(i, j)
            count += 1
    return pairs[:count]


@numba.njit(cache=True)
def _approach(
    a: int,
    b: int,
    point: FloatArray,
    normal: FloatArray,
    position: FloatArray,
    velocity: FloatArray,
    spin: FloatArray,
) -> float:
    """Return the velocity [m/s] of b relative to a at a point, along the normal."""
    total = 0.0
    for row, sign in ((a, -1.0), (b, 1.0)):
        r = point - position[row]
        w = spin[row]
        total += sign * (
            normal[0] * (velocity[row, 0] + w[1] * r[2] - w[2] * r[1])
            + normal[1] * (velocity[row, 1] + w[2] * r[0] - w[0] * r[2])
            + normal[2] * (velocity[row, 2] + w[0] * r[1] - w[1] * r[0])
        )
    return total
