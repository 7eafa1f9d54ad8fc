"""The style of the figures of a page, and functions that write and embed figures."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.figure import Figure

from reports.figures.colours import inks

INK, FAINT = "#1f2328", "#c9ced6"
"""Colour of text and axes, and colour of grid lines. ``for_page`` replaces both by the colours of the page."""
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
    """Write a figure as SVG and PDF, and return the SVG.

    The files contain no dates, so that equal records give identical files.

    Args:
        figure: the figure, which keeps no layout engine.
        stem: path of the files without suffix.
    """
    with mpl.rc_context(STYLE):
        figure.savefig(stem.with_suffix(".svg"), transparent=True, metadata={"Date": None})
        figure.set_layout_engine("none")  # so that the PDF keeps the layout of the SVG
        figure.savefig(stem.with_suffix(".pdf"), metadata={"CreationDate": None, "ModDate": None})
    return stem.with_suffix(".svg").read_text(encoding="utf-8")


def for_page(svg: str, label: str, policies: Sequence[str]) -> str:
    """Return a figure with the colours and fonts of the page that embeds the figure.

    Args:
        svg: the figure as SVG, from ``save``.
        label: description of the figure for readers who cannot see the figure.
        policies: policies whose colours the page defines as variables ``--policy-NAME``.
    """
    text = svg[svg.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>", "", text, flags=re.DOTALL)
    text = re.sub(r"<style type=.*?</style>", "", text, flags=re.DOTALL)  # it would apply to other drawings of the page
    text = re.sub(r' id="[A-Za-z]+[\w.]*_\d+"', "", text)  # unused ids, the same in every figure
    text = re.sub(r"font: ([\d.]+)px [^;\"]*", r"font-size: \1px", text)
    text = re.sub(r" ?font-family: [^;\"]*;?", "", text)
    for name, ink in inks(policies).items():
        text = text.replace(ink.light, f"var(--policy-{name})")
    text = text.replace(INK, "currentColor").replace(FAINT, "var(--faint)")
    return text.replace("<svg ", f'<svg role="img" aria-label="{label}" ', 1)
