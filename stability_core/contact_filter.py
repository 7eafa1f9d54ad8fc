"""Filter contacts: drop fast impacts and gaps, and decide by the normal which body of a pair stands on the other body.

The paper also drops pairs in which neither body touches the stack. This filter keeps these pairs, because they show
which bodies lie on a live load. These pairs add no candidate, because only bodies that touch the stack are candidates.
"""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np

from stability_core.compiled import compiled
from stability_core.frame_arrays import ContactArrays
from stability_core.port import GROUND, FloatArray, IntArray
from stability_core.settings import Limits
from stability_core.stack import LIVE, Bodies, is_immovable, is_stack

CONTACT = np.dtype(
    [
        ("body_a", "i8"),
        ("body_b", "i8"),
        ("point", "f8", (3,)),
        ("normal", "f8", (3,)),
        ("friction", "f8"),
        ("force", "f8", (3,)),  # [N], zero if the engine reports no forces
        ("level", "?"),  # True if load-bearing: its cone contains the vertical, and it pushes up a movable body
    ],
    align=True,
)
"""Row of a contact that the filter keeps, in upright coordinates and with the units of ``Contacts``."""
ContactRows: TypeAlias = Any
"""Structured array of ``CONTACT``."""
BEARS = 0.1
"""Vertical component of a unit normal above which the lower body of a contact counts as a support.

The value is low, because a brick can rest in a wedge of two faces that are too steep for friction."""
_NEAR = 0.1
"""Ratio of a contact point's gap to the point's distance from the body's centre, up to which the point counts as on the
body's surface. A wider gap does not show the body's size, because engines also list points before touch."""


@compiled
def bit_of(body: int) -> np.uint64:
    """Return the bit of a body in a set of 64 bits. Rows that differ by a multiple of 64 share a bit."""
    return np.uint64(1) << np.uint64((body + 1) % 64)


@compiled
def is_level(upward: float, friction: float, level_tilt: float) -> bool:
    """Return True if a contact is load-bearing: its Coulomb cone, widened to ``level_tilt``, contains the vertical.

    |upward| >= cos(max(atan(friction), level_tilt))

    Args:
        upward: vertical component of the unit normal.
        friction: Coulomb coefficient of the pair.
        level_tilt: slope [rad] up to which a contact counts as load-bearing at any friction.
    """
    return bool(abs(upward) >= np.cos(max(np.arctan(friction), level_tilt)))


@compiled
def upper_of(body_a: int, body_b: int, upward: float) -> int:
    """Return the upper body of a contact: the body that the contact pushes up, or ``body_a`` for a horizontal normal.

    The heights of the centres do not decide, because a tilted plank's centre may lie above a block on the plank's low
    end.

    Args:
        body_a: first body.
        body_b: second body.
        upward: vertical component of the unit normal from a to b.
    """
    return body_b if upward > 0.0 else body_a


@compiled
def is_moving(body: Bodies, limits: Limits) -> bool:
    """Return True if a live body is faster than ``moving_speed`` times sqrt(gravity times size)."""
    return bool(body.speed > limits.moving_speed * np.sqrt(limits.gravity * body.size))


@compiled
def _note(bodies: Bodies, body: int, other: int, depth: float, stands: bool, upward: float) -> None:
    """Record a contact with ``other`` in the row of a live body.

    The penetration ``depth`` [m] counts only if the body ``stands`` on the other body. The other body is a support if
    ``stands`` is True, or if the ``upward`` component of the normal exceeds ``BEARS``.
    """
    row = bodies[body]
    row.touches = row.touches or is_stack(bodies, other)
    row.neighbours |= bit_of(other)
    if other != GROUND:
        row.restless = max(row.restless, bodies[other].wakes)
        if bodies[other].state == LIVE:
            row.quiet_s = min(row.quiet_s, bodies[other].quiet_before_s)
    if is_stack(bodies, other):
        row.frozen_neighbours |= bit_of(other)
    if stands or upward > BEARS:
        row.supported_by |= bit_of(other)
    if stands and depth > row.depth:  # false for an unknown (NaN) depth
        row.depth = depth


@compiled
def speeds_of(velocity: FloatArray, normal: FloatArray) -> tuple[float, float]:
    """Return the approach speed and the sliding speed [m/s] of a pair: (NaN, 0) for an unknown velocity.

    For the relative velocity v and the unit normal n, these speeds are -v.n and sqrt(|v|^2 - (v.n)^2).
    """
    along, total = 0.0, 0.0
    for k in range(3):
        along += velocity[k] * normal[k]
        total += velocity[k] ** 2
    return -along, np.sqrt(max(0.0, total - along**2))


@compiled
def _deepest_of_pair(body_a: IntArray, body_b: IntArray, separation: FloatArray, first: int) -> tuple[float, int]:
    """Return the separation [m] of a pair's deepest point, at most zero, and the row after the pair's last point.

    The function reads from the ``first`` row of the pair to the next row of another pair. Ports list the points of a
    pair together.
    """
    deepest, i = 0.0, first
    while i < len(separation) and body_a[i] == body_a[first] and body_b[i] == body_b[first]:
        if separation[i] < deepest:  # false for an unknown (NaN) separation
            deepest = separation[i]
        i += 1
    return float(deepest), i


