"""Calls of SAPIEN for contacts and freezing in PhysX 5, for the port and for the suite's adapter.

``freeze`` makes a body kinematic. No step of PhysX changes a bit of the pose of a kinematic body. PhysX does not
collide a kinematic body with the ground or with another kinematic body. ``unfreeze`` makes the body dynamic again, at
rest and awake. SAPIEN's ``put_to_sleep`` does not freeze a body, because the first touch wakes the body.

PhysX lists points with a gap of up to the sum of both shapes' contact offsets. Normals point from the second body to
the first, and all points of a pair of convex shapes share one normal.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Any, TypeAlias

import numpy as np

from stability_core.port import FloatArray, IntArray

MAX_SEPARATION = 1e-3
"""Greatest gap [m] of a contact point without an impulse. For a plank of 117 mm this is twice the greatest gap of a
contact in the core (``Settings.contact_gap``)."""

Component: TypeAlias = Any
"""A rigid body of SAPIEN: a component of an entity."""
Listed: TypeAlias = tuple[int, int, list[Any], Any]
"""Bodies a and b of a pair, PhysX's points of the pair, and PhysX's contact."""


def freeze(component: Component) -> None:
    """Make a dynamic body kinematic."""
    component.kinematic = True


def unfreeze(component: Component) -> None:
    """Make a kinematic body dynamic, at rest and awake."""
    component.kinematic = False
    stop(component)


def stop(component: Component) -> None:
    """Set the velocity and the angular velocity of a dynamic body to zero, and wake the body."""
    component.linear_velocity = component.angular_velocity = (0.0, 0.0, 0.0)
    component.wake_up()


def listed_pairs(
    contacts: Iterable[Any], body_of: Callable[[Component], int | None], concerns: Callable[[int, int], bool]
) -> Iterator[Listed]:
    """Yield the pairs that have a point and that ``concerns`` selects, by rising ids.

    SAPIEN lists pairs in the order of memory addresses. The order matters, because the port adds friction forces pair
    by pair, and another order changes the last bits of the sum.

    Args:
        contacts: contacts of a ``PhysxCpuSystem``.
        body_of: returns the id of a component; None for a body that left the scene after the latest step.
        concerns: returns True if the port needs the contacts of two bodies.
    """
    wanted = []
    for contact in contacts:
        first, second = contact.bodies
        a, b = body_of(second), body_of(first)
        if a is not None and b is not None and concerns(a, b):
            wanted.append((a, b, contact))
    for a, b, contact in sorted(wanted, key=lambda pair: pair[:2]):
        points = contact.points
        if points:
            yield a, b, points, contact


def touching_points(listed: Iterable[Listed], scale: float) -> tuple[tuple[IntArray, IntArray], FloatArray]:
    """Return the contact points without a gap, with a gap of at most ``MAX_SEPARATION``, or with an impulse.

    Args:
        listed: pairs from ``listed_pairs``.
        scale: ratio of lengths in the engine's world to lengths in the scene.

    Returns:
        Bodies a and b, each of shape (n,), and an array of shape (n, 10) with the columns:

        - 0 to 2: position [m] in the world's frame;
        - 3 to 5: unit normal from a to b;
        - 6: separation [m], 0 for a point with an impulse across a gap;
        - 7 to 9: impulse [N s] on b.
    """
    body_a: list[int] = []
    body_b: list[int] = []
    rows: list[tuple[float, ...]] = []
    for a, b, points, _ in listed:
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
    """Return bodies a and b, each of shape (n,), and the impulses (n, 3) [N s] on b, of all points of the pairs."""
    body_a: list[int] = []
    body_b: list[int] = []
    impulses: list[FloatArray] = []
    for a, b, points, _ in listed:
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
