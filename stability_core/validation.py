"""Validate the port's arrays, and raise an error for bad input before the core changes its tables."""

from __future__ import annotations

import operator
from collections.abc import Iterable
from dataclasses import fields

import numpy as np

from stability_core.compiled import compiled
from stability_core.frame_arrays import NO_FORCES, ContactArrays, MassArrays
from stability_core.port import GROUND, Contacts, FloatArray, Masses

_IDS = np.dtype(np.int64)
FINE, BAD_CONTACT, BAD_MASS, UNKNOWN_BODY, NO_ROOM, BAD_SHAPE, LISTED_TWICE, FLIPPED = range(8)


@compiled
def fit_together(contacts: ContactArrays, masses: MassArrays) -> bool:
    """Return True if the shapes of all arrays fit together.

    The check costs less per frame than ``check_shapes``, which names the faulty array.
    """
    m, n = len(masses.body), len(contacts.body_a)
    return bool(
        len(contacts.body_b) == len(contacts.separation) == len(contacts.friction) == n
        and contacts.point.shape == contacts.normal.shape == contacts.relative_velocity.shape == (n, 3)
        and (contacts.force.shape == NO_FORCES.shape or contacts.force.shape == (n, 3))
        and len(masses.mass) == m
        and masses.center.shape == (m, 3)
    )


@compiled
def first_bad_contact(contacts: ContactArrays) -> int:
    """Return the first malformed row of the contacts, or -1.

    A row is malformed in these cases:

    - an id is below -1, or both ids are the same;
    - the friction is negative or not finite;
    - the point is not finite;
    - the squared length of the normal differs from 1 by 1e-3 or more.
    """
    body_a, body_b = contacts.body_a, contacts.body_b
    point, normal, friction = contacts.point, contacts.normal, contacts.friction
    for i in range(len(body_a)):
        a, b = body_a[i], body_b[i]
        total = friction[i]
        length2 = 0.0
        for k in range(3):
            total += point[i, k]
            length2 += normal[i, k] ** 2
        fine = min(a, b) >= GROUND and a != b
        if not (fine and np.isfinite(total) and abs(length2 - 1.0) < 1e-3 and friction[i] >= 0.0):
            return i
    return -1


@compiled
def first_bad_mass(masses: MassArrays) -> int:
    """Return the first row with a negative id, a mass that is not positive, or a centre that is not finite, else -1."""
    body, mass, center = masses.body, masses.mass, masses.center
    for i in range(len(body)):
        total = center[i, 0] + center[i, 1] + center[i, 2]
        fine = body[i] >= 0 and np.isfinite(total)
        if not (fine and mass[i] > 0.0):  # false for NaN
            return i
    return -1


@compiled
def presses_down_from_below(center: FloatArray, point: FloatArray, normal: FloatArray, sign: float) -> bool:
    """Return True if a contact with the ground, below a body's centre, pushes the body down and away from the centre.

    On a convex body, such a normal points from b to a, against the convention.

    Args:
        center: centre of mass of the body [m], shape (3,).
        point: the contact [m], shape (3,).
        normal: unit normal from a to b, shape (3,).
        sign: 1 if the body is b, -1 if the body is a.
    """
    inward = 0.0
    for k in range(3):
        inward += sign * normal[k] * (center[k] - point[k])
    return bool(sign * normal[2] < 0.0 and point[2] < center[2] and inward < 0.0)


def check_ids(name: str, ids: object) -> None:
    """Check that ids are integers, because 0.5 would count as 0.

    Raises:
        ValueError: if ``ids`` is no NumPy array, or contains other values. The message names the array and the fix.
    """
    dtype = getattr(ids, "dtype", None)
    if dtype is _IDS:
        return
    kind = getattr(dtype, "kind", None)
    if kind is None:
        raise ValueError(
            f"{name} must be a NumPy array of integers, got {type(ids).__name__}: convert {name} with numpy.asarray"
        )
    if kind not in "iu" and len(ids):  # type: ignore[arg-type]  # an empty list makes an array of floats
        raise ValueError(f"{name} must hold integers, got an array of {dtype}: convert {name} with .astype(np.int64)")


