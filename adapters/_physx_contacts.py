"""SAPIEN's contact points: which of them touch, and their impulses."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from stability_core.port import FloatArray, IntArray

MAX_SEPARATION = 1e-3
"""Points farther apart than this [m] are not read: twice what the core takes for touch."""

Listed = tuple[int, int, list[Any]]
"""Bodies a and b of a pair, and PhysX's points of it."""


def touching_points(listed: Iterable[Listed], scale: float) -> tuple[tuple[IntArray, IntArray], FloatArray]:
    """Return the points that touch or nearly do.

    Args:
        listed: pairs with their points.
        scale: lengths in the engine's world over those of the scene.

    Returns:
        Bodies a and b, each of shape (n,); and position [m], normal, separation [m], impulse [N s], shape (n, 10).
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
    """Return the separation [m] of a point that touches or nearly does, 0 where the solver let it bear; else None."""
    if separation <= 0.0:
        return separation
    if is_pressed:
        return 0.0
    return separation if separation <= MAX_SEPARATION * scale else None
