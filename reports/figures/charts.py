"""Charts of a study, by matplotlib: pairs right and wrong, survival by level, and speed against correctness."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from reports.figures.colours import Ink, inks, markers
from reports.statistics.groups import Group, ordered_policies
from reports.statistics.intervals import Estimate
from reports.statistics.pairs import ALL, PairRow
from reports.statistics.scores import FRAME_BUDGETS_MS, EngineScores, PolicyScore
from reports.statistics.survival import Survival

INK, FAINT = "#1f2328", "#c9ced6"
"""Of text and axes, and of grid lines; a page puts its own in their place."""
_STYLE: dict[Any, Any] = {
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
_SHARE_NAMES = {
    "right": "both right",
    "false_stand": "false stand",
    "false_collapse": "false collapse",
    "failed": "failed",
}
_SHARE_MARKS: Mapping[str, dict[str, Any]] = {
    "right": {"marker": "o", "markersize": 7, "linestyle": ""},
    "false_stand": {"marker": "^", "markersize": 6, "linestyle": "", "fillstyle": "none"},
    "false_collapse": {"marker": "v", "markersize": 6, "linestyle": "", "fillstyle": "none"},
    "failed": {"marker": "x", "markersize": 5, "linestyle": ""},
}
_PANEL_INCHES = (2.7, 1.9)
_COLUMNS = 3


def pairs_figure(rows: Sequence[PairRow]) -> Figure:
    """Shares of pairs, a panel an engine and profile, a line a policy: right, and every way of being wrong."""
    whole = [row for row in rows if row.family == ALL]
    engines = list(dict.fromkeys(row.set_up[:2] for row in whole))
    policies = ordered_policies(row.set_up.policy for row in whole)
    several = len({profile for _, profile in engines}) > 1
    lines, columns = -(-len(engines) // _COLUMNS), min(_COLUMNS, len(engines))
    with mpl.rc_context(_STYLE):
        height = 0.24 * len(policies) + 0.55
        figure = Figure((_PANEL_INCHES[0] * columns + 0.4, height * lines + 0.5), layout="constrained")
        panels = figure.subplots(lines, columns, sharex=True, sharey=True, squeeze=False).ravel()
        for panel, (engine, profile) in zip(panels, engines, strict=False):
            _pairs_panel(panel, policies, [row for row in whole if row.set_up[:2] == (engine, profile)])
            panel.set_title(f"{engine} {profile}" if several else engine)
        for spare in panels[len(engines) :]:
            spare.set_visible(False)
        handles = [Line2D([], [], color=INK, label=told, **_SHARE_MARKS[name]) for name, told in _SHARE_NAMES.items()]
        figure.legend(handles=handles, loc="outside upper center", ncols=4, frameon=False)
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
            if name == "right" or one.value:  # what never happened would only cover the axis
                axes.plot(one.value, place, color=colour, clip_on=False, **_SHARE_MARKS[name])
    axes.set(xlim=(-0.02, 1.02), ylim=(len(policies) - 0.5, -0.5), yticks=range(len(policies)), yticklabels=policies)
    axes.tick_params(axis="y", length=0)
    axes.label_outer()


def has_survival(groups: Sequence[Group]) -> bool:
    """Whether there is a curve to draw: one stack of each kind makes none."""
    return any(len(group.lifetimes) > 1 for group in groups)


def survival_figure(groups: Sequence[Group]) -> Figure:
    """Survival by level of one scene and profile: a panel an engine, a curve a policy."""
    engines = list(dict.fromkeys(group.key.engine for group in groups if group.survival is not None))
    rows, columns = -(-len(engines) // _COLUMNS), min(_COLUMNS, len(engines))
    with mpl.rc_context(_STYLE):
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
            width = 1.4 + 1.1 * (len(groups) - 1 - number)  # those that coincide all stay to be seen
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
    """The curve from level 0 on, where every stack stands."""
    return np.concatenate([[0.0], level]), np.concatenate([[1.0], share])


def speed_figure(engines: Sequence[EngineScores]) -> Figure | None:
    """Share right against frame time, a panel a profile; None if nothing was judged and timed."""
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
    with mpl.rc_context(_STYLE):
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
        panels[0].set_ylabel(f"share of {'pairs' if in_pairs else 'stacks'} right")
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


def save(figure: Figure, stem: Path) -> str:
    """Write a figure as SVG and as PDF, without dates: the same records give the same files. Returns the SVG."""
    with mpl.rc_context(_STYLE):
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
