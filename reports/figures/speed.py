"""The figure of success rate against frame time: a panel per profile."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from reports.figures.colours import Ink, inks, markers
from reports.figures.style import INK, STYLE
from reports.statistics.groups import ordered_policies
from reports.statistics.scores import FRAME_BUDGETS_MS, EngineScores, PolicyScore


def speed_figure(engines: Sequence[EngineScores]) -> Figure | None:
    """Draw success rate against frame time, a panel per profile; return None if no score has both."""
    points = [
        (scores, score)
        for scores in engines
        for score in scores.scores
        if score.headline is not None and score.frame_ms_p99 is not None
    ]
    if not points:
        return None
    profiles = list(dict.fromkeys(scores.profile for scores, _ in points))
    marker = markers(list(dict.fromkeys(scores.engine for scores in engines)))
    ink = inks(ordered_policies(score.policy for _, score in points))
    with mpl.rc_context(STYLE):
        figure = Figure((min(3.4 * len(profiles) + 1.2, 10.5), 3.2), layout="constrained")
        panels = figure.subplots(1, len(profiles), sharex=True, sharey=True, squeeze=False)[0]
        for panel, profile in zip(panels, profiles, strict=True):
            _draw_budgets(panel)
            for scores, score in points:
                if scores.profile == profile:
                    _draw_score(panel, score, ink[score.policy].light, marker[scores.engine])
            panel.set_xscale("log")
            panel.xaxis.set_major_formatter("{x:g}")
            panel.set(title=profile, ylim=(-0.03, 1.05), xlabel="p99 of frame time [ms]")
        in_pairs = any(score.pairs is not None for _, score in points)
        panels[0].set_ylabel(f"share of {'pairs' if in_pairs else 'stacks'} correct")
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
    if score.headline is None or score.frame_ms_p99 is None:
        return
    right = score.headline.right
    if right.low is not None and right.high is not None:
        axes.vlines(score.frame_ms_p99, right.low, right.high, color=colour, alpha=0.4)
    axes.plot(score.frame_ms_p99, right.value, marker, color=colour, markersize=7, clip_on=False)


def _speed_legend(figure: Figure, ink: Mapping[str, Ink], marker: Mapping[str, str]) -> None:
    axes = figure.axes[0]
    policies = [axes.plot([], [], "s", color=one.light, label=name)[0] for name, one in ink.items()]
    engines = [axes.plot([], [], one, color=INK, fillstyle="none", label=name)[0] for name, one in marker.items()]
    figure.legend(handles=[*policies, *engines], loc="outside right upper", frameon=False)