def checked_removals(removed: Iterable[object]) -> list[int]:
    """Return the ids of removed bodies as plain integers.

    Raises:
        ValueError: for an id that is no integer from 0.
    """
    ids = []
    for body in removed:
        try:
            ids.append(operator.index(body))  # type: ignore[arg-type]
        except TypeError:
            raise ValueError(
                f"masses.removed must hold integer ids, got {body!r}: list the ids of removed bodies"
            ) from None
        if ids[-1] < 0:
            raise ValueError(
                f"masses.removed must hold ids of at least 0, got {body}: list only bodies, because the port cannot "
                "remove the ground"
            )
    return ids


def check_shapes(contacts: Contacts, masses: Masses) -> None:
    """Check that the shapes and types of the arrays fit together.

    Raises:
        ValueError: for a wrong shape or type. The message names the array and the required shape or type.
    """
    arrays = {f"contacts.{item.name}": getattr(contacts, item.name) for item in fields(contacts)}
    if contacts.force is None:
        del arrays["contacts.force"]
    arrays |= {f"masses.{name}": getattr(masses, name) for name in ("body", "mass", "center_of_mass")}
    for name, array in arrays.items():
        if not isinstance(array, np.ndarray):
            raise ValueError(
                f"{name} must be a NumPy array, got {type(array).__name__}: convert {name} with numpy.asarray"
            )
        if array.dtype.kind not in "iuf":
            raise ValueError(
                f"{name} must hold numbers, got an array of {array.dtype}: convert {name} with .astype(np.float64)"
            )
    n, m = len(contacts.body_a), len(masses.body)
    if not contacts.point.shape == contacts.normal.shape == contacts.relative_velocity.shape == (n, 3):
        raise ValueError(
            f"contacts.point, normal and relative_velocity must each have shape ({n}, 3), because the length of "
            f"contacts.body_a is {n}; got {contacts.point.shape}, {contacts.normal.shape} and "
            f"{contacts.relative_velocity.shape}: give one row per contact point"
        )
    if not contacts.body_b.shape == contacts.separation.shape == contacts.friction.shape == (n,):
        raise ValueError(
            f"contacts.body_b, separation and friction must each have shape ({n},), because the length of "
            f"contacts.body_a is {n}; got {contacts.body_b.shape}, {contacts.separation.shape} and "
            f"{contacts.friction.shape}: give one value per contact point"
        )
    if contacts.force is not None and contacts.force.shape != (n, 3):
        raise ValueError(
            f"contacts.force must be None or have shape ({n}, 3), because the length of contacts.body_a is {n}; got "
            f"{contacts.force.shape}: give one force per contact point"
        )
    if masses.mass.shape != (m,) or masses.center_of_mass.shape != (m, 3):
        raise ValueError(
            f"masses.mass must have shape ({m},), and masses.center_of_mass ({m}, 3), because the length of "
            f"masses.body is {m}; got {masses.mass.shape} and {masses.center_of_mass.shape}: give one row per body"
        )


def fault_of(fault: int, row: int, contacts: Contacts, masses: Masses) -> ValueError:
    """Return the error for a malformed row. The message states the row's content and the fix."""
    if fault == BAD_MASS:
        return ValueError(
            f"masses row {row}: body {masses.body[row]} needs an id of at least 0, a positive mass and a finite "
            f"centre, got {masses.mass[row]} kg at {masses.center_of_mass[row]} m: correct this row of masses()"
        )
    if fault == LISTED_TWICE:
        return ValueError(
            f"masses row {row}: body {masses.body[row]} must have one row, but is listed twice: list each body once"
        )
    pair = f"contact {row} joins bodies {contacts.body_a[row]} and {contacts.body_b[row]}"
    if fault == UNKNOWN_BODY:
        return ValueError(
            f"{pair}, but masses() never listed one of these bodies, or listed it as removed: list every body in "
            "masses() when its contacts begin. If an earlier extension on this port froze the body, call close() of "
            "that extension first"
        )
    if fault == FLIPPED:
        return ValueError(
            f"{pair}, and its normal {contacts.normal[row]} pushes the body down from below, but normals must point "
            "from body_a to body_b: change the sign of all normals that point from b to a"
        )
    return ValueError(
        f"{pair}: a contact needs two different ids (-1 for the ground, or at least 0), a finite point, a unit normal "
        f"and a friction of at least 0, got point {contacts.point[row]} m, normal {contacts.normal[row]}, friction "
        f"{contacts.friction[row]}: correct this row of contacts()"
    )
