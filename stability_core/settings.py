"""All tolerances of the core, each with unit, default and reason: one set for all engines and all sizes.

Lengths are in sizes of a body, which the core infers from its contacts (``contact_filter.note_sizes``), and speeds in
sqrt(gravity times size), so that the core judges a stack that is a hundred times larger and falls ten times more slowly
in the same way. Times are seconds, at any frame rate. For the paper's plank of 117 mm, each default equals the length
or speed that its reason states.
"""

from __future__ import annotations

import math
from dataclasses import astuple, dataclass, field, fields
from typing import Any, TypeAlias

import numpy as np

Limits: TypeAlias = Any
"""One row of a structured array with the fields of ``Settings``, and ``gravity`` [m/s2], for the kernels."""

_PLANK = 59.8e-3
"""Size [m] of the plank for which the tolerances were found: from its centre to the corners of a face."""
_FALL = math.sqrt(9.81 * _PLANK)
"""Unit of speed [m/s] for that plank."""
ROUNDING_S = 1e-6
"""Rounding error [s] of a sum of frame times."""


def _setting(default: float, unit: str, reason: str) -> Any:
    return field(default=default, metadata={"unit": unit, "reason": reason})


def _length(metres: float, reason: str) -> Any:
    """Return a length setting, given for the plank [m]."""
    return _setting(metres / _PLANK, "sizes", reason)


def _speed(metres_a_second: float, reason: str) -> Any:
    """Return a speed setting, given for the plank [m/s]."""
    return _setting(metres_a_second / _FALL, "sqrt(gravity * size)", reason)


