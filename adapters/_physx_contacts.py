"""PhysX's contact points: selection of the points that touch, and their impulses."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from stability_core.port import FloatArray, IntArray

MAX_SEPARATION = 1e-3
"""Greatest gap [m] of a point that the adapter reads: twice the gap that the core counts as touching, so that the core
gets every point that touches."""

Listed = tuple[int, int, list[Any]]
"""Bodies a and b of a pair, and PhysX's points of the pair."""


def touching_points(listed: Iterable[Listed], scale: float) -> tuple[tuple[IntArray, IntArray], FloatArray]:
    """Return the contact points that touch or have a gap of at most ``MAX_SEPARATION``.

    Args:
        listed: pairs with their points.
        scale: ratio of lengths in the engine's world to lengths in the scene.

    Returns:
        Bodies a and b, each of shape (n,), and an array of shape (n, 10) with the columns:

        - 0 to 2: position [m];
        - 3 to 5: normal;
        - 6: separation [m];
        - 7 to 9: impulse [N s].
    """
    body_a: list[int] = []
    body_b: list[int] = []
    rows: list[tuple[float, ...]] = []
    for a, b, points in listed:
        normal = points[0].normal.tolist()
        for point in points:
            impulse = point.impulse.tolist()
            separation = _separation(point.separation, scale, is_pressed=any(impulse))
            if separation is not None:
                body_a.append(a)
                body_b.append(b)
                rows.append((*point.position.tolist(), *normal, separation, *impulse))
    return (np.array(body_a, np.int64), np.array(body_b, np.int64)), np.array(rows, np.float64).reshape(-1, 10)


def all_impulses(listed: Iterable[Listed]) -> tuple[tuple[IntArray, IntArray], FloatArray]:
    """Return bodies a and b, each of shape (n,), and the impulses (n, 3) [N s] of all points."""
    body_a: list[int] = []
    body_b: list[int] = []
    impulses: list[FloatArray] = []
    for a, b, points in listed:
        body_a += [a] * len(points)
        body_b += [b] * len(points)
        impulses += [point.impulse for point in points]
    pairs = np.array(body_a, np.int64), np.array(body_b, np.int64)
    return pairs, np.array(impulses, np.float64).reshape(-1, 3)


def _separation(separation: float, scale: float, *, is_pressed: bool) -> float | None:
    """Return the separation [m] of a point: 0 if the point presses across a gap, None if the gap is too large."""
    if separation <= 0.0:
        return separation
    if is_pressed:
        return 0.0
    return separation if separation <= MAX_SEPARATION * scale else None
