"""How fast pairs of MuJoCo's geoms approached in each substep of a frame, of which the fastest counts."""

from __future__ import annotations

import numpy as np

from adapters.shared.vectors import dot
from stability_core.port import FloatArray, IntArray

_MAX_GEOMS = np.int64(1 << 31)


class Approaches:
    """The approaches of a frame's substeps but the last."""

    def __init__(self) -> None:
        self._substeps: list[tuple[IntArray, FloatArray, FloatArray]] = []  # pairs, speed along the normal, velocity

    def clear(self) -> None:
        """Begin a frame."""
        self._substeps.clear()

    def add(self, geoms: IntArray, normals: FloatArray, velocity: FloatArray) -> None:
        """Record a substep: geoms (n, 2), normals (n, 3), velocities (n, 3) [m/s] of the second against the first."""
        self._substeps.append((_pairs(geoms), dot(velocity, normals), velocity))

    def fastest(self, geoms: IntArray, normals: FloatArray, velocity: FloatArray) -> FloatArray:
        """Return ``velocity``, or that of the pair in an earlier substep where it approached faster."""
        pairs, speed = _pairs(geoms), dot(velocity, normals)
        for earlier_pairs, earlier_speed, earlier_velocity in self._substeps:
            order = np.lexsort((earlier_speed, earlier_pairs))  # of each pair, the fastest approach comes first
            first = np.searchsorted(earlier_pairs[order], pairs)
            known = np.flatnonzero(first < len(order))
            match = order[first[known]]
            faster = (earlier_pairs[match] == pairs[known]) & (earlier_speed[match] < speed[known])
            rows, match = known[faster], match[faster]
            speed[rows], velocity[rows] = earlier_speed[match], earlier_velocity[match]
        return velocity


def _pairs(geoms: IntArray) -> IntArray:
    """Return a number (n,) for each pair of geoms, in their order."""
    return geoms[:, 0] * _MAX_GEOMS + geoms[:, 1]