@dataclass(frozen=True, slots=True)
class Settings:
    """Tolerances for bodies of any size, at any frame rate.

    Raises:
        ValueError: if a setting is negative or not finite.
    """

    rest_speed: float = _speed(
        3e-3, "3 mm/s: a dropped brick that still recovers from its impact moves faster than this for some frames"
    )
    rest_slip: float = _speed(
        10e-3, "10 mm/s: sliding at the contacts shows a brick that spins about its centre, whose speed is zero"
    )
    rest_penetration: float = _length(
        0.2e-3, "0.2 mm: freezing a brick deeper in its support tilts the next level; 25 levels keep within 5 mm"
    )
    rest_sinking: float = _speed(
        0.1e-3, "0.1 mm/s: a brick whose depth changes more slowly does not recover: its contacts are that soft"
    )
    rest_s: float = _setting(
        0.1, "s", "a manifold shows 1-2 points a frame; the points of six frames of 1/60 s span the true contact area"
    )
    still_s: float = _setting(
        0.5, "s", "a stack that trembles, or whose contacts are soft, is at rest if it has kept its place for so long"
    )
    lean_speed: float = _speed(50e-3, "50 mm/s: an inverted V slips away while a stricter rule waits")
    lean_penetration: float = _length(4e-3, "4 mm: edge contacts of leaning planks recover slowly")
    lean_s: float = _setting(1 / 30, "s", "one frame of 1/60 s alone may be the turning point of a bounce")
    load_speed: float = _speed(
        50e-3, "50 mm/s: a live brick slower than this lies on its support; a faster one is still falling on it"
    )
    load_s: float = _setting(
        1 / 15, "s", "a brick that lands on two supports touches one of them some frames before the other"
    )
    load_shift: float = _length(
        0.2e-3, "0.2 mm: a live load that moved less than the wake margin cannot upset what balanced before"
    )
    impact_speed: float = _speed(0.5, "0.5 m/s: a brick let go on its place approaches it more slowly")
    impact_frames: float = _setting(
        3.0, "frames of gravity", "what is let go on its place gains two frames of gravity before the solver stops it"
    )
    slide: float = _length(
        78e-6, "78 um: a hundredth of a plank's thickness: a blow that moves a brick by less leaves it where it is"
    )
    contact_gap: float = _length(
        0.5e-3, "0.5 mm: engines report contacts before touch and through thin bricks; those carry nothing"
    )
    touch_gap: float = _length(
        20e-6,
        "20 um: friction needs pressure: what is not load-bearing counts only if it overlaps, or gapes by no more than "
        "the noise of an engine's poses; 0.1 mm let a neighbour's side hold a brick across its gap",
    )
    face_angle: float = _setting(
        math.radians(10),
        "rad",
        "contact points of a pair belong to one face if their normals differ by less: a box's faces lie 90 deg apart, "
        "the noise of a normal stays below 1 deg",
    )
    point_radius: float = _length(
        5e-6,
        "5 um: what touches in points and lines alone may lie off them by so much: a sphere's point in single "
        "precision lies micrometres beside the vertical, where no force could balance it",
    )
    level_tilt: float = _setting(
        math.radians(2), "rad", "a contact this level is a support even where friction is nil: its noise is no slope"
    )
    flat_width: float = _length(
        1e-3, "1 mm: a contact area narrower than this is an edge: the object stands on it but does not lie flat"
    )
    wake_margin: float = _length(
        0.25e-3,
        "0.25 mm: hysteresis: freezing asks for a centre inside the area, waking for one this far outside",
    )
    doubt_s: float = _setting(
        1.0,
        "s",
        "what statics leaves in doubt is frozen only after the engine itself held it in place for so long; a fall "
        "from rest that is this slow moves a brick by more than ``steady_shift``",
    )
    steady_shift: float = _length(0.2e-3, "0.2 mm: a brick that keeps its place moves less than the wake margin")
    moving_speed: float = _speed(
        10e-3, "10 mm/s: a woken brick that was seen faster than this has really moved and may freeze as any other"
    )
    calm_s: float = _setting(
        0.5, "s", "a woken brick that does not move may be at the start of a collapse, which takes half a second"
    )
    gravity_tilt: float = _setting(
        math.radians(0.02),
        "rad",
        "0.02 deg: less may be the noise of an accelerometer; frozen bodies are judged again once gravity has turned "
        "by so much in all, which is five times a second at 0.1 deg/s",
    )
    gravity_change: float = _setting(
        0.01,
        "share of the strength",
        "statics gives the same verdict at any strength of gravity; limits of speed grow with its square root only",
    )

    budget: float = _setting(
        24.0,
        "bodies a frame",
        "candidates are deferred to the next frame once statics was solved for so many bodies, which takes some "
        "milliseconds; ``adopt`` knows no budget",
    )
    longest_calm_s: float = _setting(
        4.0, "s", "what is woken again and again waits twice as long each time, up to this: a pile that is built moves"
    )
    flight_speed: float = _speed(0.3, "0.3 m/s: a body this fast comes to rest elsewhere: its wakes are forgotten")

    def __post_init__(self) -> None:
        for item in fields(self):
            value = getattr(self, item.name)
            if not isinstance(value, int | float | np.integer | np.floating) or isinstance(value, bool):
                raise ValueError(f"setting {item.name} must be a number, got {value!r}")
            if not (math.isfinite(value) and value >= 0):
                raise ValueError(f"setting {item.name} must be finite and not negative, got {value}")
        if self.rest_s == 0:
            raise ValueError("setting rest_s must be above 0 s: it is also the pace at which bodies are asked again")

    @property
    def longest_dwell(self) -> float:
        """Time [s] for which contacts must be kept: the longest dwell of the three rules."""
        return max(self.rest_s, self.lean_s, self.load_s)

    def limits(self, gravity: float) -> Limits:
        """Return the settings as a structured array of shape (1,), for the kernels; gravity [m/s2] is positive."""
        return np.array([(*astuple(self), gravity)], _LIMITS)


_LIMITS = np.dtype([*((item.name, "f8") for item in fields(Settings)), ("gravity", "f8")], align=True)
"""Dtype of all settings. This dtype is one shared object, because Numba recognises the same object at once and compares
different objects field by field."""
