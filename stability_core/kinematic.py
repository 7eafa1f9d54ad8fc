"""Kinematic bodies: bodies of infinite mass, which only the host moves.

Examples are lifts, doors and conveyor belts. A kinematic body is FIXED or MOVING:

- FIXED: the body keeps its place and counts as ground. Bodies may freeze on it, and statics treats it as immovable.
- MOVING: no body may freeze on it. The bodies on a FIXED body unfreeze in the frame in which the FIXED body
  begins to move.

A kinematic body begins to move when its centre, or its surface below a frozen body, has moved by ``steady_shift`` times
a size. This size belongs to the smallest body that has touched the kinematic body so far. The kinematic body is FIXED
again once it has kept its place for ``still_s``. In each frame the path of the surface grows by the length of the frame
times a speed. This speed is the greatest relative speed at the body's contacts with frozen bodies. The path of the
surface reveals conveyor belts and turns about the centre.
"""

from __future__ import annotations

import numpy as np

from stability_core.compiled import compiled
from stability_core.frame_arrays import ContactArrays, MassArrays
from stability_core.port import GROUND, IntArray
from stability_core.settings import ROUNDING_S, Limits
from stability_core.stack import ABSENT, FIXED, FROZEN, LIVE, MOVING, Bodies


@compiled
def _keeps_place(row: Bodies, limits: Limits, dt: float) -> bool:
    """Update path and place of a kinematic body, and return True if the body has kept its place.

    The function changes three columns:

    - ``swept``, the path of the surface, grows by ``sweep`` times ``dt``;
    - ``sweep`` becomes 0 for the next frame;
    - ``still_center``, the place, becomes the present centre until another body touches the kinematic body.
    """
    moved = 0.0
    for k in range(3):
        moved += (row.center[k] - row.still_center[k]) ** 2
    row.swept += row.sweep * dt
    row.sweep = 0.0
    if np.isfinite(row.least_load):
        most = limits.steady_shift * row.least_load
        if moved > most**2 or row.swept > most:
            return False
    if not np.isfinite(row.least_load):
        for k in range(3):
            row.still_center[k] = row.center[k]
    return True


@compiled
def _begin(row: Bodies) -> bool:
    """Make a body kinematic, and return True if the body is MOVING.

    A new body is FIXED. A body that was live is MOVING, because its motion in this frame is unknown.
    """
    row.state = FIXED if row.state == ABSENT else MOVING
    row.mass = np.inf
    row.size, row.least_load, row.still_s = 0.0, np.inf, 0.0
    row.swept = row.sweep = 0.0
    row.held = row.is_load = row.unsettled = False
    return bool(row.state == MOVING)


@compiled
def _follow(row: Bodies, limits: Limits, dt: float) -> bool:
    """Set a kinematic body FIXED or MOVING by its motion, and return True if the body has just begun to move."""
    if _keeps_place(row, limits, dt):
        row.still_s += dt
        if row.still_s >= limits.still_s - ROUNDING_S:
            row.state = FIXED
        return False
    row.still_s = row.swept = 0.0
    for k in range(3):
        row.still_center[k] = row.center[k]
    begins = row.state == FIXED
    row.state = MOVING
    return bool(begins)


@compiled
def follow_host(bodies: Bodies, masses: MassArrays, limits: Limits, dt: float, moved: IntArray) -> tuple[int, int]:
    """Update the bodies that the host moves, makes kinematic or releases.

    Args:
        bodies: the table, before ``motion.track`` of this frame.
        masses: m listed bodies, by their rows, with infinite mass for kinematic bodies.
        limits: the settings.
        dt: time since the last frame [s].
        moved: output, bodies that can no longer bear a frozen body, with room for at least m bodies.

    Returns:
        Number of kinematic bodies, and number of bodies written to ``moved``.
    """
    ids, mass, center = masses.body, masses.mass, masses.center
    kinematic, n = 0, 0
    for i in range(len(ids)):
        row = bodies[ids[i]]
        was_kinematic = row.state == FIXED or row.state == MOVING
        begins = False
        if np.isinf(mass[i]) and row.state != FROZEN:  # the extension first makes a frozen body live
            kinematic += 1
            begins = not was_kinematic and _begin(row)
            for k in range(3):
                row.center[k] = center[i, k]
            begins = _follow(row, limits, dt) or begins
        elif was_kinematic:
            row.state = ABSENT  # from now on, ``motion.track`` treats it as a new body
            begins = True
        if begins:
            moved[n] = ids[i]
            n += 1
    return kinematic, n


@compiled
def list_carried(bodies: Bodies, contacts: ContactArrays, limits: Limits, dt: float, moved: IntArray, n: int) -> int:
    """Record the contacts of kinematic bodies, and list the frozen bodies that a kinematic body moves: O(contacts).

    Args:
        bodies: the table, after ``note_sizes``.
        contacts: c contacts between rows of the table.
        limits: the settings.
        dt: time since the last frame [s].
        moved: output after the first ``n`` bodies, with room for at least c bodies more.
        n: number of bodies already in ``moved``.

    Returns:
        Number of bodies in ``moved``.
    """
    body_a, body_b, normal = contacts.body_a, contacts.body_b, contacts.normal
    separation, relative_velocity = contacts.separation, contacts.relative_velocity
    for i in range(len(body_a)):
        for body, other in ((body_a[i], body_b[i]), (body_b[i], body_a[i])):
            if body == GROUND or other == GROUND:
                continue
            row, touching = bodies[body], bodies[other]
            if not (row.state == FIXED or row.state == MOVING) or not (
                touching.state == LIVE or touching.state == FROZEN
            ):
                continue
            if separation[i] > limits.contact_gap * touching.size:
                continue  # never for an unknown (NaN) separation, which counts as touch
            row.least_load = min(row.least_load, touching.size)
            if touching.state != FROZEN:
                for k in range(3):
                    touching.carrier_normal[k] += normal[i, k] if body == body_a[i] else -normal[i, k]
                continue
            squared = 0.0
            for k in range(3):
                squared += relative_velocity[i, k] ** 2
            speed = np.sqrt(squared)
            row.sweep = max(row.sweep, speed)
            if row.state == MOVING or row.swept + speed * dt > limits.steady_shift * touching.size:
                moved[n] = other
                n += 1
    return n
