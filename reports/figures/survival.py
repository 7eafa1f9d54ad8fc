"""The figure of survival by level: a panel per engine, a curve per policy."""

from __future__ import annotations

from collections.abc import Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from reports.figures.colours import Ink, inks
from reports.figures.style import INK, STYLE
from reports.statistics.groups import Group, ordered_policies
from reports.statistics.survival import Survival

_PANEL_INCHES = (2.7, 1.9)
"""Width and height of a panel [inch]."""
_COLUMNS = 3
"""Greatest number of panels in a row."""


def has_survival(groups: Sequence[Group]) -> bool:
    """Return whether any group has more than one lifetime, because a single stack has no survival curve."""
    return any(len(group.lifetimes) > 1 for group in groups)


def survival_figure(groups: Sequence[Group]) -> Figure:
    """Draw the survival curves of one scene and profile: a panel per engine, a curve per policy.

    Args:
        groups: groups of the scene and profile, at least one with lifetimes.
    """
    engines = list(dict.fromkeys(group.key.engine for group in groups if group.survival is not None))
    rows, columns = -(-len(engines) // _COLUMNS), min(_COLUMNS, len(engines))
    with mpl.rc_context(STYLE):
        figure = Figure((_PANEL_INCHES[0] * columns, _PANEL_INCHES[1] * rows + 0.3), layout="constrained")
        panels = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False).ravel()
        for panel, engine in zip(panels, engines, strict=False):
            _survival_panel(panel, engine, [group for group in groups if group.key.engine == engine])
        for spare in panels[len(engines) :]:
            spare.set_visible(False)
        handles = {line.get_label(): line for panel in panels for line in panel.get_legend_handles_labels()[0]}
        figure.legend(handles=list(handles.values()), loc="outside upper center", ncols=6, frameon=False)
    return figure


def _survival_panel(axes: Axes, engine: str, groups: Sequence[Group]) -> None:
    ink = inks(ordered_policies(group.key.policy for group in groups))
    axes.grid(True)
    for number, group in enumerate(groups):
        if group.survival is not None:
            width = 1.4 + 1.1 * (len(groups) - 1 - number)  # so that coinciding curves all stay visible
            _draw_survival(axes, group.survival, ink[group.key.policy], group.key.policy, width)
    falls_at = groups[0].expectation.level
    if falls_at is not None:
        axes.axvline(falls_at, color=INK, linewidth=0.8, linestyle=":")
    axes.set(title=engine, xlim=(0, groups[0].levels_planned), ylim=(-0.03, 1.05))
    axes.set(xlabel="level", ylabel="share standing")
    axes.label_outer()


def _draw_survival(axes: Axes, curve: Survival, ink: Ink, label: str, width: float) -> None:
    level, standing = _with_start(curve.level, curve.standing)
    dashes = ink.dash or (None, None)
    axes.step(level, standing, where="post", color=ink.light, dashes=dashes, linewidth=width, label=label)
    if curve.low is not None and curve.high is not None:
        level, low = _with_start(curve.level, curve.low)
        _, high = _with_start(curve.level, curve.high)
        axes.fill_between(level, low, high, step="post", color=ink.light, alpha=0.15, linewidth=0)


def _with_start(level: np.ndarray, share: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Prepend level 0, at which every stack stands, to a survival curve."""
    return np.concatenate([[0.0], level]), np.concatenate([[1.0], share])
