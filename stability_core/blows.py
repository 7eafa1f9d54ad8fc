"""Find the frozen bodies that a live or MOVING body strikes, or is about to strike, hard enough to move them.

A striker loses its momentum within one step, because a frozen body has infinite mass. After this step, unfreezing the
struck body is too late. Therefore a contact whose gap will close within ``AHEAD`` frames counts as a blow before the
bodies touch. A blow faster than the limit of ``contact_filter.is_impact`` always unfreezes the struck body. The module
judges a weaker blow by the slide that the blow would cause, if the blow is sideways, and faster than ``rest_slip``. A
striker of mass M strikes a body of mass m at the horizontal speed v. After a plastic impact, the body has the speed v'
and slides to rest:

v' = v M / (M + m),    slide = v'^2 / (2 mu g)

Here mu is the coefficient of friction, and g is the gravitational acceleration. A kinematic striker has infinite mass.
The longest slides of a body in each frame add up, so that many weak blows unfreeze the body as well. If the engine
reports forces, a striker that has touched the body lately, and is slower than ``load_speed``, trembles against the
body, and the module ``pushes`` judges its force instead.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stability_core.compiled import compiled
from stability_core.contact_filter import bit_of, is_impact, size_of_pair, speeds_of
from stability_core.frame_arrays import ContactArrays
from stability_core.port import GROUND, IntArray
from stability_core.settings import Limits
from stability_core.stack import FROZEN, LIVE, MOVING, Bodies

AHEAD = 1.5
"""Time [frames] within which the gap of a contact must close so that the contact counts as a blow. The time is one
frame, and half a frame more because bodies accelerate."""
SIDEWAYS = 0.3
"""Greatest absolute vertical component of a unit normal for a sideways blow, because the supports of the struck body
take a steeper blow."""


class Blow(NamedTuple):
    """A contact whose gap closes."""

    approach: float
    """Closing speed [m/s]."""
    upward: float
    """Vertical component of the contact's unit normal."""
    friction: float
    """Coulomb coefficient of the pair."""
    has_force: bool
    """True if the engine reports the contact's force."""


@compiled
def _speed_after(striker: Bodies, target: Bodies, blow: Blow) -> float:
    """Return the horizontal speed [m/s] of the target after a plastic impact: zero unless the blow is sideways."""
    if abs(blow.upward) > SIDEWAYS:
        return 0.0
    share = 1.0 if striker.state == MOVING else striker.mass / (striker.mass + target.mass)
    return float(share * blow.approach * np.sqrt(1.0 - blow.upward**2))


@compiled
def _has_touched(striker: Bodies, target: int) -> bool:
    """Return True if a live striker already touched the target in one of the latest frames."""
    return bool(striker.state == LIVE and ((striker.lately | striker.steady_neighbours) & bit_of(target)) != 0)


@compiled
def _note_blow(bodies: Bodies, striker: int, target: int, blow: Blow, limits: Limits, dt: float) -> bool:
    """Record a blow on a frozen body, and return True for the body's first effective blow in this frame."""
    row = bodies[target]
    size = size_of_pair(bodies, striker, target)
    is_hard = is_impact(blow.approach, size, limits, dt)
    slide = 0.0
    trembles = blow.has_force and _has_touched(bodies[striker], target)
    slowest = limits.load_speed if trembles else limits.rest_slip
    if blow.approach > slowest * np.sqrt(limits.gravity * size):
        slide = _speed_after(bodies[striker], row, blow) ** 2 / (2.0 * blow.friction * limits.gravity)
    is_first = row.blow == 0.0 and row.slid < np.inf and (slide > 0.0 or is_hard)
    row.blow = max(row.blow, slide)
    if is_hard:
        row.slid = np.inf
    return bool(is_first)


@compiled
def list_struck(bodies: Bodies, contacts: ContactArrays, limits: Limits, dt: float, struck: IntArray) -> int:
    """List the frozen bodies that must unfreeze because of blows, each once: O(n).

    Args:
        bodies: the table, after ``motion.track`` of this frame.
        contacts: n contacts between rows of the table.
        limits: the settings.
        dt: length of a frame [s].
        struck: output, with room for at least 2 n bodies.

    Returns:
        Number of listed bodies.
    """
    body_a, body_b, normal = contacts.body_a, contacts.body_b, contacts.normal
    separation, relative_velocity, friction = contacts.separation, contacts.relative_velocity, contacts.friction
    hits = 0
    for i in range(len(body_a)):
        approach, _ = speeds_of(relative_velocity[i], normal[i])
        if not approach > 0.0 or separation[i] > AHEAD * approach * dt:
            continue
        blow = Blow(approach, normal[i, 2], friction[i], len(contacts.force) > 0)
        for target, striker in ((body_a[i], body_b[i]), (body_b[i], body_a[i])):
            if target == GROUND or striker == GROUND or bodies[target].state != FROZEN:
                continue
            if bodies[striker].state != LIVE and bodies[striker].state != MOVING:
                continue
            if _note_blow(bodies, striker, target, blow, limits, dt):
                struck[hits] = target
                hits += 1
    kept = 0
    for target in struck[:hits]:
        row = bodies[target]
        row.slid += row.blow
        if row.slid > limits.slide * row.size:
            struck[kept] = target
            kept += 1
        else:
            row.blow = 0.0
    return kept
