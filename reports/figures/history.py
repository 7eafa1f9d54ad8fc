"""The figure of a history: a panel for each series of values over the versions, with the steps of the series."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from reports.figures.style import FAINT, INK, STYLE
from reports.records.atomic import atomic_file
from reports.records.history import History, Kind, Series

_PANEL_INCHES = (9.0, 1.25)
"""Width and height of a panel [inch]."""
_LINE, _STEP = "#0072b2", "#d55e00"
"""Colours of values and of steps, of Okabe and Ito, distinguishable by colour-blind readers."""
_FACTORS: dict[Kind, tuple[float, str]] = {"creep": (1e6, "um/s"), "sink": (1e3, "mm")}
"""Factor and unit of the panels of a kind of figure, if the panels do not have the unit of the values."""
_COUNTS: frozenset[Kind] = frozenset({"levels", "collapse"})
"""Kinds of whole numbers."""


def write_history_figure(path: Path, history: History) -> None:
    """Write the figure as SVG, atomically; equal histories give identical bytes."""
    with mpl.rc_context(STYLE), atomic_file(path) as draft:
        history_figure(history).savefig(draft, format="svg", metadata={"Date": None})


def history_figure(history: History) -> Figure:
    """Draw a panel for each series of values over the versions, with a line at each step."""
    width, height = _PANEL_INCHES
    panels = max(1, len(history.series))
    figure = Figure(figsize=(width, height * panels + 0.9), layout="constrained")
    axes = figure.subplots(panels, 1, sharex=True, squeeze=False)[:, 0]
    versions = [point.version for point in history.points]
    for place, series in zip(axes, history.series, strict=False):
        _draw(place, series)
        for step in history.steps:
            if step.series == series.name:
                place.axvline(versions.index(step.version) - 0.5, color=_STEP, linewidth=1.0)
    axes[-1].set_xticks(range(len(versions)), versions, rotation=90, fontsize=7)
    axes[-1].set_xlim(-0.5, len(versions) - 0.5)
    return figure


def display(series: Series, value: float | None) -> str:
    """Return a value as text, in the unit of the panel of its series; ``-`` without a value."""
    if value is None:
        return "-"
    factor, unit = _FACTORS.get(series.kind, (1.0, series.unit))
    return f"{value * factor:.3g} {unit}"


def _draw(place: Axes, series: Series) -> None:
    factor, unit = _FACTORS.get(series.kind, (1.0, series.unit))
    values: Sequence[float] = [math.nan if value is None else value * factor for value in series.values]
    place.plot(range(len(values)), values, color=_LINE, marker="o", markersize=3, linewidth=1.0)
    place.set_title(f"{series.name} [{unit}]", loc="left", color=INK)
    place.grid(axis="y", color=FAINT)
    place.margins(y=0.2)
    if series.kind in _COUNTS:
        place.yaxis.set_major_locator(MaxNLocator(integer=True, nbins=4))
