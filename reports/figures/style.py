"""How all figures of a page look, and how they are written and embedded."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.figure import Figure

from reports.figures.colours import inks

INK, FAINT = "#1f2328", "#c9ced6"
"""Of text and axes, and of grid lines; a page puts its own in their place."""
STYLE: dict[Any, Any] = {
    "svg.fonttype": "none",
    "svg.hashsalt": "stillstack",
    "pdf.fonttype": 42,
    "font.size": 9,
    "font.family": "sans-serif",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": INK,
    "axes.labelcolor": INK,
    "axes.titlesize": 9,
    "axes.titlelocation": "left",
    "axes.titlecolor": INK,
    "text.color": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "grid.color": FAINT,
    "grid.linewidth": 0.6,
}


def save(figure: Figure, stem: Path) -> str:
    """Write a figure as SVG and as PDF, without dates: the same records give the same files. Returns the SVG."""
    with mpl.rc_context(STYLE):
        figure.savefig(stem.with_suffix(".svg"), transparent=True, metadata={"Date": None})
        figure.set_layout_engine("none")  # the layout is found
        figure.savefig(stem.with_suffix(".pdf"), metadata={"CreationDate": None, "ModDate": None})
    return stem.with_suffix(".svg").read_text(encoding="utf-8")


def for_page(svg: str, label: str, policies: Sequence[str]) -> str:
    """A figure as part of a page, in the page's own colours and fonts.

    Args:
        svg: as ``save`` returns it.
        label: what a reader who cannot see it is told.
        policies: of which the page has the colours as variables ``--policy-NAME``.
    """
    text = svg[svg.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>", "", text, flags=re.DOTALL)
    text = re.sub(r"<style type=.*?</style>", "", text, flags=re.DOTALL)  # a page's other drawings must not obey it
    text = re.sub(r' id="[A-Za-z]+[\w.]*_\d+"', "", text)  # the same in every figure; what is referred to is hashed
    text = re.sub(r"font: ([\d.]+)px [^;\"]*", r"font-size: \1px", text)
    text = re.sub(r" ?font-family: [^;\"]*;?", "", text)
    for name, ink in inks(policies).items():
        text = text.replace(ink.light, f"var(--policy-{name})")
    text = text.replace(INK, "currentColor").replace(FAINT, "var(--faint)")
    return text.replace("<svg ", f'<svg role="img" aria-label="{label}" ', 1)
