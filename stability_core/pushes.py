"""Pushes: contact forces of live and MOVING bodies on frozen bodies, beyond the weight of the live bodies.

A body on a stack presses with its weight, which statics knows. A motor, a robot or a user presses on a stack with a
force that only the engine knows. If the engine reports contact forces, two kinds of forces count as pushes:

- forces at contacts that are not load-bearing;
- all forces of bodies that the user holds or the host moves.

The forces of a live body faster than ``load_speed`` do not count. The module averages the force over ``load_s``, so
that a short bump does not count. In each frame of length dt with a push, the force f changes the mean push p:

p <- (1 - w) p + w f,    w = min(1, dt / load_s)
"""

from __future__ import annotations

import numpy as np

from stability_core.compiled import compiled
from stability_core.contact_filter import ContactRows
from stability_core.port import GROUND, IntArray
from stability_core.settings import ROUNDING_S, Limits
from stability_core.stack import FROZEN, LIVE, MOVING, Bodies

CHANGE = 0.2
"""Ratio of the change of a push to the sum of the body's weight and the push. Above this ratio, the core judges the
body's balance again, because smaller changes may be noise of the engine's forces."""


@compiled
def is_push(bodies: Bodies, pusher: int, level: bool, limits: Limits) -> bool:
    """Return True if a body's force at a contact with a frozen body is a push, not only its weight."""
    if pusher == GROUND:
        return False
    row = bodies[pusher]
    if row.state == MOVING:
        return True
    if row.state != LIVE or row.speed > limits.load_speed * np.sqrt(limits.gravity * row.size):
        return False
    return bool(row.held or not level)


@compiled
def _begin(row: Bodies, limits: Limits, now: float, weight: float) -> None:
    """Prepare the mean push for a frame with the ``weight`` in the mean, and drop a push older than ``load_s``."""
    if now - row.pushed_s > limits.load_s:
        row.push[:], row.push_judged[:], row.push_judged_s, row.push_began_s = 0.0, 0.0, now, now
    row.pushed_s = now
    row.push[:] *= 1.0 - weight


@compiled
def _is_due(row: Bodies, limits: Limits, now: float) -> bool:
    """Return True if a push has changed, or has lasted, since the core last judged the body's balance.

    A lasting push counts after ``still_s``, then each time after twice as long.
    ``CHANGE`` limits the change, and the ratio of a lasting push to the body's weight. A force shorter than ``load_s``
    never counts, because it may be the bump of a body that has just arrived.
    """
    if now - row.push_began_s < limits.load_s - ROUNDING_S:
        return False
    change, strength = 0.0, 0.0
    for k in range(3):
        change += (row.push[k] - row.push_judged[k]) ** 2
        strength += row.push[k] ** 2
    change, strength = np.sqrt(change), np.sqrt(strength)
    own = row.mass * limits.gravity
    patience = max(limits.still_s, row.push_judged_s - row.push_began_s)
    lasts = now - row.push_judged_s >= patience and strength > CHANGE * own
    if not lasts and change <= CHANGE * (own + strength):
        return False
    row.push_judged[:], row.push_judged_s = row.push, now
    return True


@compiled
def list_pushed(bodies: Bodies, contacts: ContactRows, limits: Limits, now: float, dt: float, pushed: IntArray) -> int:
    """List the frozen bodies on which a push has changed, or has lasted ``still_s``: O(n).

    Args:
        bodies: the table.
        contacts: kept contacts of the latest frame, shape (n,).
        limits: the settings.
        now: time since the first frame [s].
        dt: length of a frame [s].
        pushed: output, with room for at least 2 n bodies.

    Returns:
        Number of listed bodies.
    """
    touched = 0
    for i in range(len(contacts)):
        contact = contacts[i]
        for target, pusher, sign in ((contact.body_b, contact.body_a, 1.0), (contact.body_a, contact.body_b, -1.0)):
            if target == GROUND or bodies[target].state != FROZEN:
                continue
            if not is_push(bodies, pusher, contact.level, limits):
                continue
            row, weight = bodies[target], min(1.0, dt / limits.load_s)
            if row.pushed_s != now:
                pushed[touched] = target
                touched += 1
                _begin(row, limits, now, weight)
            for k in range(3):
                row.push[k] += sign * contact.force[k] * weight
    kept = 0
    for target in pushed[:touched]:
        if _is_due(bodies[target], limits, now):
            pushed[kept] = target
            kept += 1
    return kept