@compiled
def note_sizes(bodies: Bodies, contacts: ContactArrays) -> None:
    """Update each body's size: the greatest distance so far [m] of a contact point from the body's centre.

    The function ignores a point whose gap exceeds ``_NEAR`` times the point's distance from the centre.
    """
    body_a, body_b = contacts.body_a, contacts.body_b
    point, separation = contacts.point, contacts.separation
    for i in range(len(body_a)):
        for body in (body_a[i], body_b[i]):
            if body == GROUND:
                continue
            row = bodies[body]
            distance = 0.0
            for k in range(3):
                distance += (point[i, k] - row.center[k]) ** 2
            distance = np.sqrt(distance)
            if distance > row.size and not separation[i] > _NEAR * distance:  # true for an unknown (NaN) separation
                row.size = distance


@compiled
def size_of_pair(bodies: Bodies, body_a: int, body_b: int) -> float:
    """Return the size [m] of the smaller body of a pair, or of the body that touches the ground."""
    if body_a == GROUND:
        return float(bodies[body_b].size)
    if body_b == GROUND:
        return float(bodies[body_a].size)
    return float(min(bodies[body_a].size, bodies[body_b].size))


@compiled
def is_impact(approach: float, size: float, limits: Limits, dt: float) -> bool:
    """Return True if the ``approach`` speed [m/s] exceeds the limit for a pair of this ``size`` [m].

    With the gravitational acceleration g and the length ``dt`` [s] of a frame, the limit is

    max(impact_speed sqrt(g size), impact_frames g dt)
    """
    laid = max(limits.impact_speed * np.sqrt(limits.gravity * size), limits.impact_frames * limits.gravity * dt)
    return bool(approach > laid)


@compiled
def _is_restless(bodies: Bodies, body: int, limits: Limits) -> bool:
    """Return True if a body has unfrozen since it was last in flight, or lies in a pile that blows still shake."""
    if body == GROUND:
        return False
    row = bodies[body]
    return bool(row.wakes > 0 or (row.state == LIVE and row.quiet_before_s < limits.quiet_s))


@compiled
def _note_shock(bodies: Bodies, body_a: int, body_b: int, limits: Limits) -> None:
    """Record an impact of two bodies of which one is restless. The first blow on a stack at rest does not count."""
    if _is_restless(bodies, body_a, limits) or _is_restless(bodies, body_b, limits):
        for body in (body_a, body_b):
            if body != GROUND:
                bodies[body].quiet_s = 0.0


@compiled
def keep_contacts(bodies: Bodies, contacts: ContactArrays, limits: Limits, dt: float, kept: ContactRows) -> int:
    """Filter one frame's contacts, and record neighbours, supports, depth and sliding speed of each live body.

    Args:
        bodies: the table, after ``motion.track`` of this frame.
        contacts: n contacts between rows of the table.
        limits: the settings. The filter drops impacts (see ``is_impact``) and gaps wider than ``contact_gap``. The
            filter measures these gaps from the deepest point of the pair, because a tilted plank may stand on one edge,
            deep in the ground. The filter also drops a contact that is not load-bearing if its separation exceeds
            ``touch_gap``, because friction needs pressure.
        dt: time since the last frame [s].
        kept: output, with room for at least n rows of ``CONTACT``.

    Returns:
        Number of kept contacts.
    """
    body_a, body_b, point, normal = contacts.body_a, contacts.body_b, contacts.point, contacts.normal
    separation, relative_velocity = contacts.separation, contacts.relative_velocity
    friction, force = contacts.friction, contacts.force
    size, following, deepest, size_of = 0, 0, 0.0, 0.0
    for i in range(len(body_a)):
        a, b = body_a[i], body_b[i]
        if i == following:  # the first point of another pair
            deepest, following = _deepest_of_pair(body_a, body_b, separation, i)
            size_of = size_of_pair(bodies, a, b)
        if separation[i] - deepest > limits.contact_gap * size_of:
            continue  # never for an unknown (NaN) separation, which counts as touch
        approach, slip = speeds_of(relative_velocity[i], normal[i])
        if is_impact(approach, size_of, limits, dt):
            _note_shock(bodies, a, b, limits)
            continue
        upper = upper_of(a, b, normal[i, 2])  # a ceiling carries nothing
        level = is_level(normal[i, 2], friction[i], limits.level_tilt) and not is_immovable(bodies, upper)
        if not level and separation[i] > limits.touch_gap * size_of:
            continue
        row = kept[size]
        row.body_a, row.body_b, row.friction = a, b, friction[i]
        for k in range(3):
            row.point[k], row.normal[k] = point[i, k], normal[i, k]
            row.force[k] = force[i, k] if len(force) > 0 else 0.0
        row.level = level
        size += 1
        for body, other, upward in ((a, b, -normal[i, 2]), (b, a, normal[i, 2])):
            if body != GROUND and bodies[body].state == LIVE:
                bodies[body].slip = max(bodies[body].slip, slip)
                _note(bodies, body, other, -separation[i], level and upper == body, upward)
    return size
