"""Is what the port gave well formed? Bad input is refused before it can spoil the stack."""

from __future__ import annotations

import numpy as np

from stability_core.compiled import compiled
from stability_core.port import GROUND, Contacts, FloatArray, IntArray, Masses

MAX_BODY = 10_000_000
"""Greatest body id: tables have one row an id, so ids must be counted from 0, not be addresses."""

FINE, BAD_CONTACT, BAD_MASS, UNKNOWN_BODY, NO_ROOM, BAD_SHAPE = range(6)


@compiled
def fit_together(
    body: IntArray,
    body_a: IntArray,
    body_b: IntArray,
    mass: FloatArray,
    center: FloatArray,
    point: FloatArray,
    normal: FloatArray,
    separation: FloatArray,
    relative_velocity: FloatArray,
    friction: FloatArray,
) -> bool:
    """True if the arrays belong together, as ``check_shapes`` has it, at less cost a frame."""
    m, n = len(body), len(body_a)
    return bool(
        len(body_b) == len(separation) == len(friction) == n
        and point.shape == normal.shape == relative_velocity.shape == (n, 3)
        and len(mass) == m
        and center.shape == (m, 3)
    )


@compiled
def first_bad_contact(
    body_a: IntArray, body_b: IntArray, point: FloatArray, normal: FloatArray, friction: FloatArray
) -> int:
    """First row with impossible ids, a point that is not finite, no unit normal or no friction; -1 if all are fine."""
    for i in range(len(body_a)):
        a, b = body_a[i], body_b[i]
        total = friction[i]
        length2 = 0.0
        for k in range(3):
            total += point[i, k]
            length2 += normal[i, k] ** 2
        fine = min(a, b) >= GROUND and max(a, b) <= MAX_BODY and a != b
        if not (fine and np.isfinite(total) and abs(length2 - 1.0) < 1e-3 and friction[i] >= 0.0):
            return i
    return -1


@compiled
def first_bad_mass(body: IntArray, mass: FloatArray, center: FloatArray) -> int:
    """First row with an impossible id, a mass that is not positive, or a centre that is not finite; -1 if none is."""
    for i in range(len(body)):
        total = center[i, 0] + center[i, 1] + center[i, 2]
        fine = 0 <= body[i] <= MAX_BODY and np.isfinite(total)
        if not (fine and np.isfinite(mass[i]) and mass[i] > 0.0):
            return i
    return -1


def check_shapes(contacts: Contacts, masses: Masses) -> None:
    """Refuse arrays that do not belong together.

    Raises:
        ValueError: naming the array and the shape it must have.
    """
    n, m = len(contacts.body_a), len(masses.body)
    if not contacts.point.shape == contacts.normal.shape == contacts.relative_velocity.shape == (n, 3):
        raise ValueError(f"contacts.point, normal and relative_velocity must have shape ({n}, 3), as body_a has {n}")
    if not contacts.body_b.shape == contacts.separation.shape == contacts.friction.shape == (n,):
        raise ValueError(f"contacts.body_b, separation and friction must have shape ({n},), as body_a has {n}")
    if masses.mass.shape != (m,) or masses.center_of_mass.shape != (m, 3):
        raise ValueError(f"masses.mass must have shape ({m},) and center_of_mass ({m}, 3), as body has {m}")


def fault_of(fault: int, row: int, contacts: Contacts, masses: Masses) -> ValueError:
    """The error for a malformed row, which names what was got and what is needed."""
    if fault == BAD_MASS:
        return ValueError(
            f"masses row {row}: body {masses.body[row]} needs an id from 0 to {MAX_BODY}, a positive mass and a "
            f"finite centre, got {masses.mass[row]} kg at {masses.center_of_mass[row]}"
        )
    pair = f"contact {row} joins bodies {contacts.body_a[row]} and {contacts.body_b[row]}"
    if fault == UNKNOWN_BODY:
        return ValueError(f"{pair}, one of which masses() has never listed, or which was removed")
    return ValueError(
        f"{pair}: it needs two different ids (-1 for the ground, or 0 to {MAX_BODY}), a finite point, a unit normal "
        f"and a friction >= 0, got point {contacts.point[row]}, normal {contacts.normal[row]}, "
        f"friction {contacts.friction[row]}"
    )
