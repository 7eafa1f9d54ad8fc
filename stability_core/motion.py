"""Motion of the live bodies: the speed of each body, and its time at rest."""

from __future__ import annotations

import numpy as np

from stability_core.compiled import compiled
from stability_core.contact_filter import is_moving
from stability_core.frame_arrays import MassArrays
from stability_core.port import FloatArray, IntArray
from stability_core.settings import ROUNDING_S, Limits
from stability_core.stack import ABSENT, DOUBTED, FALLS, FROZEN, LIVE, NOT_REFUSED, PROVEN, Bodies


@compiled
def track(bodies: Bodies, masses: MassArrays, dt: float) -> int:
    """Update mass, centre and speed of the live bodies.

    The speed is the distance between the centres in this frame and in the last frame, over ``dt`` [s]. A new body
    counts as infinitely fast, because its speed is unknown. ``kinematic.follow_host`` updates kinematic bodies.

    Returns:
        Number of frozen bodies in ``masses``.
    """
    ids, mass, center = masses.body, masses.mass, masses.center
    frozen = 0
    for i in range(len(ids)):
        body = bodies[ids[i]]
        if body.state == ABSENT:
            body.state = LIVE
            body.speed = np.inf
            body.unsettled = body.held = body.is_load = False
            body.idle_s = body.rest_s = body.still_s = body.lean_s = body.load_s = 0.0
            body.steady_s, body.steady_neighbours = 0.0, 0
            body.doubt, body.refusal = PROVEN, NOT_REFUSED
            body.quiet_s = np.inf
            body.deferred = False
            body.wakes = body.shifts = body.refusals = 0
            body.lately = body.stood_on = 0
            body.lately_s = body.stood_on_s = body.not_before_s = 0.0
            body.size = body.depth = 0.0
        elif body.state == LIVE:
            moved = 0.0
            for k in range(3):
                moved += (center[i, k] - body.center[k]) ** 2
            body.speed = np.sqrt(moved) / dt
        else:
            frozen += body.state == FROZEN
            continue
        body.mass = mass[i]
        for k in range(3):
            body.center[k] = center[i, k]
        body.depth_before = body.depth
        body.slip = body.depth = 0.0
        body.carrier_normal[:] = 0.0
        body.touches = False
        body.quiet_s += dt
        body.quiet_before_s = body.quiet_s
        body.restless = 0
        body.supported_by = body.neighbours = body.frozen_neighbours = 0
    return frozen


@compiled
def _squared_distance(a: FloatArray, b: FloatArray) -> float:
    total = 0.0
    for k in range(3):
        total += (a[k] - b[k]) ** 2
    return float(total)


@compiled
def _turns(body: Bodies, limits: Limits) -> bool:
    """Return True if the kinematic bodies that touch a body have turned it by more than ``steady_shift``, here in rad.

    The angle counts from the last frame with the result True. A turn counts as motion, because the body's centre may
    keep its place, and its contacts may not slide.
    """
    length = 0.0
    for k in range(3):
        length += body.carrier_normal[k] ** 2
    if length == 0.0:
        return False
    length = np.sqrt(length)
    turned = 0.0
    for k in range(3):
        turned += (body.carrier_normal[k] / length - body.still_normal[k]) ** 2
    if turned <= limits.steady_shift**2:
        return False
    for k in range(3):
        body.still_normal[k] = body.carrier_normal[k] / length
    return True


@compiled
def _time_in_place(body: Bodies, limits: Limits, fall_speed: float, turns: bool, dt: float) -> None:
    """Measure the time for which a live body has kept its place, and the time for which it also kept its neighbours.

    A change of place or neighbours also clears the body's refusal.
    """
    shift = limits.steady_shift * body.size
    if (
        not turns
        and _squared_distance(body.center, body.still_center) <= shift**2
        and body.slip <= limits.lean_speed * fall_speed
    ):
        body.still_s += dt
    else:
        body.still_s = 0.0
        for k in range(3):
            body.still_center[k] = body.center[k]
    is_steady = _squared_distance(body.center, body.steady_center) <= shift**2
    has_lost = False
    body.lately |= body.neighbours
    body.lately_s += dt
    if body.lately_s >= limits.rest_s - ROUNDING_S:  # so that a trembling contact does not count as lost
        has_lost = (body.steady_neighbours & ~body.lately) != 0
        body.lately, body.lately_s = body.neighbours, 0.0
    has_gained = (body.neighbours & ~body.steady_neighbours) != 0
    if is_steady and not has_lost and not has_gained and not body.held:
        body.steady_s += dt
        return
    body.steady_s, body.steady_neighbours = 0.0, body.neighbours
    body.lately, body.lately_s = body.neighbours, 0.0
    body.refusal = NOT_REFUSED
    for k in range(3):
        body.steady_center[k] = body.center[k]


