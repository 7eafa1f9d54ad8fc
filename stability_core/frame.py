"""One look at the world: all that a quiet frame costs, in one compiled call."""

from __future__ import annotations

import numpy as np

from stability_core.checks import BAD_CONTACT, BAD_MASS, FINE, NO_ROOM, UNKNOWN_BODY, first_bad_contact, first_bad_mass
from stability_core.compiled import compiled
from stability_core.contact_filter import CONTACT, ContactRows, keep_contacts
from stability_core.motion import count_frames, due, shifted_loads, track
from stability_core.port import GROUND, FloatArray, IntArray
from stability_core.settings import Limits
from stability_core.stack import ABSENT, Bodies


@compiled
def _greatest(ids: IntArray) -> int:
    greatest = GROUND
    for body in ids:
        greatest = max(greatest, body)
    return greatest


@compiled
def _first_unknown(bodies: Bodies, ids: IntArray) -> int:
    for i in range(len(ids)):
        if ids[i] != GROUND and bodies[ids[i]].state == ABSENT:
            return i
    return -1


@compiled
def observe(
    bodies: Bodies,
    limits: Limits,
    dt: float,
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
) -> tuple[int, int, ContactRows, IntArray, IntArray, IntArray, IntArray, IntArray]:
    """Track the live bodies, filter the contacts, and find what must be decided.

    Args:
        bodies: the table.
        limits: the settings, shape (1,).
        dt: time since the last frame [s].
        body: the live bodies, shape (m,).
        body_a: first bodies of the contacts, shape (n,).
        body_b: second bodies, shape (n,).
        mass: masses of the live bodies [kg], shape (m,).
        center: their centres of mass [m], shape (m, 3).
        point: contact points [m], shape (n, 3); this and what follows as ``Contacts`` has it.
        normal: unit normals from a to b, shape (n, 3).
        separation: signed distances [m], shape (n,).
        relative_velocity: of b against a [m/s], shape (n, 3).
        friction: Coulomb coefficients, shape (n,).

    Returns:
        A fault (FINE if there is none) and its row, or for NO_ROOM the greatest id; the contacts that count; the
        frozen bodies struck by an impact; the bodies due for the flat and for the leaning test; the live bodies
        that lie on the stack anew, and those that do so no more.
    """
    nothing, no_contact = np.empty(0, np.int64), np.empty(0, CONTACT)
    row = first_bad_contact(body_a, body_b, point, normal, friction)
    if row >= 0:
        return BAD_CONTACT, row, no_contact, nothing, nothing, nothing, nothing, nothing
    row = first_bad_mass(body, mass, center)
    if row >= 0:
        return BAD_MASS, row, no_contact, nothing, nothing, nothing, nothing, nothing
    greatest = max(_greatest(body), _greatest(body_a), _greatest(body_b))
    if greatest >= len(bodies):
        return NO_ROOM, greatest, no_contact, nothing, nothing, nothing, nothing, nothing
    track(bodies, body, mass, center, dt)
    row = max(_first_unknown(bodies, body_a), _first_unknown(bodies, body_b))
    if row >= 0:
        return UNKNOWN_BODY, row, no_contact, nothing, nothing, nothing, nothing, nothing

    limit = limits[0]
    kept, struck = keep_contacts(bodies, body_a, body_b, point, normal, separation, relative_velocity, friction, limit)
    count_frames(bodies, body, limit)
    at_rest, leaning = due(bodies, body, limit)
    lying, gone = shifted_loads(bodies, body, limit)
    return FINE, -1, kept, struck, at_rest, leaning, lying, gone
