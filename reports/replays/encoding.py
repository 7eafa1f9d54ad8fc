"""Encoding of pictures as MP4 (H.264) or animated GIF with PyAV, the Python binding of FFmpeg's libraries."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from reports.replays.errors import ExportError
from reports.replays.renderer import ByteArray
from reports.replays.sheet import Colour

FORMATS = (".mp4", ".gif")
"""Suffixes of videos."""
_QUALITY = "18"
"""Rate factor of H.264. The factor is 18, because the loss is then invisible, and a video of 1280 x 720 pixels takes
only about 0.1 MB per second."""
_GIF_CLOCK = 100
"""Ticks of a GIF's clock per second."""
_COLOURS = 256
_SHADES, _SHADE_COUNT = (0.25, 1.2), 20
"""Least and greatest factor on a brick's colour that give its shades, and the number of shades."""
_GREY = np.array([1.0, 0.996, 0.98])
"""Factors on red, green and blue that tint the greys as on the page."""


def encoded(
    path: Path, pictures: Iterator[Image.Image], pixels: tuple[int, int], fps: int, colours: Sequence[Colour]
) -> bytes:
    """Return the content of a video.

    Args:
        path: file of the video, whose suffix selects the format.
        pictures: the frames, in mode RGB.
        pixels: width and height of the frames [pixels].
        fps: frames per second.
        colours: colours of the bricks, at most ten, for the palette of a GIF.

    Raises:
        ExportError: if the package of PyAV is missing, if the format does not allow the suffix, the size or the frame
            rate, or from ``pictures``.
    """
    suffix = path.suffix.lower()
    if suffix not in FORMATS:
        raise ExportError(f"{path}: the suffix of a video must be .mp4 or .gif: give --video FILE.mp4 or FILE.gif")
    if fps < 1:
        raise ExportError(f"--fps must be a whole number of at least 1 frame per second, got {fps}: give --fps 25")
    try:
        import av  # an optional package
    except ImportError as error:
        raise ExportError(
            f"a video needs the package 'av' ({error}): install it with 'uv sync --group video'"
        ) from error
    if suffix == ".mp4":
        if pixels[0] % 2 or pixels[1] % 2:
            width, height = (edge + edge % 2 for edge in pixels)
            raise ExportError(
                f"--size of an .mp4 video must have an even width and height, got {pixels[0]}x{pixels[1]} pixels: give "
                f"--size {width}x{height}"
            )
        return _mp4(av, pictures, pixels, fps)
    if _GIF_CLOCK % fps:
        raise ExportError(
            f"--fps of a GIF must divide 100, because GIF counts hundredths of a second, got {fps} frames per "
            "second: give --fps 10, 20, 25 or 50"
        )
    return _gif(av, pictures, pixels, fps, np.array(colours, np.uint8))


def _mp4(av: Any, pictures: Iterator[Image.Image], pixels: tuple[int, int], fps: int) -> bytes:
    content = BytesIO()
    with av.open(content, "w", format="mp4") as container:
        stream = container.add_stream("libx264", rate=fps, options={"crf": _QUALITY})
        stream.width, stream.height = pixels
        stream.pix_fmt = "yuv420p"  # the only one that every browser plays
        for picture in pictures:
            container.mux(stream.encode(av.VideoFrame.from_image(picture)))
        container.mux(stream.encode())
    return content.getvalue()


def _gif(av: Any, pictures: Iterator[Image.Image], pixels: tuple[int, int], fps: int, colours: ByteArray) -> bytes:
    content, palette = BytesIO(), _palette(colours)
    indexed = Image.new("P", (1, 1))
    indexed.putpalette(palette[:, 1:].tobytes())
    with av.open(content, "w", format="gif") as container:
        stream = container.add_stream("gif", rate=fps)
        stream.width, stream.height = pixels
        stream.pix_fmt = "pal8"
        for picture in pictures:
            indices = np.asarray(picture.quantize(palette=indexed, dither=Image.Dither.NONE))
            container.mux(stream.encode(av.VideoFrame.from_ndarray((indices, palette), format="pal8")))
        container.mux(stream.encode())
    return content.getvalue()


def _palette(colours: ByteArray) -> ByteArray:
    """Return the palette of all frames, ARGB, shape (256, 4).

    All frames share one palette, because the colours would flicker with a palette for each frame. The palette holds
    shades of each colour, for faces in light and shade, and a ramp of greys.

    Args:
        colours: red, green and blue of the bricks, shape (c, 3), at most ten.
    """
    shades = np.linspace(*_SHADES, _SHADE_COUNT)[:, None, None] * colours
    greys = np.linspace(0, 255, _COLOURS - _SHADE_COUNT * len(colours))[:, None] * _GREY
    palette = np.full((_COLOURS, 4), 255, np.uint8)
    palette[:, 1:] = np.concatenate([shades.reshape(-1, 3), greys]).clip(0, 255)
    return palette