@compiled
def _dwell(body: Bodies, rest_s: float, limits: Limits) -> float:
    """Return the time [s] that counts as rest: ``rest_s``, or the time in its place of a body that trembles."""
    return float(rest_s if rest_s >= limits.rest_s - ROUNDING_S else body.still_s - limits.still_s + limits.rest_s)


@compiled
def _patience(body: Bodies, limits: Limits) -> float:
    """Return the additional rest time [s] of a body.

    The time is zero before the second unfreezing, then ``calm_s``. Each further unfreezing doubles the time, up to
    ``longest_calm_s``, because a body that unfreezes repeatedly usually lies in a pile that still moves. The
    unfreezings of the bodies that it touches count as well, but for one, because a body that has just landed on such a
    pile moves with the pile.
    """
    wakes = max(body.wakes, body.restless - 1)
    if wakes < 2:
        return 0.0
    return float(min(limits.calm_s * 2.0 ** (wakes - 2), limits.longest_calm_s))


@compiled
def time_at_rest(bodies: Bodies, ids: IntArray, limits: Limits, dt: float) -> None:
    """Measure the times for which each live body has been at rest, and the times for which it has kept its place.

    Three rules of rest have a time each:

    - ``rest_s``: strictly at rest;
    - ``lean_s``: at rest by the rule for leaning;
    - ``load_s``: slow enough to lie on a support.

    A body without any contact so far has size zero, so that no speed above zero counts as slow.
    """
    for i in range(len(ids)):
        body = bodies[ids[i]]
        if body.state != LIVE:
            continue
        fall_speed = np.sqrt(limits.gravity * body.size)
        turns = _turns(body, limits)
        _time_in_place(body, limits, fall_speed, turns, dt)
        free = body.touches and not body.held
        if body.speed > limits.flight_speed * fall_speed:
            body.wakes = body.refusals = 0
        sinking = abs(body.depth - body.depth_before)
        is_deep = body.depth > limits.rest_penetration * body.size and sinking > limits.rest_sinking * fall_speed * dt
        slow = not turns and body.speed <= limits.rest_speed * fall_speed and body.slip <= limits.rest_slip * fall_speed
        leans = (
            not turns
            and body.speed <= limits.lean_speed * fall_speed
            and body.depth <= limits.lean_penetration * body.size
        )
        lies = body.supported_by != 0 and not body.held and body.speed <= limits.load_speed * fall_speed
        body.idle_s = body.idle_s + dt if slow and not is_deep and not body.held else 0.0
        dwell = _dwell(body, body.idle_s, limits)
        has_waited = dwell >= limits.rest_s + _patience(body, limits) - ROUNDING_S
        body.is_resting = has_waited and not body.unsettled and not body.held
        body.rest_s = body.rest_s + dt if free and slow and not is_deep else 0.0
        body.lean_s = body.lean_s + dt if free and leans else 0.0
        body.load_s = body.load_s + dt if lies else 0.0
        if body.unsettled and (is_moving(body, limits) or body.lean_s >= limits.calm_s - ROUNDING_S):
            body.unsettled = False


@compiled
def _is_asked(elapsed: float, dwell: float, again: float, dt: float, rarely: bool, deferred: bool) -> bool:
    """Return True if this frame must test a body: at ``elapsed`` = ``dwell`` [s], then every ``again`` [s].

    With ``rarely``, the further tests are at ``dwell`` plus 1, 2, 4, 8, ... times ``again``. For a ``deferred`` body,
    the result is True in every frame after ``dwell``.
    """
    late = elapsed - dwell + ROUNDING_S
    if late < dt or deferred:
        return bool(late >= 0.0)
    times = int(late / again)
    if times == int((late - dt) / again):
        return False
    return not rarely or (times & (times - 1)) == 0


