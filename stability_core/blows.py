"""Blows: which frozen bodies a live one is about to strike, or has struck, so hard that they would move.

A frozen body has infinite mass: what strikes it loses its momentum within one step, and to wake it afterwards is too
late. So a contact that closes within the next frame counts before it touches, and the engine simulates the impact.
Blows sideways are judged by the slide that they would cause: after a plastic impact with the striker the body has the
speed v' = v M / (M + m) and slides by v'^2 / (2 mu g). Slides below the limit are added up.
"""

from __future__ import annotations

import numpy as np

from stability_core.compiled import compiled
from stability_core.contact_filter import is_impact, size_of_pair, speeds_of
from stability_core.port import GROUND, FloatArray, IntArray
from stability_core.settings import Limits
from stability_core.stack import FROZEN, LIVE, MOVING, Bodies

AHEAD = 1.5
"""Frames within which a gap must close to count as a blow: one, and half of one for what accelerates."""
SIDEWAYS = 0.3
"""Vertical share of a normal up to which a blow pushes sideways: what lands on a steep face is borne from below."""


@compiled
def _slide_of(
    bodies: Bodies, striker: int, target: int, approach: float, upward: float, friction: float, gravity: float
) -> float:
    """How far [m] a frozen body would slide after a blow at the speed ``approach`` [m/s]; zero if that is downwards."""
    if abs(upward) > SIDEWAYS:
        return 0.0
    mass = bodies[target].mass
    share = 1.0 if bodies[striker].state == MOVING else bodies[striker].mass / (bodies[striker].mass + mass)
    speed = share * approach * np.sqrt(1.0 - upward**2)
    return float(speed**2 / (2.0 * friction * gravity))


@compiled
def _note_blow(
    bodies: Bodies,
    striker: int,
    target: int,
    approach: float,
    upward: float,
    friction: float,
    limits: Limits,
    dt: float,
) -> bool:
    """Note on a frozen body what a contact closing at the speed ``approach`` [m/s] does; True if it is its first."""
    row = bodies[target]
    size = size_of_pair(bodies, striker, target)
    is_hard = is_impact(approach, size, limits, dt)
    slide = 0.0
    if approach > limits.rest_slip * np.sqrt(limits.gravity * size):
        slide = _slide_of(bodies, striker, target, approach, upward, friction, limits.gravity)
    is_first = row.blow == 0.0 and row.slid < np.inf and (slide > 0.0 or is_hard)
    row.blow = max(row.blow, slide)
    if is_hard:
        row.slid = np.inf
    return bool(is_first)


@compiled
def list_struck(
    bodies: Bodies,
    body_a: IntArray,
    body_b: IntArray,
    normal: FloatArray,
    separation: FloatArray,
    relative_velocity: FloatArray,
    friction: FloatArray,
    limits: Limits,
    dt: float,
    struck: IntArray,
) -> int:
    """Write down the frozen bodies that a blow must wake, each once: O(n).

    Args:
        bodies: the table, tracked for this frame.
        body_a: first bodies, shape (n,); this and what follows as ``Contacts`` has it.
        body_b: second bodies, shape (n,).
        normal: unit normals from a to b, shape (n, 3).
        separation: signed distances [m], shape (n,).
        relative_velocity: of b against a [m/s], shape (n, 3).
        friction: Coulomb coefficients, shape (n,).
        limits: the settings.
        dt: length of a frame [s].
        struck: written here, at least 2 n rows.

    Returns:
        How many they are.
    """
    hits = 0
    for i in range(len(body_a)):
        approach, _ = speeds_of(relative_velocity[i], normal[i])
        if not approach > 0.0 or separation[i] > AHEAD * approach * dt:
            continue
        for target, striker in ((body_a[i], body_b[i]), (body_b[i], body_a[i])):
            if target == GROUND or striker == GROUND or bodies[target].state != FROZEN:
                continue
            if bodies[striker].state != LIVE and bodies[striker].state != MOVING:
                continue
            if _note_blow(bodies, striker, target, approach, normal[i, 2], friction[i], limits, dt):
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
