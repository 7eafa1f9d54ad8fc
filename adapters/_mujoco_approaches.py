"""Approach velocities of pairs of MuJoCo's geoms in the substeps of a frame, and the fastest velocity of each pair."""

from __future__ import annotations

import numpy as np

from adapters.shared.vectors import dot
from stability_core.port import FloatArray, IntArray

_MAX_GEOMS = np.int64(1 << 31)


class Approaches:
    """Approach velocities in all substeps of a frame except the last."""

    def __init__(self) -> None:
        self._substeps: list[tuple[IntArray, FloatArray, FloatArray]] = []  # pairs, speed along the normal, velocity

    def clear(self) -> None:
        """Delete the record at the start of a frame."""
        self._substeps.clear()

    def add(self, geoms: IntArray, normals: FloatArray, velocity: FloatArray) -> None:
        """Record the approach velocities of one substep.

        Args:
            geoms: both geoms of each contact, shape (n, 2).
            normals: unit normals from the first geom to the second, shape (n, 3).
            velocity: velocities [m/s] of the second geom relative to the first, shape (n, 3).
        """
        self._substeps.append((_pairs(geoms), dot(velocity, normals), velocity))

    def fastest(self, geoms: IntArray, normals: FloatArray, velocity: FloatArray) -> FloatArray:
        """Return the velocity of each contact's pair in the substep in which the pair approached fastest.

        The method overwrites ``velocity`` by the result. The arguments have the same meaning as in ``add``, for the
        last substep.
        """
        pairs, speed = _pairs(geoms), dot(velocity, normals)
        for earlier_pairs, earlier_speed, earlier_velocity in self._substeps:
            order = np.lexsort((earlier_speed, earlier_pairs))  # by pair, and its fastest approach first
            first = np.searchsorted(earlier_pairs[order], pairs)
            known = np.flatnonzero(first < len(order))
            match = order[first[known]]
            faster = (earlier_pairs[match] == pairs[known]) & (earlier_speed[match] < speed[known])
            rows, match = known[faster], match[faster]
            speed[rows], velocity[rows] = earlier_speed[match], earlier_velocity[match]
        return velocity


def _pairs(geoms: IntArray) -> IntArray:
    """Return a number for each ordered pair of geoms (n, 2), shape (n,): equal pairs have equal numbers."""
    return geoms[:, 0] * _MAX_GEOMS + geoms[:, 1]
