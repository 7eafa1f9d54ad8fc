"""Check a user's port against the promises of ``StabilityPort``. Error messages name the fix."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np

from stability_core.frame_arrays import contact_arrays, mass_arrays
from stability_core.port import GROUND, Contacts, FloatArray, IntArray, Masses, StabilityPort
from stability_core.validation import (
    BAD_CONTACT,
    BAD_MASS,
    FLIPPED,
    LISTED_TWICE,
    check_ids,
    check_shapes,
    checked_removals,
    fault_of,
    first_bad_contact,
    first_bad_mass,
    presses_down_from_below,
)

APART = 0.1
"""Ratio to a body's size. Above this ratio, a separation from the ground contradicts rest, and a move in the first
frame after ``wake`` contradicts an exact freeze."""
STOPPED = 1e-3
"""Ratio of a body's motion in one frame to its size, up to which the body counts as at rest. ``Settings.rest_speed``
allows about the same motion of the paper's plank at 60 Hz."""
SAME = 1e-6
"""Ratio up to which a value of a frozen body counts as unchanged: change of position to size, or change of mass to
former mass. The ratio exceeds 6e-8, because single precision rounds by this ratio."""
ASLEEP = 10
"""Number of frames for which the check freezes a body. In free fall at 60 Hz, the body would move by
14 cm in this time."""

Step: TypeAlias = Callable[[], object]


class PortError(ValueError):
    """Error for a port that breaks a promise. The message states the promise, the observation and the fix."""


def check_port(port: StabilityPort, step: Step, frames: int = 120) -> list[str]:
    """Check a port on your own simulation: array shapes, signs of normals and separations, and exact freezing.

    The check steps the simulation. A body must come to rest on the ground, for example on a table with the id
    ``GROUND``. The check freezes this body for ``ASLEEP`` frames, and unfreezes the body again.

    Args:
        port: the port, without an extension.
        step: function that advances the simulation by one frame.
        frames: number of frames, at least 1, within which a body comes to rest.

    Returns:
        Lines of text with the findings.

    Raises:
        PortError: at the first broken promise, or if no body comes to rest on the ground.
    """
    for frame in range(frames):
        before = port.masses() if frame == frames - 1 else None
        step()
        contacts, masses = port.contacts(), port.masses()
        _check_arrays(contacts, masses, frame)
    body, size = _resting_body(contacts, before, masses)
    _check_resting_contacts(contacts, masses, body, size)
    points = len(_on_ground(contacts, body))
    lines = [
        f"arrays, ids, masses and contacts of {frames} frames are well formed",
        f"body {body} rests on the ground: normals point from a to b, separations are distances",
        f"body {body} touches the ground in {points} contact point{'s' * (points != 1)} in the last frame",
    ]
    if points < 3:
        lines.append(
            "with fewer than 3 contact points per frame, the core unites the points of 0.1 s: list all contact "
            "points of the engine"
        )
    return lines + _check_sleep(port, step, body, size)


def _check_arrays(contacts: Contacts, masses: Masses, frame: int) -> None:
    try:
        check_shapes(contacts, masses)
        for name in ("body_a", "body_b"):
            check_ids(f"contacts.{name}", getattr(contacts, name))
        check_ids("masses.body", masses.body)
        checked_removals(masses.removed)
        ids = masses.body.astype(np.int64)
        row = first_bad_contact(contact_arrays(contacts))
        if row >= 0:
            raise fault_of(BAD_CONTACT, row, contacts, masses)
        row = first_bad_mass(mass_arrays(masses))
        if row >= 0:
            raise fault_of(BAD_MASS, row, contacts, masses)
        values, first, count = np.unique(ids, return_index=True, return_counts=True)
        if (count > 1).any():
            raise fault_of(LISTED_TWICE, int(first[count > 1][0]), contacts, masses)
        named = np.unique(np.concatenate([contacts.body_a, contacts.body_b]))
        unknown = named[~np.isin(named, [*values.tolist(), GROUND])]
        if len(unknown):
            raise ValueError(
                f"contacts() names body {unknown[0]}, but masses() does not list this body, although no body is "
                f"frozen: give bodies that never move the id {GROUND} in contacts(), and list all other bodies in "
                "masses()"
            )
    except ValueError as error:
        raise PortError(f"frame {frame}: {error}") from error


def _on_ground(contacts: Contacts, body: int) -> IntArray:
    """Return the rows of a body's contacts with the ground, shape (k,)."""
    a, b = contacts.body_a, contacts.body_b
    return np.flatnonzero(((a == body) & (b == GROUND)) | ((a == GROUND) & (b == body)))


