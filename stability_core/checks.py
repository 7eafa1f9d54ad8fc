"""Is what the port gave well formed? Bad input is refused before it can spoil the stack."""

from __future__ import annotations

import numpy as np

from stability_core.compiled import compiled
from stability_core.port import GROUND, Contacts, FloatArray, IntArray, Masses

MAX_BODY = 10_000_000
"""Greatest body id: tables have one row an id, so ids must be counted from 0, not be addresses."""

FINE, BAD_ID, BAD_NUMBER = 0, 1, 2


@compiled
def _first_bad_contact(
    body_a: IntArray, body_b: IntArray, point: FloatArray, normal: FloatArray, friction: FloatArray
) -> tuple[int, int]:
    for i in range(len(body_a)):
        a, b = body_a[i], body_b[i]
        if min(a, b) < GROUND or max(a, b) > MAX_BODY or a == b:
            return BAD_ID, i
        total = friction[i]
        length2 = 0.0
        for k in range(3):
            total += point[i, k]
            length2 += normal[i, k] ** 2
        if not np.isfinite(total) or not abs(length2 - 1.0) < 1e-3 or friction[i] < 0.0:
            return BAD_NUMBER, i
    return FINE, -1


@compiled
def _first_bad_mass(body: IntArray, mass: FloatArray, center: FloatArray) -> tuple[int, int]:
    for i in range(len(body)):
        if body[i] < 0 or body[i] > MAX_BODY:
            return BAD_ID, i
        total = center[i, 0] + center[i, 1] + center[i, 2]
        if not np.isfinite(total) or not (np.isfinite(mass[i]) and mass[i] > 0.0):
            return BAD_NUMBER, i
    return FINE, -1


def check_contacts(contacts: Contacts) -> None:
    """Refuse malformed contacts.

    Raises:
        ValueError: for arrays of unequal length, an impossible body id, a point that is not finite, a normal
            that is not of unit length, or friction that is negative or not finite.
    """
    n = len(contacts.body_a)
    for name in ("point", "normal", "relative_velocity"):
        if getattr(contacts, name).shape != (n, 3):
            raise ValueError(f"contacts.{name} must have shape ({n}, 3), got {getattr(contacts, name).shape}")
    for name in ("body_b", "separation", "friction"):
        if getattr(contacts, name).shape != (n,):
            raise ValueError(f"contacts.{name} must have shape ({n},), got {getattr(contacts, name).shape}")
    fault, row = _first_bad_contact(
        contacts.body_a, contacts.body_b, contacts.point, contacts.normal, contacts.friction
    )
    if fault == BAD_ID:
        raise ValueError(
            f"contact {row} joins bodies {contacts.body_a[row]} and {contacts.body_b[row]}: "
            f"a contact needs two different ids, -1 for the ground or 0 to {MAX_BODY}"
        )
    if fault == BAD_NUMBER:
        raise ValueError(
            f"contact {row} needs a finite point, a unit normal and a friction >= 0, got point "
            f"{contacts.point[row]}, normal {contacts.normal[row]}, friction {contacts.friction[row]}"
        )


def check_masses(masses: Masses) -> None:
    """Refuse malformed masses.

    Raises:
        ValueError: for arrays of unequal length, an impossible body id, a mass that is not positive and
            finite, or a centre of mass that is not finite.
    """
    m = len(masses.body)
    if masses.mass.shape != (m,) or masses.center_of_mass.shape != (m, 3):
        raise ValueError(
            f"masses of {m} bodies need mass of shape ({m},) and center_of_mass of shape ({m}, 3), "
            f"got {masses.mass.shape} and {masses.center_of_mass.shape}"
        )
    fault, row = _first_bad_mass(masses.body, masses.mass, masses.center_of_mass)
    if fault == BAD_ID:
        raise ValueError(f"body id {masses.body[row]} is out of range: number bodies from 0 to {MAX_BODY}")
    if fault == BAD_NUMBER:
        raise ValueError(
            f"body {masses.body[row]} needs a positive mass and a finite centre, "
            f"got {masses.mass[row]} kg at {masses.center_of_mass[row]}"
        )
