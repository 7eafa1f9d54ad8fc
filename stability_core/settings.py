"""All tolerances of the core, each with unit, default and reason: one set for all engines and all sizes.

The unit of lengths is a body's size. The core infers the size from the body's contacts (``contact_filter.note_sizes``).
The unit of speeds is sqrt(gravity times size). With these units the core judges a stack of any scale in the same way.
For example, a stack a hundred times larger takes ten times as long to fall. Times are in seconds, at any frame rate.
For the paper's plank of 117 mm, each default equals the length or the speed in the default's reason.
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
"""Unit of speed [m/s] for the same plank: sqrt(gravity times size)."""
ROUNDING_S = 1e-6
"""Tolerance [s] for the rounding of a sum of frame times."""


def _setting(default: float, unit: str, reason: str) -> Any:
    return field(default=default, metadata={"unit": unit, "reason": reason})


def _length(metres: float, reason: str) -> Any:
    """Return a setting in sizes for a length [m] of the paper's plank."""
    return _setting(metres / _PLANK, "sizes", reason)


def _speed(metres_a_second: float, reason: str) -> Any:
    """Return a setting in sqrt(gravity * size) for a speed [m/s] of the paper's plank."""
    return _setting(metres_a_second / _FALL, "sqrt(gravity * size)", reason)


