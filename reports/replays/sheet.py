"""The layout of large stills and videos: panels with titles side by side, above a legend and the time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from reports.replays.errors import ExportError
from reports.replays.renderer import ByteArray

Colour: TypeAlias = tuple[int, int, int]
Font: TypeAlias = ImageFont.ImageFont | ImageFont.FreeTypeFont

_PAPER, _LINE, _INK, _SOFT = (243, 242, 238), (213, 212, 207), (31, 35, 40), (87, 96, 106)
"""Colours of the page, of lines, of titles and of other text, as in a replay."""
_TEXT_SHARE = 0.032
"""Height of the text as a share of the height of the picture."""
_LEAST_TEXT, _LEAST_EDGE = 9, 64
"""Least height of the text, and least width of a panel and height of a picture [pixels]."""
_HEAD, _FOOT = 2.9, 1.9
"""Heights of the titles and of the last line, in heights of the text."""


@dataclass(frozen=True, slots=True)
class Key:
    """A legend: colours with their names."""

    entries: tuple[tuple[Colour, str], ...]
    """The entries, from left to right."""
    title: str = ""


class Sheet:
    """Layout of a still or video: titles, caption and legend around the panels.

    The class draws titles, caption and legend once, because only the panels and the time change.
    """

    def __init__(self, pixels: tuple[int, int], titles: Sequence[tuple[str, str]], caption: str, key: Key) -> None:
        """Draw titles, caption and legend.

        Args:
            pixels: width and height of the whole picture [pixels].
            titles: title and second line of each panel, from left to right.
            caption: text of the last line, on the left.
            key: the legend, below the panels.

        Raises:
            ExportError: if the picture is too small.
        """
        width, height = pixels
        if width < _LEAST_EDGE * len(titles) or height < _LEAST_EDGE:
            panels = "1 panel" if len(titles) == 1 else f"{len(titles)} panels"
            least = f"{max(width, _LEAST_EDGE * len(titles))}x{max(height, _LEAST_EDGE)}"
            raise ExportError(
                f"the size of a picture with {panels} must be at least {_LEAST_EDGE * len(titles)}x{_LEAST_EDGE} "
                f"pixels, got {width}x{height} pixels: give --still {least} for a still, or --size {least} for a video"
            )
        self._text = max(_LEAST_TEXT, round(_TEXT_SHARE * height))
        self._head = round(_HEAD * self._text)
        self._foot = height - round(_FOOT * self._text)
        self._lefts = [round(number * width / len(titles)) for number in range(len(titles) + 1)]
        self.panel = (width // len(titles), self._foot - self._head)
        """Width and height of a panel [pixels]."""
        self._blank = Image.new("RGB", pixels, _PAPER)
        draw = ImageDraw.Draw(self._blank)
        pad, small, big = self._text // 2, ImageFont.load_default(self._text), ImageFont.load_default(1.15 * self._text)
        for left, (title, second) in zip(self._lefts, titles, strict=False):
            if left:
                draw.line((left, 0, left, self._foot), _LINE, width=max(1, self._text // 12))
            room = self.panel[0] - 2 * pad
            draw.text((left + pad, pad), _shortened(title, room, big), _INK, big)
            draw.text((left + pad, pad + 1.35 * self._text), _shortened(second, room, small), _SOFT, small)
        draw.line((0, self._foot, width, self._foot), _LINE, width=max(1, self._text // 12))
        base = (self._foot + height) / 2
        self._clock = (width - pad, base)
        self._font = small
        end = self._draw_key(draw, key, width - pad - round(draw.textlength("0000.0 s  ", small)), base)
        draw.text((pad, base), _shortened(caption, end - 2 * pad, small), _SOFT, small, anchor="lm")

    def _draw_key(self, draw: ImageDraw.ImageDraw, key: Key, right: float, base: float) -> float:
        """Draw the legend so that it ends at ``right``, on the line ``base``; return its left end."""
        square, gap = 0.8 * self._text, 0.5 * self._text
        for colour, name in reversed(key.entries):
            right -= draw.textlength(name, self._font)
            draw.text((right, base), name, _SOFT, self._font, anchor="lm")
            right -= square + gap / 2
            draw.rectangle((right, base - square / 2, right + square, base + square / 2), fill=colour)
            right -= gap
        draw.text((right, base), key.title, _SOFT, self._font, anchor="rm")
        return right - draw.textlength(key.title, self._font)

    def frame(self, panels: Sequence[ByteArray], time: float) -> Image.Image:
        """Return the whole picture at one time.

        Args:
            panels: pictures of the panels, from left to right, RGBA, each of shape (height, width, 4).
            time: simulated time [s].
        """
        picture = self._blank.copy()
        for left, panel in zip(self._lefts, panels, strict=False):
            shown = Image.fromarray(np.ascontiguousarray(panel))
            picture.paste(shown, (left, self._head), shown)
        ImageDraw.Draw(picture).text(self._clock, f"{time:.1f} s", _INK, self._font, anchor="rm")
        return picture


def _shortened(text: str, room: float, font: Font) -> str:
    """Return ``text``, with an ellipsis in place of the end of a text that is wider than ``room`` [pixels].

    The result is empty if no letter has room.
    """
    if font.getlength(text) <= room:
        return text
    while text and font.getlength(text + "...") > room:
        text = text[:-1]
    return text + "..." if text else ""
