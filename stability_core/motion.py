"""How the live bodies move: speeds, and for how long each has been at rest."""

from __future__ import annotations

import numpy as np

from stability_core.compiled import compiled
from stability_core.port import FloatArray, IntArray
from stability_core.settings import Limits
from stability_core.stack import ABSENT, LIVE, PROVEN, Bodies


@compiled
def track(bodies: Bodies, ids: IntArray, mass: FloatArray, center: FloatArray, dt: float) -> int:
    """Take over mass and centre of the live bodies; a speed is the difference of two centres over ``dt``.

    A body seen for the first time has no speed yet: it counts as infinitely fast.

    Returns:
        How many frozen bodies are listed as well.
    """
    frozen = 0
    for i in range(len(ids)):
        body = bodies[ids[i]]
        if body.state == ABSENT:
            body.state = LIVE
            body.speed = np.inf
            body.unsettled = body.held = body.is_load = False
            body.rest_frames = body.lean_frames = body.load_frames = 0
            body.steady_s, body.steady_neighbours = 0.0, 0
            body.doubt = PROVEN
        elif body.state == LIVE:
            moved = 0.0
            for k in range(3):
                moved += (center[i, k] - body.center[k]) ** 2
            body.speed = np.sqrt(moved) / dt
        else:
            frozen += 1
            continue
        body.mass = mass[i]
        for k in range(3):
            body.center[k] = center[i, k]
        body.slip = body.depth = 0.0
        body.touches = False
        body.supported_by = body.neighbours = 0
    return frozen


@compiled
def _time_in_place(body: Bodies, steady_shift: float, dt: float) -> None:
    """Measure for how long a live body has kept its place, to ``steady_shift`` [m], among the same neighbours."""
    moved = 0.0
    for k in range(3):
        moved += (body.center[k] - body.steady_center[k]) ** 2
    if moved <= steady_shift**2 and body.neighbours == body.steady_neighbours and not body.held:
        body.steady_s += dt
        return
    body.steady_s, body.steady_neighbours = 0.0, body.neighbours
    for k in range(3):
        body.steady_center[k] = body.center[k]


@compiled
def count_frames(bodies: Bodies, ids: IntArray, limits: Limits, dt: float) -> None:
    """Count for how many frames in a row each live body has been at rest, by each of the three rules.

    Strictly at rest, at rest by the rule for leaning, and slow enough to lie on its support. And for how long it has
    kept its place.
    """
    for i in range(len(ids)):
        body = bodies[ids[i]]
        if body.state != LIVE:
            continue
        _time_in_place(body, limits.steady_shift, dt)
        free = body.touches and not body.held
        at_rest = free and body.speed <= limits.rest_speed and body.slip <= limits.rest_slip
        at_rest = at_rest and body.depth <= limits.rest_penetration
        leans = free and body.speed <= limits.lean_speed and body.depth <= limits.lean_penetration
        lies = body.supported_by != 0 and not body.held and body.speed <= limits.load_speed
        body.rest_frames = body.rest_frames + 1 if at_rest else 0
        body.lean_frames = body.lean_frames + 1 if leans else 0
        body.load_frames = body.load_frames + 1 if lies else 0
        if body.unsettled and (body.speed > limits.moving_speed or body.lean_frames >= limits.calm_frames):
            body.unsettled = False


@compiled
def list_due(bodies: Bodies, ids: IntArray, limits: Limits, at_rest: IntArray, leaning: IntArray) -> tuple[int, int]:
    """Write down the bodies whose stability must be decided now; returns how many.

    A body that was refused is asked again after ``rest_frames`` more.

    Args:
        bodies: the table.
        ids: the live bodies, shape (m,).
        limits: the settings.
        at_rest: those at rest are written here, at least m rows.
        leaning: those at rest by the rule for leaning are written here, at least m rows.
    """
    n, m = 0, 0
    for i in range(len(ids)):
        body = bodies[ids[i]]
        if body.state != LIVE or body.unsettled or body.held:
            continue
        rested = body.rest_frames - limits.rest_frames
        if rested >= 0 and rested % limits.rest_frames == 0:
            at_rest[n] = ids[i]
            n += 1
        leaned = body.lean_frames - limits.lean_frames
        if leaned >= 0 and leaned % limits.rest_frames == 0:
            leaning[m] = ids[i]
            m += 1
    return n, m


@compiled
def list_shifted_loads(
    bodies: Bodies, ids: IntArray, limits: Limits, lying: IntArray, gone: IntArray
) -> tuple[int, int]:
    """Write down the live bodies whose patches no longer tell what they rest on; returns how many.

    Args:
        bodies: the table.
        ids: the live bodies, shape (m,).
        limits: the settings.
        lying: those that lie on the stack anew are written here, at least m rows.
        gone: those that lie on it no more are written here, at least m rows.
    """
    n, m = 0, 0
    for i in range(len(ids)):
        body = bodies[ids[i]]
        if body.state != LIVE:
            continue
        moved = 0.0
        for k in range(3):
            moved += (body.center[k] - body.load_center[k]) ** 2
        stale = body.supported_by != body.load_supported_by or moved > limits.load_shift**2
        if body.load_frames >= limits.load_frames and (stale or not body.is_load):
            lying[n] = ids[i]
            n += 1
        elif body.load_frames < limits.load_frames and body.is_load:
            gone[m] = ids[i]
            m += 1
    return n, m
