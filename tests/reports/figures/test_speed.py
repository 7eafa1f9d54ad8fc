"""The figure of speed has panels that can be read, however many set-ups a study has."""

from __future__ import annotations

import warnings
from pathlib import Path

import pytest

from reports.figures.speed import speed_figure
from reports.figures.style import save
from reports.statistics.groups import groups_of
from reports.statistics.scores import engine_scores
from tests.reports.studies import record


def titles(figure) -> list[str]:
    return [axes.get_title("left") or axes.get_title() for axes in figure.axes if axes.get_visible()]


@pytest.mark.parametrize(
    ("engines", "profiles", "panels"),
    [
        (1, 1, ["p0"]),
        (3, 3, ["p0", "p1", "p2"]),
        (4, 4, ["p0", "p1", "p2", "p3"]),
        (3, 12, ["e0", "e1", "e2"]),  # 36 set-ups: more profiles than engines
        (1, 36, ["e0"]),
    ],
)
def test_many_profiles_share_the_panel_of_their_engine(engines: int, profiles: int, panels, tmp_path: Path) -> None:
    trials = [
        record(engine=f"e{engine}", profile=f"p{profile}", frame_ms_p50=1.0 + profile, frame_ms_p99=2.0 + profile)
        for engine in range(engines)
        for profile in range(profiles)
    ]
    figure = speed_figure(engine_scores(groups_of(trials)))
    assert figure is not None
    assert titles(figure) == panels
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # matplotlib warns if labels leave no room for the axes
        save(figure, tmp_path / "speed")
    marks = [
        line for axes in figure.axes for line in axes.lines if line.get_marker() != "None" and len(line.get_xdata())
    ]
    assert len(marks) == engines * profiles
    assert all(axes.get_position().width > 0.15 for axes in figure.axes if axes.get_visible())


def test_a_mark_lies_at_the_time_of_the_slowest_scene() -> None:
    """The budgets of 60 and 90 Hz judge the slowest scene, as the sentences do: 20 ms, not the median of 3 ms."""
    times = {"table": 2.0, "four_stack": 3.0, "card_house": 20.0}
    figure = speed_figure(
        engine_scores(groups_of([record(scene=scene, frame_ms_p99=time) for scene, time in times.items()]))
    )
    assert figure is not None
    marks = [line for line in figure.axes[0].lines if line.get_marker() == "o" and len(line.get_xdata())]
    assert [list(line.get_xdata()) for line in marks] == [[20.0]]
