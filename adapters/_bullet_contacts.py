"""Columns of PyBullet's contact rows (``getContactPoints``)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from adapters.shared.vectors import rows_of
from stability_core.port import FloatArray, IntArray

Listed = tuple[int, int, tuple[Any, ...]]
"""Bodies a and b of a contact, and Bullet's row of the contact."""


def pairs_of(listed: Sequence[Listed]) -> tuple[IntArray, IntArray]:
    """Return bodies a and b of contacts, each of shape (n,)."""
    pairs = np.array([pair[:2] for pair in listed], np.int64).reshape(-1, 2)
    return pairs[:, 0], pairs[:, 1]


def geometry_of(listed: Sequence[Listed]) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return points (n, 3) [m], normals (n, 3) from a to b, and separations (n,) [m], in the world's frame."""
    numbers = rows_of([(*row[5], *row[6], *row[7], row[8]) for _, _, row in listed], 10)
    point = (numbers[:, :3] + numbers[:, 3:6]) / 2
    normal = -numbers[:, 6:9]  # Bullet's normal points from b to a
    return point, normal, numbers[:, 9]


def forces_of(listed: Sequence[Listed]) -> FloatArray:
    """Return forces (n, 3) [N] on body b: the sum of the normal force and of friction in its two directions."""
    numbers = rows_of([(*row[7], row[9], *row[11], row[10], *row[13], row[12]) for _, _, row in listed], 12)
    directions, sizes = numbers.reshape(-1, 3, 4)[..., :3], numbers.reshape(-1, 3, 4)[..., 3:]
    forces: FloatArray = -(sizes * directions).sum(axis=1)
    return forces
