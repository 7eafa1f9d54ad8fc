"""The per-frame kernel: validate input, track live bodies, filter contacts, collect candidates.

Without changes, the work of the core on a frame ends with this compiled call.
"""

from __future__ import annotations

import numpy as np

from stability_core.blows import list_struck
from stability_core.compiled import compiled
from stability_core.contact_filter import ContactRows, keep_contacts, note_sizes
from stability_core.frame_arrays import ContactArrays, MassArrays
from stability_core.frame_buffers import (
    AT_REST,
    GONE,
    HAS_FORCES,
    LEANING,
    LYING,
    MOVED,
    NOW,
    PUSHED,
    STRUCK,
    next_frame,
)
from stability_core.kinematic import follow_host, list_carried
from stability_core.motion import list_due, list_shifted_loads, time_at_rest, track
from stability_core.port import GROUND, FloatArray, IntArray
from stability_core.pushes import list_pushed
from stability_core.rows import find_rows, give_rows, take_row
from stability_core.settings import Limits
from stability_core.stack import ABSENT, Bodies, is_immovable, sorted_ids
from stability_core.validation import (
    BAD_CONTACT,
    BAD_MASS,
    BAD_SHAPE,
    FINE,
    FLIPPED,
    LISTED_TWICE,
    NO_ROOM,
    UNKNOWN_BODY,
    first_bad_contact,
    first_bad_mass,
    fit_together,
    presses_down_from_below,
)


@compiled
def _first_repeated(bodies: Bodies, ids: IntArray) -> int:
    """Record the ``place`` of each body in ``ids``, and return the index of the first repeated body, or -1."""
    for i in range(len(ids)):
        place = bodies[ids[i]].place  # perhaps left over from another list
        if place < i and ids[place] == ids[i]:
            return i
        bodies[ids[i]].place = i
    return -1


@compiled
def _is_listed(bodies: Bodies, ids: IntArray, body: int) -> bool:
    place = bodies[body].place
    return bool(place < len(ids) and ids[place] == body)


@compiled
def _first_flipped(bodies: Bodies, contacts: ContactArrays, masses: MassArrays) -> int:
    """Return a row with a flipped normal if the normals of all contacts with the ground are flipped, else -1.

    Kinematic bodies do not count, because they need not be convex and need not rest on anything.
    """
    body_a, body_b, point, normal = contacts.body_a, contacts.body_b, contacts.point, contacts.normal
    ids, mass, center = masses.body, masses.mass, masses.center
    found = -1
    for i in range(len(body_a)):
        a, b = body_a[i], body_b[i]
        if a != GROUND and b != GROUND:
            continue
        body, sign = (b, 1.0) if a == GROUND else (a, -1.0)
        is_listed = _is_listed(bodies, ids, body)
        if is_immovable(bodies, body) or (is_listed and not np.isfinite(mass[bodies[body].place])):
            continue
        if is_listed:
            is_flipped = presses_down_from_below(center[bodies[body].place], point[i], normal[i], sign)
        else:
            is_flipped = presses_down_from_below(bodies[body].center, point[i], normal[i], sign)
        if not is_flipped:
            return -1
        found = i
    return found


@compiled
def _first_fault(
    bodies: Bodies, slots: IntArray, named: ContactArrays, contacts: ContactArrays, masses: MassArrays
) -> tuple[int, int]:
    """Return the first fault of the contacts and masses after the bodies have rows, and the row of the fault.

    The result is (FINE, -1) without a fault.

    Args:
        bodies: the table.
        slots: the slots of ``Rows``.
        named: the contacts, by ids.
        contacts: output, the same contacts by rows.
        masses: the listed bodies, by their rows.
    """
    row = _first_repeated(bodies, masses.body)
    if row >= 0:
        return LISTED_TWICE, row
    row = max(find_rows(slots, named.body_a, contacts.body_a), find_rows(slots, named.body_b, contacts.body_b))
    if row >= 0:
        return UNKNOWN_BODY, row
    row = _first_flipped(bodies, contacts, masses)
    if row >= 0:
        return FLIPPED, row
    return FINE, -1


@compiled
def _name_new(bodies: Bodies, ids: IntArray, rows: IntArray) -> None:
    """Write the ids of new bodies, which the port lists for the first time, to the table."""
    for i in range(len(ids)):
        if bodies[rows[i]].state == ABSENT:
            bodies[rows[i]].id = ids[i]


@compiled
def _take_new(bodies: Bodies, slots: IntArray, spare: IntArray, ids: IntArray, rows: IntArray) -> None:
    """Free the rows of the bodies that the port lists for the first time, in reverse order of their allocation."""
    new = np.empty(len(ids), np.int64)
    n = 0
    for i in range(len(ids)):
        if bodies[rows[i]].state == ABSENT:
            new[n] = ids[i]
            n += 1
    for body in sorted_ids(new[:n])[::-1]:
        take_row(slots, spare, body)


