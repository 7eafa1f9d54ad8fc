"""Planks on a tilting surface: planks hold below the friction angle, and slide above this angle, under any load."""

from __future__ import annotations

import math

from scenarios.model import Expectation
from scenarios.planks import MU

TILT_S = 3.0
"""Duration [s] of the tilt."""
MIN_ANGLE = 2.0
"""Least distance [deg] from the friction angle at which the answer is known."""


def on_slope(angle: float, falls_at: int, tilts_at_s: float) -> Expectation:
    """Return the expectation for planks on a slope that ends at ``angle`` [deg].

    Args:
        angle: final angle of the slope [deg]; the tilt lasts ``TILT_S``.
        falls_at: level at which the scene falls if the planks slide.
        tilts_at_s: start of the tilt [s].
    """
    limit = math.degrees(math.atan(MU))
    theory = f"a plank on a slope of {angle:g} deg, friction angle {limit:.1f} deg"
    if angle <= limit - MIN_ANGLE:
        return Expectation("stand", f"{theory}: the plank holds")
    if angle >= limit + MIN_ANGLE:
        return Expectation(
            "fall", f"{theory}: the plank slides", falls_at, not_before_s=tilts_at_s + TILT_S * (limit - 1.0) / angle
        )
    return Expectation("study", f"{theory}: near the limit")
