"""What planks do on a surface that tilts: they hold below the friction angle and slide above it, under any load."""

from __future__ import annotations

import math

from scenarios.model import Expectation
from scenarios.planks import MU

TILT_S = 3.0
"""How long [s] it takes to tilt."""
SURE = 2.0
"""Degrees off the friction angle from which the answer is known."""


def on_slope(angle: float, falls_at: int, tilts_at_s: float) -> Expectation:
    """What must happen to planks on a slope of ``angle`` [deg] in the end.

    Args:
        angle: of the slope, reached within ``TILT_S``.
        falls_at: level at which they fall if they slide.
        tilts_at_s: when [s] it begins to tilt.
    """
    limit = math.degrees(math.atan(MU))
    theory = f"a plank on a slope of {angle:g} deg, friction angle {limit:.1f} deg"
    if angle <= limit - SURE:
        return Expectation("stand", f"{theory}: it holds")
    if angle >= limit + SURE:
        return Expectation(
            "fall", f"{theory}: it slides", falls_at, not_before_s=tilts_at_s + TILT_S * (limit - 1.0) / angle
        )
    return Expectation("study", f"{theory}: near the limit")