@compiled
def list_due(
    bodies: Bodies, ids: IntArray, limits: Limits, dt: float, at_rest: IntArray, leaning: IntArray
) -> tuple[int, int]:
    """List the bodies that need a decision about their stability now, and return the lengths of both lists.

    If the policy does not freeze a listed body, the function lists the body again:

    - a deferred body in the next frame;
    - a body with the refusal FALLS at 1, 2, 4, 8, ... times ``rest_s`` after the first listing;
    - a body with the refusal DOUBTED once the body has kept its place and its neighbours for ``doubt_s``;
    - any other body every ``rest_s``.

    The waits after FALLS and DOUBTED are long, because solves are expensive. A change of the frozen neighbours shortens
    these waits to ``rest_s``.

    Args:
        bodies: the table.
        ids: the listed bodies, shape (m,), of which only live bodies count.
        limits: the settings.
        dt: time since the last frame [s].
        at_rest: output, bodies at rest, with room for at least m bodies.
        leaning: output, bodies at rest by the rule for leaning, with room for at least m bodies.
    """
    n, m = 0, 0
    for i in range(len(ids)):
        body = bodies[ids[i]]
        if body.state != LIVE or body.unsettled or body.held or not body.touches:
            continue
        dwell = _dwell(body, body.rest_s, limits)
        patience = _patience(body, limits)
        is_as_refused = body.frozen_neighbours == body.refused_among
        if is_as_refused and body.refusal == DOUBTED and body.steady_s < limits.doubt_s - ROUNDING_S:
            continue
        rarely = is_as_refused and body.refusal == FALLS
        again, body.deferred = body.deferred, False
        if _is_asked(dwell - patience, limits.rest_s, limits.rest_s, dt, rarely, again):
            at_rest[n] = ids[i]
            n += 1
        if _is_asked(body.lean_s - patience, limits.lean_s, limits.rest_s, dt, rarely, again):
            leaning[m] = ids[i]
            m += 1
    return n, m


@compiled
def _has_other_supports(body: Bodies, limits: Limits, dt: float) -> bool:
    """Return True if a load has gained a support since its patches were built, or has lost a support.

    A support is lost if the load has not touched it for ``rest_s``, because a trembling contact comes and goes.
    """
    body.stood_on |= body.supported_by
    body.stood_on_s += dt
    has_lost = False
    if body.stood_on_s >= limits.rest_s - ROUNDING_S:
        has_lost = (body.load_supported_by & ~body.stood_on) != 0
        body.stood_on, body.stood_on_s = body.supported_by, 0.0
    return bool(has_lost or (body.supported_by & ~body.load_supported_by) != 0)


@compiled
def list_shifted_loads(
    bodies: Bodies, ids: IntArray, limits: Limits, dt: float, lying: IntArray, gone: IntArray
) -> tuple[int, int]:
    """List the live bodies with missing or outdated patches, and return the lengths of both lists.

    Patches are outdated after a gain or a loss of a support, and after a shift of the load. A load that trembles for
    longer is listed more rarely: each shift doubles the distance of the next one, up to ``farthest_shift``. After a
    load has kept its place for ``doubt_s``, the function lists the load once more, so that the judgement of a load at
    rest is exact. From then on, a joint solve of the load with the stack can decide.

    Args:
        bodies: the table.
        ids: the listed bodies, shape (m,), of which only live bodies count.
        limits: the settings.
        dt: time since the last frame [s].
        lying: output, bodies on a support with missing or outdated patches, with room for at least m bodies.
        gone: output, bodies that have patches, but no longer lie on a support, with room for at least m bodies.
    """
    n, m = 0, 0
    for i in range(len(ids)):
        body = bodies[ids[i]]
        if body.state != LIVE:
            continue
        shift = min(limits.load_shift * 2.0**body.shifts, limits.farthest_shift) * body.size
        has_shifted = _squared_distance(body.center, body.load_center) > shift**2
        has_other_supports = _has_other_supports(body, limits, dt)
        keeps_place = limits.doubt_s - ROUNDING_S
        ripens = body.steady_s >= keeps_place and body.load_steady_s < keeps_place
        lies = body.load_s >= limits.load_s - ROUNDING_S
        if lies and (has_shifted or has_other_supports or ripens or not body.is_load):
            body.shifts = body.shifts + has_shifted if body.is_load else 0
            lying[n] = ids[i]
            n += 1
        elif not lies and body.is_load:
            gone[m] = ids[i]
            m += 1
    return n, m