def _resting_body(contacts: Contacts, before: Masses | None, masses: Masses) -> tuple[int, float]:
    """Return the body on the ground that moves least, and its size [m]: from its centre to its farthest ground contact.

    Raises:
        PortError: if no movable body touches the ground, or no movable body on the ground is at rest.
    """
    best, found, best_size = np.inf, -1, 0.0
    known = {} if before is None else dict(zip(before.body.tolist(), before.center_of_mass, strict=True))
    is_kinematic = np.isinf(masses.mass)
    for body, center in zip(masses.body[~is_kinematic].tolist(), masses.center_of_mass[~is_kinematic], strict=True):
        rows = _on_ground(contacts, body)
        if len(rows) == 0 or body not in known:
            continue
        size = float(np.linalg.norm(contacts.point[rows] - center, axis=1).max())
        moved = float(np.linalg.norm(center - known[body])) / size
        if moved < best:
            best, found, best_size = moved, body, size
    if found < 0:
        raise PortError(
            "contacts() lists no contact with the ground in the last frame for any body of finite mass: give floors, "
            f"walls and tables the id {GROUND} in contacts(), and let such a body lie on the ground"
        )
    if best > STOPPED:
        raise PortError(
            f"no body is at rest on the ground: body {found} still moves by {1e3 * best * best_size:.2g} mm per frame; "
            "check more frames, or give center_of_mass in metres"
        )
    return found, best_size


def _check_resting_contacts(contacts: Contacts, masses: Masses, body: int, size: float) -> None:
    rows = _on_ground(contacts, body)
    center = masses.center_of_mass[masses.body == body][0]
    for row in rows.tolist():
        sign = 1.0 if contacts.body_b[row] == body else -1.0
        normal, point = np.array(contacts.normal[row], np.float64), np.array(contacts.point[row], np.float64)
        if presses_down_from_below(np.array(center, np.float64), point, normal, sign):
            raise PortError(str(fault_of(FLIPPED, row, contacts, masses)))
    separation = np.array(contacts.separation[rows], np.float64)
    known = separation[np.isfinite(separation)]
    if len(known) and np.abs(known).min() > APART * size:
        raise PortError(
            f"separations between the ground and body {body} at rest must be near 0 m, got "
            f"{known.round(6).tolist()} m: give the signed distance in metres, negative for an overlap, or NaN if the "
            "engine does not report the distance"
        )
    if not (contacts.friction[rows] > 0.0).any():
        raise PortError(
            f"friction of body {body} with the ground must be above 0, got 0 at every contact point: give the Coulomb "
            "coefficient of the pair, which the engine combines from the coefficients of both bodies"
        )


def _check_sleep(port: StabilityPort, step: Step, body: int, size: float) -> list[str]:
    before = _row_of(port.masses(), body)
    if before is None:
        raise PortError(
            f"a second call of masses() in one frame must list the live body {body}, but does not: return the same "
            "bodies in each call"
        )
    lines = []
    port.sleep((body,))
    port.sleep((body,))  # a second call must change nothing
    for _ in range(ASLEEP):
        step()
        seen = _row_of(port.masses(), body)
        if seen is not None and np.abs(seen[1] - before[1]).max() > SAME * size:
            raise PortError(
                f"body {body} must not move after sleep(), but moved by "
                f"{1e3 * np.linalg.norm(seen[1] - before[1]):.2g} mm: make the body static in sleep(), or give it "
                "infinite mass"
            )
    if seen is None:
        lines.append(
            "masses() leaves out frozen bodies, and therefore the check compared the body's positions only after wake()"
        )
    port.wake((body,))
    step()
    woken = _row_of(port.masses(), body)
    if woken is None:
        raise PortError(f"masses() must list body {body} after wake(), but does not: list all live bodies")
    if abs(woken[0] - before[0]) > SAME * before[0]:
        raise PortError(
            f"body {body} must have its former mass of {before[0]:g} kg after wake(), got {woken[0]:g} kg: restore the "
            "mass in wake()"
        )
    apart = float(np.linalg.norm(woken[1] - before[1]))
    if apart > APART * size:
        raise PortError(
            f"body {body} must keep its place and be at rest after wake(), but is {1e3 * apart:.2g} mm away one frame "
            "later: keep the body fixed after sleep(), and set its velocity to zero in wake()"
        )
    return [
        *lines,
        f"body {body} stayed frozen for {ASLEEP} frames without moving, and was at rest with its former mass "
        "after wake()",
    ]


def _row_of(masses: Masses, body: int) -> tuple[float, FloatArray] | None:
    """Return mass [kg] and centre of mass [m], (3,), of a listed body, or None if ``masses`` lacks the body."""
    rows = np.flatnonzero(masses.body == body)
    return (
        None if len(rows) == 0 else (float(masses.mass[rows[0]]), np.array(masses.center_of_mass[rows[0]], np.float64))
    )
