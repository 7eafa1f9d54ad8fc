"""A colour and dash for each policy, and a marker for each engine, distinguishable by colour-blind readers.

The colours follow Okabe and Ito (https://jfly.uni-koeln.de/color/). A dark page uses lighter colours of the same hue.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Ink:
    """Colours and dash of a policy in figures."""

    light: str
    """Colour on a light page."""
    dark: str
    """Colour on a dark page."""
    dash: tuple[float, ...]
    """Lengths of dashes and gaps [line widths]; empty for a solid line."""


_INKS = {
    "none": Ink("#5c5c5c", "#b8b8b8", (4, 1.5)),
    "native": Ink("#b1609a", "#e0a3cc", (1, 1)),
    "raised": Ink("#8a5a00", "#d9b26a", (3, 1, 1, 1)),
    "at_rest": Ink("#c75000", "#ff9d5c", (2, 1)),
    "paper": Ink("#0068a8", "#6bb8ee", ()),
    "equilibrium": Ink("#007d5a", "#4fd1a5", (6, 1)),
    "pile": Ink("#3f6d8a", "#9fc9de", (5, 1, 1, 1)),
    "stacking_tree": Ink("#8f7a00", "#e6d44f", (2, 2)),
    "weld": Ink("#5b4fb0", "#b3a9f2", (7, 1, 1, 1)),
    "weld_own": Ink("#7d5a50", "#d6b3a8", (1, 2)),
}
_OTHERS = (
    Ink("#4d4d00", "#c9c95a", (3, 3)),
    Ink("#8a3b3b", "#e39a9a", (6, 2)),
)
_MARKERS = "osD^vPX*hp"


def inks(policies: Sequence[str]) -> dict[str, Ink]:
    """Return the ink of each policy; policies without an entry in ``_INKS`` use ``_OTHERS`` in turn."""
    unknown = [name for name in policies if name not in _INKS]
    return {name: _INKS.get(name) or _OTHERS[unknown.index(name) % len(_OTHERS)] for name in policies}


def markers(engines: Sequence[str]) -> dict[str, str]:
    """Return the marker of each engine, as the letter by which matplotlib names the marker.

    The markers repeat after ten engines.
    """
    return {name: _MARKERS[number % len(_MARKERS)] for number, name in enumerate(engines)}