@compiled
def observe(
    bodies: Bodies,
    slots: IntArray,
    spare: IntArray,
    contacts: ContactRows,
    sizes: IntArray,
    latest: IntArray,
    clock: FloatArray,
    worklist: IntArray,
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
    force: FloatArray,
) -> tuple[int, int, int, int]:
    """Validate the input, track the live bodies, filter the contacts, and fill the worklist.

    The cost is O(m + n), independent of the number of frozen bodies. ADR-0002 gives the reason for the separate array
    arguments.

    Args:
        bodies: the table.
        slots: the slots of ``Rows``, which hold the row of each body. New bodies get a row.
        spare: the free rows of ``Rows``.
        contacts: output, with room for n more rows. This array and the next four arrays belong to ``FrameBuffers``.
        sizes: shape (frames,).
        latest: shape (1,).
        clock: shape (4,).
        worklist: output, with room for 2 n + m bodies.
        limits: the settings, shape (1,).
        dt: time since the last frame [s].
        body: the bodies that the port lists, shape (m,): all live and kinematic bodies, and perhaps frozen bodies.
        body_a: first bodies of the contacts, shape (n,).
        body_b: second bodies, shape (n,).
        mass: masses of the listed bodies [kg], shape (m,).
        center: centres of mass of the listed bodies [m], shape (m, 3).
        point: contact points [m], shape (n, 3). This array and the following arrays belong to ``Contacts``.
        normal: unit normals from a to b, shape (n, 3).
        separation: signed distances [m], shape (n,).
        relative_velocity: velocity of b against a [m/s], shape (n, 3).
        friction: Coulomb coefficients, shape (n,).
        force: forces on b [N], shape (n, 3), or (0, 0) if the engine reports none.

    Returns:
        Four numbers:

        - the fault, or FINE without a fault;
        - the row of the fault; for NO_ROOM the number of missing rows; for BAD_SHAPE -1; for FINE the number of
          listed frozen bodies;
        - the number of bodies in ``worklist``;
        - the number of kept contacts of all dwell frames.
    """
    named = ContactArrays(body_a, body_b, point, normal, separation, relative_velocity, friction, force)
    listed = MassArrays(body, mass, center)
    if not fit_together(named, listed):
        return BAD_SHAPE, -1, 0, 0
    row = first_bad_contact(named)
    if row >= 0:
        return BAD_CONTACT, row, 0, 0
    row = first_bad_mass(listed)
    if row >= 0:
        return BAD_MASS, row, 0, 0
    rows = np.empty(len(body), np.int64)
    is_new = find_rows(slots, body, rows) >= 0
    if is_new:
        missing = give_rows(slots, spare, body, rows)
        if missing > 0:
            return NO_ROOM, missing, 0, 0
    rows_a, rows_b = np.empty(len(body_a), np.int64), np.empty(len(body_b), np.int64)
    seen = ContactArrays(rows_a, rows_b, point, normal, separation, relative_velocity, friction, force)
    masses = MassArrays(rows, mass, center)
    fault, row = _first_fault(bodies, slots, named, seen, masses)
    if fault != FINE:
        _take_new(bodies, slots, spare, body, rows)
        return fault, row, 0, 0
    if is_new:
        _name_new(bodies, body, rows)

    limit = limits[0]
    kinematic, moved = follow_host(bodies, masses, limit, dt, worklist[MOVED, 1:])
    frozen = track(bodies, masses, dt)
    next_frame(sizes, latest, clock, dt)
    note_sizes(bodies, seen)
    if kinematic > 0:
        moved = list_carried(bodies, seen, limit, dt, worklist[MOVED, 1:], moved)
    worklist[MOVED, 0] = moved
    worklist[STRUCK, 0] = list_struck(bodies, seen, limit, dt, worklist[STRUCK, 1:])
    kept = contacts[latest[0] * (len(contacts) // len(sizes)) :]
    count = keep_contacts(bodies, seen, limit, dt, kept)
    sizes[latest[0]] = count
    worklist[PUSHED, 0] = (
        list_pushed(bodies, kept[:count], limit, clock[NOW], dt, worklist[PUSHED, 1:]) if len(force) > 0 else 0
    )
    clock[HAS_FORCES] = 1.0 if len(force) > 0 else 0.0
    time_at_rest(bodies, rows, limit, dt)
    worklist[AT_REST, 0], worklist[LEANING, 0] = list_due(
        bodies, rows, limit, dt, worklist[AT_REST, 1:], worklist[LEANING, 1:]
    )
    worklist[LYING, 0], worklist[GONE, 0] = list_shifted_loads(
        bodies, rows, limit, dt, worklist[LYING, 1:], worklist[GONE, 1:]
    )
    return FINE, frozen, worklist[:, 0].sum(), sizes.sum()
