"""Large stills and videos of recorded trials side by side, at any time and from any direction."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Literal, TypeAlias

import numpy as np
from PIL import Image

from reports.records.atomic import write_atomic
from reports.replays.camera import CAMERAS, Camera
from reports.replays.drawing import COLOURS, FIXED_COLOUR, view_of, visible_space
from reports.replays.encoding import encoded
from reports.replays.errors import ExportError
from reports.replays.margins import MARGIN_COLOURS, Margins, Quantity, legend, margins_beside
from reports.replays.renderer import ByteArray, drawn_frames
from reports.replays.replay import Replayed
from reports.replays.sheet import Key, Sheet
from reports.replays.timeline import Timeline

_MOST_PIXELS = 8192
"""Greatest edge of a picture [pixels], because the renderer draws at twice the size, up to 16384 pixels."""
_ROOM = 0.5
"""Greatest growth of the visible space on each horizontal side for fallen bricks, as a share of the longer horizontal
edge of the space."""


Colouring: TypeAlias = Literal["state", "load", "tilt"]
"""Quantity that the colours of bricks show: the state, the load margin or the tilt margin."""


@dataclass(frozen=True, slots=True)
class Film:
    """Size, speed, camera and colours of a video."""

    pixels: tuple[int, int]
    """Width and height [pixels]."""
    fps: int = 25
    """Frames per second. The default is 25, because GIF counts time in hundredths of a second, so that 25 is exact in
    GIF and MP4."""
    speed: float = 1.0
    """Simulated seconds per second of the video."""
    camera: Camera = CAMERAS["corner"]
    colour: Colouring = "state"


def parse_size(text: str, option: str) -> tuple[int, int]:
    """Return width and height [pixels] from a text such as ``1920x1080``.

    Args:
        text: the text.
        option: option of the command that receives the text, for the message.

    Raises:
        ExportError: if the text is not a size in the range.
    """
    width, _, height = text.lower().partition("x")
    if not (width.isdecimal() and height.isdecimal() and int(width) > 0 and int(height) > 0):
        raise ExportError(
            f"{option} must have the form WIDTHxHEIGHT [pixels], got '{text}': give {option} 1920x1080, for example"
        )
    if max(int(width), int(height)) > _MOST_PIXELS:
        fitting = "x".join(str(min(int(edge), _MOST_PIXELS)) for edge in (width, height))
        raise ExportError(
            f"{option} must have edges of at most {_MOST_PIXELS} pixels, got '{text}': give {option} {fitting}"
        )
    return int(width), int(height)


def write_still(
    path: Path,
    trials: Sequence[Replayed],
    pixels: tuple[int, int],
    *,
    at: float | None = None,
    camera: Camera = CAMERAS["corner"],
    colour: Colouring = "state",
) -> None:
    """Write a picture of trials side by side, with titles and legend.

    Args:
        path: file of the picture, whose suffix selects the format.
        trials: trials to show, at least one.
        pixels: width and height of the picture [pixels].
        at: simulated time [s]; None for the end of the longest trial.
        camera: the camera.
        colour: quantity that the colours of bricks show.

    Raises:
        ExportError: in these cases:

            - ``at`` is negative, or later than the end of the longest trial;
            - the suffix is not of a picture format, or the picture is too small;
            - the trials have no bricks, or no margins for a colour by margin;
            - the machine has no renderer, or the renderer fails.
    """
    ends = [Timeline(trial.recording).end_s for trial in trials]
    time = max(ends) if at is None else at
    if not 0 <= time <= max(ends):
        raise ExportError(
            f"--at must be from 0 to {max(ends):g} s, the end of the longest recording, got {time:g} s: give a time in "
            "this range, or leave out --at to show the end"
        )
    content = BytesIO()
    [picture] = _frames(trials, [time], Film(pixels, camera=camera, colour=colour), [time])
    try:
        picture.save(content, Image.registered_extensions()[path.suffix.lower()], optimize=True)
    except (KeyError, OSError):
        raise ExportError(
            f"{path}: the suffix of a picture must be of a format that Pillow writes, got '{path.suffix}': give "
            "--output FILE.png"
        ) from None
    write_atomic(path, content.getvalue())


def write_video(
    path: Path, trials: Sequence[Replayed], film: Film, on_frame: Callable[[int, int], None] = lambda *_: None
) -> None:
    """Write a video of trials side by side, at the same simulated time, from the start to the end of the longest trial.

    Args:
        path: file of the video, ``.mp4`` or ``.gif``.
        trials: trials to show, at least one.
        film: size, speed, camera and colours.
        on_frame: function that receives the number of finished frames and the number of all frames.

    Raises:
        ExportError: in these cases:

            - the format does not allow the suffix, the size or the frame rate;
            - the speed is not positive and finite, or the picture is too small;
            - the trials have no bricks, or no margins for a colour by margin;
            - the package of PyAV is missing;
            - the machine has no renderer, or the renderer fails.
    """
    if not (math.isfinite(film.speed) and film.speed > 0):
        raise ExportError(f"--speed must be a finite number above 0, got {film.speed:g}: give a factor such as 1 or 4")
    end = max(Timeline(trial.recording).end_s for trial in trials)
    count = max(2, math.ceil(end * film.fps / film.speed))
    times = np.minimum(np.arange(1, count + 1) * film.speed / film.fps, end).tolist()

    def counted() -> Iterator[Image.Image]:
        for number, picture in enumerate(_frames(trials, times, film), 1):
            yield picture
            on_frame(number, count)

    colours = [colour for colour, _ in _key(trials, film.colour).entries]
    write_atomic(path, encoded(path, counted(), film.pixels, film.fps, colours))


def _frames(
    trials: Sequence[Replayed], times: Sequence[float], film: Film, instants: Sequence[float] | None = None
) -> Iterator[Image.Image]:
    """Yield the whole picture at each time [s].

    Colours by margin show the margins at ``instants`` [s]; without ``instants``, the margins at ``settled_times``.
    """
    space = visible_space([trial.recording for trial in trials], _ROOM)
    if space is None:
        names = ", ".join(trial.record.trial for trial in trials)
        raise ExportError(
            f"a picture needs at least one brick, got none in the recordings ({names}): choose another trial"
        )
    first = trials[0].record
    sheet = Sheet(
        film.pixels,
        [(_title(trial), trial.end) for trial in trials],
        f"{first.scene} on {first.engine}, {first.profile}, seed {first.seed}",
        _key(trials, film.colour),
    )
    recordings = {trial.record.trial: trial.recording for trial in trials}
    margins = None if film.colour == "state" else margins_beside(recordings, instants)
    views = [
        view_of(
            Timeline(trial.recording),
            times,
            space,
            sheet.panel,
            film.camera,
            margin_colours(margins[number], film.colour) if margins and film.colour != "state" else None,
        )
        for number, trial in enumerate(trials)
    ]
    with drawn_frames(views) as drawn:
        for time, panels in zip(times, drawn, strict=True):
            yield sheet.frame(panels, time)


def margin_colours(margins: Margins, quantity: Quantity) -> Callable[[float], ByteArray]:
    """Return the function that gives red, green and blue of each brick, shape (n, 3), at a time [s]."""
    colours = np.array([*MARGIN_COLOURS, FIXED_COLOUR], np.uint8)  # the last for bodies without a margin
    classes = margins.classes(quantity)
    return lambda time: colours[classes[margins.row(time)]]


def _key(trials: Sequence[Replayed], colour: Colouring) -> Key:
    fixed = ((FIXED_COLOUR, "fixed"),) if any(trial.recording.fixed for trial in trials) else ()
    if colour == "state":
        return Key((*((shown, state) for state, shown in COLOURS.items()), *fixed))
    title, names = legend(colour)
    return Key((*zip(MARGIN_COLOURS, names, strict=True), *fixed), title)


def _title(trial: Replayed) -> str:
    """Return the policy, and whether the trial ran with the extension.

    The record of a trial without the extension has no number of wakes.
    """
    record = trial.record
    return f"{'with' if record.wakes is not None else 'without'} the extension: {record.policy}"
