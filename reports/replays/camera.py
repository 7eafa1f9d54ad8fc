"""The direction from which a picture or video shows a stack: a name, or azimuth, elevation and distance."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

from reports.replays.errors import ExportError
from scenarios.lookup import look_up, unknown_name

_FIELDS = ("azimuth", "elevation", "distance")


@dataclass(frozen=True, slots=True)
class Camera:
    """A camera that looks at the centre of the visible space, with a vertical view angle of 30 degrees."""

    azimuth: float
    """Angle of the direction from the centre to the camera, seen from above [deg]: 0 is +x, and 90 is +y."""
    elevation: float
    """Angle of the direction from the centre to the camera above the horizontal [deg], from -90 to 90. At 90, the top
    of the picture points opposite to the direction that ``azimuth`` gives."""
    distance: float | None = None
    """Distance from the centre [m]; None for 1.1 times the least distance that shows the whole visible space."""


CAMERAS: Mapping[str, Camera] = {
    "corner": Camera(-68.75, 17.19),
    "front": Camera(-90.0, 5.0),
    "side": Camera(0.0, 5.0),
    "top": Camera(-90.0, 90.0),
}
"""Cameras by name. ``corner`` is the camera of stills and replays. ``front`` looks along +y, so that x points right;
``side`` looks along -x, so that y points right."""


def parse_camera(text: str) -> Camera:
    """Return the camera that ``text`` describes, such as ``front`` or ``side,elevation=20,distance=0.5``.

    Args:
        text: parts with commas between them: a name of ``CAMERAS`` (by default ``corner``), then any of ``azimuth``
            [deg], ``elevation`` [deg] and ``distance`` [m] with its value.

    Raises:
        UnknownNameError: if a name is unknown.
        ExportError: if a value is not a number in its range, or if a part after the first has no value.
    """
    camera = CAMERAS["corner"]
    for number, part in enumerate(text.split(",")):
        name, equals, value = (piece.strip() for piece in part.partition("="))
        if equals:
            camera = replace(camera, **{name: _value(name, value)})
        elif number == 0:
            camera = look_up("camera", name, CAMERAS)
        else:
            raise ExportError(
                f"each part of --camera '{text}' after the first must be azimuth=NUMBER, elevation=NUMBER or "
                f"distance=NUMBER, got '{part}': write, for example, --camera front,elevation=20"
            )
    return camera


def _value(name: str, text: str) -> float:
    if name not in _FIELDS:
        raise unknown_name("part of a camera", name, _FIELDS)
    try:
        value = float(text)
    except ValueError:
        raise ExportError(
            f"{name} of the camera must be a number, got '{text}': write {name}=NUMBER in --camera"
        ) from None
    if not math.isfinite(value):
        raise ExportError(f"{name} of the camera must be a finite number, got {text}: write {name}=NUMBER in --camera")
    if name == "elevation" and not -90 <= value <= 90:
        raise ExportError(
            f"elevation of the camera must be from -90 to 90 degrees, got {text}: give elevation=20, for example"
        )
    if name == "distance" and value <= 0:
        raise ExportError(
            f"distance of the camera must be above 0 m, got {text} m: give distance=0.5, for example, or leave out "
            "distance to show everything"
        )
    return value
