"""The figure of success rate against frame time: a panel per profile, or per engine if there are fewer engines."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from reports.figures.colours import Ink, inks, markers
from reports.figures.style import INK, STYLE
from reports.statistics.groups import ordered_policies
from reports.statistics.scores import FRAME_BUDGETS_MS, EngineScores, PolicyScore

_COLUMNS = 3
"""Greatest number of panels in a row, so that no panel is narrower than its labels."""
_PANEL_INCHES = (3.4, 2.4)
"""Width and height of a panel [inch]."""
_MOST_INCHES = 10.5
"""Greatest width of the figure [inch]."""


def speed_figure(engines: Sequence[EngineScores]) -> Figure | None:
    """Draw the success rate against the frame time of the slowest scene; return None if no score has both quantities.

    Each profile has a panel. If there are more profiles than engines, as in a study of settings, each engine has a
    panel instead.
    """
    points = [
        (scores, score)
        for scores in engines
        for score in scores.scores
        if score.units is not None and score.slowest is not None
    ]
    if not points:
        return None
    by = "profile" if len({one.profile for one, _ in points}) <= len({one.engine for one, _ in points}) else "engine"
    titles = list(dict.fromkeys(getattr(scores, by) for scores, _ in points))
    marker = markers(list(dict.fromkeys(scores.engine for scores in engines)))
    ink = inks(ordered_policies(score.policy for _, score in points))
    rows, columns = -(-len(titles) // _COLUMNS), min(_COLUMNS, len(titles))
    width, height = _PANEL_INCHES
    with mpl.rc_context(STYLE):
        size = min(width * columns + 1.2, _MOST_INCHES), height * rows + 0.8
        figure = Figure(size, layout="constrained")
        panels = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False).ravel()
        for panel, title in zip(panels, titles, strict=False):
            _draw_budgets(panel)
            for scores, score in points:
                if getattr(scores, by) == title:
                    _draw_score(panel, score, ink[score.policy].light, marker[scores.engine])
            panel.set_xscale("log")
            panel.xaxis.set_major_formatter("{x:g}")
            panel.set(title=title, ylim=(-0.03, 1.05))
        for spare in panels[len(titles) :]:
            spare.set_visible(False)
        for panel in panels[max(0, len(titles) - columns) : len(titles)]:  # the lowest panel of each column
            panel.set_xlabel("p99 of slowest scene [ms]")
            panel.tick_params(labelbottom=True)
        has_pairs = any(score.pairs is not None for _, score in points)
        has_others = any(score.others is not None for _, score in points)
        counted = ("pairs, other scenes" if has_others else "pairs") if has_pairs else "stacks"
        for panel in panels[::columns]:
            panel.set_ylabel(f"share of {counted} correct")
        _speed_legend(figure, ink, marker)
    return figure


def _draw_budgets(axes: Axes) -> None:
    axes.grid(True)
    for hertz, budget in FRAME_BUDGETS_MS.items():
        axes.axvline(budget, color=INK, linewidth=0.8, linestyle=":")
        axes.text(
            budget, 0.02, f"{hertz} Hz", transform=axes.get_xaxis_transform(), rotation=90, ha="right", fontsize=7
        )


def _draw_score(axes: Axes, score: PolicyScore, colour: str, marker: str) -> None:
    if score.units is None or score.slowest is None:
        return
    time_ms = score.slowest.frame_ms_p99
    right = score.units.right
    if right.low is not None and right.high is not None:
        axes.vlines(time_ms, right.low, right.high, color=colour, alpha=0.4)
    axes.plot(time_ms, right.value, marker, color=colour, markersize=7, clip_on=False)


def _speed_legend(figure: Figure, ink: Mapping[str, Ink], marker: Mapping[str, str]) -> None:
    axes = figure.axes[0]
    policies = [axes.plot([], [], "s", color=one.light, label=name)[0] for name, one in ink.items()]
    engines = [axes.plot([], [], one, color=INK, fillstyle="none", label=name)[0] for name, one in marker.items()]
    figure.legend(handles=[*policies, *engines], loc="outside right upper", frameon=False)
