"""One look at the world: all that a quiet frame costs, in one compiled call."""

from __future__ import annotations

from stability_core.checks import (
    BAD_CONTACT,
    BAD_MASS,
    BAD_SHAPE,
    FINE,
    NO_ROOM,
    UNKNOWN_BODY,
    first_bad_contact,
    first_bad_mass,
    fit_together,
)
from stability_core.compiled import compiled
from stability_core.contact_filter import ContactRows, keep_contacts
from stability_core.motion import count_frames, list_due, list_shifted_loads, track
from stability_core.port import GROUND, FloatArray, IntArray
from stability_core.settings import Limits
from stability_core.stack import ABSENT, Bodies
from stability_core.watch import AT_REST, GONE, LEANING, LYING, STRUCK


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
    contacts: ContactRows,
    sizes: IntArray,
    latest: IntArray,
    due: IntArray,
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
) -> tuple[int, int, int, int]:
    """Track the live bodies, filter the contacts, and write down what must be decided.

    O(m + n), whatever the number of frozen bodies. The arrays of ``Watch`` come one by one: Numba takes longer to
    look at a tuple than at what is in it.

    Args:
        bodies: the table.
        contacts: of ``Watch``, with room for n more, written here; the same for the next three.
        sizes: shape (frames,).
        latest: shape (1,).
        due: with room for 2 n and m bodies.
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
        A fault (FINE if there is none); its row, or for NO_ROOM the greatest id; how many bodies are listed in ``due``;
        how many contacts are kept of all frames.
    """
    if not fit_together(body, body_a, body_b, mass, center, point, normal, separation, relative_velocity, friction):
        return BAD_SHAPE, -1, 0, 0
    row = first_bad_contact(body_a, body_b, point, normal, friction)
    if row >= 0:
        return BAD_CONTACT, row, 0, 0
    row = first_bad_mass(body, mass, center)
    if row >= 0:
        return BAD_MASS, row, 0, 0
    greatest = max(_greatest(body), _greatest(body_a), _greatest(body_b))
    if greatest >= len(bodies):
        return NO_ROOM, greatest, 0, 0
    track(bodies, body, mass, center, dt)
    row = max(_first_unknown(bodies, body_a), _first_unknown(bodies, body_b))
    if row >= 0:
        return UNKNOWN_BODY, row, 0, 0

    limit = limits[0]
    latest[0] = (latest[0] + 1) % len(sizes)
    kept = contacts[latest[0] * (len(contacts) // len(sizes)) :]
    sizes[latest[0]], due[STRUCK, 0] = keep_contacts(
        bodies, body_a, body_b, point, normal, separation, relative_velocity, friction, limit, kept, due[STRUCK, 1:]
    )
    count_frames(bodies, body, limit)
    due[AT_REST, 0], due[LEANING, 0] = list_due(bodies, body, limit, due[AT_REST, 1:], due[LEANING, 1:])
    due[LYING, 0], due[GONE, 0] = list_shifted_loads(bodies, body, limit, due[LYING, 1:], due[GONE, 1:])
    return FINE, -1, due[:, 0].sum(), sizes.sum()
