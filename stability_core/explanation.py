"""Explain in words why a body is live, or why the core froze it."""

from __future__ import annotations

from typing import Any

import numpy as np

from stability_core.policies.base import Policy
from stability_core.settings import ROUNDING_S, Settings
from stability_core.stack import DOUBTED, FALLS, FIXED, FROZEN, MOVING, TOPPLES


def explain(row: Any, settings: Settings, policy: Policy, dt: float, reason: str) -> str:
    """Explain why a body is frozen or counts as moved by the host, or name the first rule that keeps a live body live.

    Args:
        row: a row of ``BODY``, after an update.
        settings: the tolerances.
        policy: the policy that judges the body.
        dt: length of the latest frame [s].
        reason: reason of the body's last freezing or unfreezing, or an empty text before the first.
    """
    if row["state"] == FROZEN:
        return f"frozen: {reason}"
    if row["state"] == FIXED:
        return "moved by the host: the body keeps its place, and counts as ground"
    if row["state"] == MOVING:
        return f"moved by the host: no body freezes on this body until it has kept its place for {settings.still_s:g} s"
    if row["held"]:
        return "held by the user: the body may freeze after its release"
    if not row["touches"]:
        return (
            "touches neither the ground nor a frozen body: no body below or beside it is frozen yet"
            if row["neighbours"]
            else "touches nothing: the port lists no contact of this body, or only gaps and impacts"
        )
    if row["unsettled"]:
        return (
            f"unfrozen ({reason}) and perhaps at the start of a collapse: the core judges the body again after it has "
            f"moved, or has been calm for {settings.calm_s:g} s (so far {row['lean_s']:.2f} s)"
        )
    if policy.waits_while_shaken and row["quiet_s"] < settings.quiet_s - ROUNDING_S:
        return (
            f"shaken by blows: the policy judges the body again {settings.quiet_s:g} s after the latest blow on its "
            f"pile (so far {row['quiet_s']:.2f} s)"
        )
    return _why_not_at_rest(row, settings, policy.gravity, dt) or _why_refused(row, settings)


def _why_not_at_rest(row: Any, settings: Settings, gravity: float, dt: float) -> str:
    """Return the rule of rest that a body does not meet yet, or an empty text.

    The text is empty for a body at rest, and for a newly listed body that the policy refused.
    """
    if max(row["rest_s"] - settings.rest_s, row["still_s"] - settings.still_s) >= -ROUNDING_S:
        return ""
    if not np.isfinite(row["speed"]):
        return "" if row["refusal"] else "listed for the first time as a live body: its speed is not known yet"
    size, fall_speed = row["size"], np.sqrt(gravity * row["size"])
    in_place = f"; has kept its place for {row['still_s']:.2f} s of {settings.still_s:g} s"
    if row["speed"] > settings.rest_speed * fall_speed:
        limit = _millimetres(settings.rest_speed * fall_speed)
        return f"moves at {_millimetres(row['speed'])}/s, above {limit}/s{in_place}"
    if row["slip"] > settings.rest_slip * fall_speed:
        limit = _millimetres(settings.rest_slip * fall_speed)
        return f"slides at a contact at {_millimetres(row['slip'])}/s, above {limit}/s{in_place}"
    sinking = abs(row["depth"] - row["depth_before"]) / dt
    if row["depth"] > settings.rest_penetration * size and sinking > settings.rest_sinking * fall_speed:
        limit = _millimetres(settings.rest_penetration * size)
        return (
            f"{_millimetres(row['depth'])} deep in its support, above {limit}, and still moving there at "
            f"{_millimetres(sinking)}/s{in_place}"
        )
    return f"at rest for {row['rest_s']:.2f} s of {settings.rest_s:g} s"


def _why_refused(row: Any, settings: Settings) -> str:
    """Return the policy's last reason to refuse a body at rest, or a general text without a refusal."""
    if row["refusal"] == TOPPLES:
        return "topples: the centre of mass lies outside the contact area"
    if row["refusal"] == FALLS:
        return "falls: no contact forces hold the body in the stack"
    if row["refusal"] == DOUBTED:
        return (
            "in doubt: statics proves neither that the body stands nor that it falls; the body may freeze after it has "
            f"kept its place and its neighbours for {settings.doubt_s:g} s (so far {row['steady_s']:.2f} s)"
        )
    return "at rest, but not frozen: the policy did not find the body stable, or has not judged the body yet"


def _millimetres(metres: float) -> str:
    return f"{1e3 * metres:.2g} mm"