@dataclass(frozen=True, slots=True)
class Settings:
    """Tolerances for bodies of any size, at any frame rate.

    Raises:
        ValueError: if a setting is no finite number from 0, if ``repose`` is not below pi/2, or if ``rest_s`` is 0.
    """

    rest_speed: float = _speed(
        3e-3, "3 mm/s, because a dropped brick that still recovers from its impact moves faster for some frames"
    )
    rest_slip: float = _speed(
        10e-3, "10 mm/s, because only the sliding at its contacts shows that a brick spins about its centre"
    )
    rest_penetration: float = _length(
        0.2e-3,
        "0.2 mm, because a brick that freezes deeper in its support tilts the next level: 25 levels stay within 5 mm",
    )
    rest_sinking: float = _speed(
        0.1e-3,
        "0.1 mm/s, because the depth of a brick that rests on soft contacts changes more slowly",
    )
    rest_s: float = _setting(
        0.1,
        "s",
        "six frames of 1/60 s, because a manifold shows 1-2 points per frame, and six frames span the true "
        "contact area",
    )
    still_s: float = _setting(
        0.5,
        "s",
        "0.5 s, because a brick that trembles, or has soft contacts, is at rest if it has kept its place for this time",
    )
    lean_speed: float = _speed(50e-3, "50 mm/s, because an inverted V slips away while a stricter rule waits")
    lean_penetration: float = _length(4e-3, "4 mm, because edge contacts of leaning planks recover slowly")
    lean_s: float = _setting(
        1 / 30, "s", "two frames of 1/60 s, because a single frame may be the turning point of a bounce"
    )
    load_speed: float = _speed(
        50e-3, "50 mm/s, because a slower live brick lies on its support, and a faster brick is still falling"
    )
    load_s: float = _setting(
        1 / 15, "s", "four frames of 1/60 s, because a brick that lands on two supports touches them some frames apart"
    )
    load_shift: float = _length(
        0.2e-3,
        "0.2 mm, because a live load that moved less than ``wake_margin`` cannot unbalance a stack that "
        "balanced before",
    )
    impact_speed: float = _speed(
        0.5, "0.5 m/s, because a brick released at its place approaches its support more slowly"
    )
    impact_frames: float = _setting(
        3.0,
        "frames of gravity",
        "3 frames, because a brick released at its place falls for two frames before the solver stops the brick",
    )
    slide: float = _length(
        78e-6, "78 um, a hundredth of a plank's thickness, because a brick that a blow moves by less keeps its place"
    )
    contact_gap: float = _length(
        0.5e-3,
        "0.5 mm, because engines report contacts before touch and through thin bricks, and such contacts carry no load",
    )
    touch_gap: float = _length(
        20e-6,
        "20 um, because friction needs pressure: a contact that is not load-bearing counts only if it overlaps, or if "
        "its gap is at most the noise of an engine's poses. With 0.1 mm, a neighbour's side held a brick across a gap",
    )
    face_angle: float = _setting(
        math.radians(10),
        "rad",
        "10 deg between the normals of two points of one face, because a box's faces differ by 90 deg, and the noise "
        "of a normal stays below 1 deg",
    )
    point_radius: float = _length(
        5e-6,
        "5 um, by which the contact point of a body that touches only in points and lines may be off, because in "
        "single precision a sphere's point lies micrometres beside the vertical, where no force could balance the "
        "sphere",
    )
    level_tilt: float = _setting(
        math.radians(2),
        "rad",
        "2 deg, because the noise of a normal must not count as a slope, also where friction is zero",
    )
    flat_width: float = _length(
        1e-3, "1 mm, because a narrower contact area is an edge: a body stands on an edge, but does not lie flat"
    )
    wake_margin: float = _length(
        0.25e-3,
        "0.25 mm outside the contact area, as a hysteresis, because a body freezes only if its centre lies inside",
    )
    doubt_s: float = _setting(
        1.0,
        "s",
        "1 s for which the engine must hold a body in place that statics leaves in doubt, because even a slow fall "
        "from rest moves a brick by more than ``steady_shift`` in this time",
    )
    farthest_shift: float = _length(
        1.6e-3,
        "1.6 mm, because each shift of a load that trembles doubles ``load_shift``: after three shifts the core judges "
        "the stack again only after 1.4 % of a plank's length, or once the load has kept its place for ``doubt_s``",
    )
    steady_shift: float = _length(
        0.2e-3, "0.2 mm, because a brick that keeps its place moves less than ``wake_margin``"
    )
    moving_speed: float = _speed(
        10e-3,
        "10 mm/s, because an unfrozen brick that was faster has left its place, and may freeze like any other brick",
    )
    calm_s: float = _setting(
        0.5,
        "s",
        "0.5 s, because an unfrozen brick that does not move may be at the start of a collapse, which takes this time",
    )
    gravity_tilt: float = _setting(
        math.radians(0.02),
        "rad",
        "0.02 deg, because a smaller turn may be the noise of an accelerometer. The core judges frozen bodies again "
        "after gravity has turned by this angle in total, five times a second at 0.1 deg/s",
    )
    gravity_change: float = _setting(
        0.01,
        "share of the strength",
        "1 %, because the verdict of statics does not depend on the strength of gravity, and limits of speed grow "
        "only with its square root",
    )

    budget: float = _setting(
        24.0,
        "bodies a frame",
        "24 bodies, because statics of 24 bodies takes some milliseconds: the core defers further candidates to the "
        "next frame. ``adopt`` has no budget",
    )
    longest_calm_s: float = _setting(
        4.0,
        "s",
        "4 s, because a pile that still grows keeps moving: a body that unfreezes repeatedly waits twice as "
        "long each time, up to this time",
    )
    quiet_s: float = _setting(
        2.0,
        "s",
        "2 s without a blow, because a pile onto which bricks are poured is struck more often, and each blow unfreezes "
        "bodies that froze since the last one",
    )
    repose: float = _setting(
        0.0,
        "rad",
        "0 for atan(mu), because friction alone holds this slope: the angle of repose of the policy 'pile'. A steeper "
        "angle also freezes bodies at rest on steeper slopes. A flatter angle leaves bodies at rest on slopes live",
    )
    flight_speed: float = _speed(
        0.3, "0.3 m/s, because a faster body comes to rest elsewhere: the core forgets the number of its unfreezings"
    )

    def __post_init__(self) -> None:
        for item in fields(self):
            value = getattr(self, item.name)
            if not isinstance(value, int | float | np.integer | np.floating) or isinstance(value, bool):
                raise ValueError(f"setting {item.name} must be a number, got {value!r}: pass a float")
            if not (math.isfinite(value) and value >= 0):
                raise ValueError(
                    f"setting {item.name} must be finite and at least 0, got {value}: pass 0 or a positive number"
                )
        if self.repose >= math.pi / 2:
            raise ValueError(
                f"setting repose must be below pi/2 rad, got {self.repose} rad: pass the angle in radians, such as "
                "math.radians(35)"
            )
        if self.rest_s == 0:
            raise ValueError(
                "setting rest_s must be above 0 s, got 0: pass a positive time, because the core judges a "
                "refused body again every rest_s"
            )

    @property
    def longest_dwell(self) -> float:
        """Time [s] for which the core must keep contacts: the longest dwell time of the three rules of rest."""
        return max(self.rest_s, self.lean_s, self.load_s)

    def limits(self, gravity: float) -> Limits:
        """Return the settings as a structured array of shape (1,), for the kernels.

        Args:
            gravity: gravitational acceleration [m/s2], positive.
        """
        return np.array([(*astuple(self), gravity)], _LIMITS)


_LIMITS = np.dtype([*((item.name, "f8") for item in fields(Settings)), ("gravity", "f8")], align=True)
"""Dtype of all settings. ADR-0002 gives the reason why all arrays of settings share this object."""
