"""The figure of levels against frame time: a panel per engine and scene, a mark per profile, a front per policy."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator, NullLocator, StrMethodFormatter

from reports.records.atomic import atomic_file
from reports.statistics.height_cost import CostPoint, frontier

_COLUMNS = 3
"""Greatest number of panels in a row."""
_PANEL_INCHES = (3.1, 2.3)
"""Width and height of a panel [inch]."""
_COLOURS = ("#d55e00", "#0072b2", "#009e73", "#cc79a7", "#e69f00", "#56b4e9")
"""Colours of Okabe and Ito, distinguishable by colour-blind readers."""
_MARKS = "osD^v*"
_FRAME_MS = 1e3 / 60
"""Time of a frame at 60 frames per second [ms]."""


def write_cost_figure(path: Path, points: Sequence[CostPoint]) -> None:
    """Write the figure of at least one point as SVG; equal points give identical bytes."""
    style = mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": "stillstack", "font.size": 8, "axes.titlesize": 9})
    with style, atomic_file(path) as draft:
        cost_figure(points).savefig(draft, format="svg", metadata={"Date": None})


def cost_figure(points: Sequence[CostPoint]) -> Figure:
    """Draw levels over milliseconds per frame: a panel for each engine and scene, all with the same axes.

    The figure shows only the first six policies, because ``_COLOURS`` has six colours.

    Args:
        points: at least one point.
    """
    panels = list(dict.fromkeys((point.scene, point.engine) for point in points))
    policies = list(dict.fromkeys(point.policy for point in points))
    columns = min(_COLUMNS, len(panels))
    rows = -(-len(panels) // columns)
    width, height = _PANEL_INCHES
    figure = Figure(figsize=(width * columns, height * rows + 0.5), layout="constrained")
    axes = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    several = len({scene for scene, _ in panels}) > 1
    for place, (scene, engine) in zip(axes.flat, panels, strict=False):
        here = [point for point in points if (point.scene, point.engine) == (scene, engine)]
        _draw(place, here, policies)
        place.set_title(f"{engine}, {scene}" if several else engine, loc="left", fontweight="bold")
    for place in list(axes.flat)[len(panels) :]:
        place.set_visible(False)
    figure.supxlabel("median time of a frame at its tallest [ms]")
    figure.supylabel("levels that stood")
    figure.legend(handles=_legend(policies), loc="outside upper center", ncols=len(policies) + 2, frameon=False)
    return figure


def _draw(place: Axes, points: Sequence[CostPoint], policies: Sequence[str]) -> None:
    place.axvline(_FRAME_MS, color="0.6", linestyle=":", linewidth=1)
    place.axhline(points[0].planned, color="0.6", linewidth=0.8)
    for policy, colour, mark in zip(policies, _COLOURS, _MARKS, strict=False):
        mine = [point for point in points if point.policy == policy]
        best = frontier(mine)
        place.step(
            [point.frame_ms for point in best],
            [point.levels for point in best],
            where="post",
            color=colour,
            linewidth=1.2,
            alpha=0.7,
        )
        for point in mine:
            place.plot(
                point.frame_ms,
                point.levels,
                mark,
                color=colour,
                markerfacecolor="white" if point.is_bound else colour,
                markeredgecolor=colour if point.is_bound else "white",
                markersize=6,
                clip_on=False,
            )
    place.set_xscale("log")
    place.xaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    place.xaxis.set_minor_locator(NullLocator())
    place.set_ylim(bottom=0)
    place.yaxis.set_major_locator(MaxNLocator(integer=True, nbins=6, steps=[1, 2, 5, 10]))
    place.spines[["top", "right"]].set_visible(False)
    place.grid(axis="y", color="0.92")
    place.set_axisbelow(True)


def _legend(policies: Sequence[str]) -> list[Line2D]:
    marks = [
        Line2D([], [], color=colour, marker=mark, linewidth=1.2, label=policy)
        for policy, colour, mark in zip(policies, _COLOURS, _MARKS, strict=False)
    ]
    bound = Line2D([], [], color="0.3", marker="o", markerfacecolor="none", linestyle="", label="lower bound")
    budget = Line2D([], [], color="0.6", linestyle=":", label="a frame at 60 Hz")
    return [*marks, bound, budget]
