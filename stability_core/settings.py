"""Every tolerance of the core, with its unit, its default and its reason. One set for all engines."""

from __future__ import annotations

import math
from dataclasses import astuple, dataclass, field, fields
from typing import Any, TypeAlias

import numpy as np

Limits: TypeAlias = Any
"""One row of a structured array with the fields of ``Settings``: how the kernels read them."""


def _setting(default: float, unit: str, reason: str) -> Any:
    return field(default=default, metadata={"unit": unit, "reason": reason})


@dataclass(frozen=True, slots=True)
class Settings:
    """Tolerances for bricks of some centimetres; frames are those of the host, 1/60 s or so.

    Raises:
        ValueError: if a setting is negative or not finite.
    """

    rest_speed: float = _setting(
        3e-3, "m/s", "a dropped brick that still recovers from its impact moves faster than this for some frames"
    )
    rest_slip: float = _setting(
        10e-3, "m/s", "sliding at the contacts shows a brick that spins about its own centre, whose speed is zero"
    )
    rest_penetration: float = _setting(
        0.2e-3, "m", "freezing a brick deeper in its support tilts the next level; 0.2 mm keeps 25 levels within 5 mm"
    )
    rest_frames: int = _setting(
        6, "frames", "a manifold shows 1-2 points a frame; the points of six frames span the true contact area"
    )
    lean_speed: float = _setting(50e-3, "m/s", "an inverted V slips away while a stricter rule waits")
    lean_penetration: float = _setting(4e-3, "m", "edge contacts of leaning planks recover slowly")
    lean_frames: int = _setting(2, "frames", "one frame alone may be the turning point of a bounce")
    load_speed: float = _setting(
        50e-3, "m/s", "a live brick slower than this lies on its support; a faster one is still falling on it"
    )
    load_frames: int = _setting(
        4, "frames", "a brick that lands on two supports touches one of them some frames before the other"
    )
    load_shift: float = _setting(
        0.2e-3, "m", "a live load that moved less than the wake margin cannot upset what balanced before"
    )
    impact_speed: float = _setting(
        0.5, "m/s", "must exceed two frames of gravity (0.33 m/s), the approach speed of a brick let go on its place"
    )
    contact_gap: float = _setting(
        0.5e-3, "m", "engines report contacts before touch and through thin bricks; those carry nothing"
    )
    touch_gap: float = _setting(
        20e-6,
        "m",
        "friction needs pressure: what is not load-bearing counts only if it overlaps, or gapes by no more than the "
        "noise of an engine's poses; 0.1 mm let a neighbour's side hold a brick across its gap",
    )
    face_angle: float = _setting(
        math.radians(10),
        "rad",
        "contact points of a pair belong to one face if their normals differ by less: a box's faces lie 90 deg apart, "
        "the noise of a normal stays below 1 deg",
    )
    point_radius: float = _setting(
        5e-6,
        "m",
        "what touches in points and lines alone may lie off them by so much: in single precision a sphere's point lies "
        "micrometres beside the vertical, where no force could balance it",
    )
    level_tilt: float = _setting(
        math.radians(2), "rad", "a contact this level is a support even where friction is nil: its noise is no slope"
    )
    flat_width: float = _setting(
        1e-3, "m", "a contact area narrower than this is an edge: the object stands on it but does not lie flat"
    )
    wake_margin: float = _setting(
        0.25e-3, "m", "hysteresis: freezing asks for a centre inside the area, waking for one this far outside"
    )
    doubt_s: float = _setting(
        1.0,
        "s",
        "what statics leaves in doubt is frozen only after the engine itself held it in place for so long; a fall "
        "from rest that is this slow moves a brick by more than ``steady_shift``",
    )
    steady_shift: float = _setting(0.2e-3, "m", "a brick that keeps its place moves less than the wake margin")
    moving_speed: float = _setting(
        10e-3, "m/s", "a woken brick that was seen faster than this has really moved and may freeze as any other"
    )
    calm_frames: int = _setting(
        30, "frames", "a woken brick that does not move may be at the start of a collapse, which takes half a second"
    )

    def __post_init__(self) -> None:
        for item in fields(self):
            value = getattr(self, item.name)
            if not isinstance(value, int | float | np.integer | np.floating) or isinstance(value, bool):
                raise ValueError(f"setting {item.name} must be a number, got {value!r}")
            if item.type == "int" and not (isinstance(value, int | np.integer) and value >= 1):
                raise ValueError(f"setting {item.name} must be a whole number of frames from 1, got {value}")
            if not (math.isfinite(value) and value >= 0):
                raise ValueError(f"setting {item.name} must be finite and not negative, got {value}")

    @property
    def longest_dwell(self) -> int:
        """Frames of contacts that must be kept for the slowest of the three rules."""
        return max(1, self.rest_frames, self.lean_frames, self.load_frames)

    def limits(self) -> Limits:
        """The settings as a structured array of shape (1,), for the kernels."""
        return np.array([astuple(self)], _LIMITS)


_LIMITS = np.dtype([(item.name, {"int": "i8", "float": "f8"}[str(item.type)]) for item in fields(Settings)], align=True)
"""One for all settings: Numba knows this very object again at once, and another that is equal field by field."""
