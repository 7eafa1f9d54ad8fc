"""The figure of pairs: a panel per engine and profile, a line per policy."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from reports.figures.colours import inks
from reports.figures.style import INK, STYLE
from reports.statistics.groups import ordered_policies
from reports.statistics.intervals import Estimate
from reports.statistics.pairs import ALL, PairRow

_PANEL_INCHES = (2.7, 1.9)
"""Width and height of a panel [inch]."""
_COLUMNS = 3
"""Greatest number of panels in a row."""


_SHARE_NAMES = {
    "right": "both right",
    "false_stand": "false stand",
    "false_collapse": "false collapse",
    "creeps": "creeps",
    "failed": "failed",
}
_SHARE_MARKS: Mapping[str, dict[str, Any]] = {
    "right": {"marker": "o", "markersize": 7, "linestyle": ""},
    "false_stand": {"marker": "^", "markersize": 6, "linestyle": "", "fillstyle": "none"},
    "false_collapse": {"marker": "v", "markersize": 6, "linestyle": "", "fillstyle": "none"},
    "creeps": {"marker": "s", "markersize": 5, "linestyle": "", "fillstyle": "none"},
    "failed": {"marker": "x", "markersize": 5, "linestyle": ""},
}


def pairs_figure(rows: Sequence[PairRow]) -> Figure:
    """Draw the success rate of pairs and the rate of each error: a panel per engine and profile, a line per policy."""
    whole = [row for row in rows if row.family == ALL]
    engines = list(dict.fromkeys(row.set_up[:2] for row in whole))
    policies = ordered_policies(row.set_up.policy for row in whole)
    several = len({profile for _, profile in engines}) > 1
    lines, columns = -(-len(engines) // _COLUMNS), min(_COLUMNS, len(engines))
    with mpl.rc_context(STYLE):
        height = 0.24 * len(policies) + 0.55
        figure = Figure((_PANEL_INCHES[0] * columns + 0.4, height * lines + 0.5), layout="constrained")
        panels = figure.subplots(lines, columns, sharex=True, sharey=True, squeeze=False).ravel()
        for panel, (engine, profile) in zip(panels, engines, strict=False):
            _pairs_panel(panel, policies, [row for row in whole if row.set_up[:2] == (engine, profile)])
            panel.set_title(f"{engine} {profile}" if several else engine)
        for spare in panels[len(engines) :]:
            spare.set_visible(False)
        handles = [Line2D([], [], color=INK, label=label, **_SHARE_MARKS[name]) for name, label in _SHARE_NAMES.items()]
        figure.legend(handles=handles, loc="outside upper center", ncols=len(handles), frameon=False)
        figure.supxlabel("share of pairs", fontsize=9)
    return figure


def _pairs_panel(axes: Axes, policies: Sequence[str], rows: Sequence[PairRow]) -> None:
    ink = inks(policies)
    axes.grid(True, axis="x")
    for row in rows:
        place, colour = policies.index(row.set_up.policy), ink[row.set_up.policy].light
        for name in reversed(_SHARE_NAMES) if row.success_rates is not None else ():
            one: Estimate = getattr(row.success_rates, name)
            if name == "right" and one.low is not None and one.high is not None:
                axes.hlines(place, one.low, one.high, color=colour, alpha=0.4, linewidth=2.5)
            if name == "right" or one.value:  # a mark at zero would hide the axis
                axes.plot(one.value, place, color=colour, clip_on=False, **_SHARE_MARKS[name])
    axes.set(xlim=(-0.02, 1.02), ylim=(len(policies) - 0.5, -0.5), yticks=range(len(policies)), yticklabels=policies)
    axes.tick_params(axis="y", length=0)
    axes.label_outer()
