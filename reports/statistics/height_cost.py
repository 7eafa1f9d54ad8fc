"""What height costs: levels reached against milliseconds a frame, where an engine was set up in several ways.

A frame's time is the median over the frames in which the highest level that stood was the top one: what a stack costs
when it is at its tallest. A stack that fell early is therefore shown with the time of what stood, not of its rubble.
"""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from reports.records.folder import ResultsFolder
from reports.records.frames import UNTIMED_FRAMES, read_frames
from reports.records.trial import CENSORED, TrialRecord
from reports.statistics.groups import GroupKey, grouped

LEAST_SET_UPS = 3
"""So many profiles of one engine on one scene make a comparison of costs; two are told by the other tables."""


@dataclass(frozen=True, slots=True)
class CostPoint:
    """One engine, set up in one way, on one scene under one policy; medians over its trials."""

    scene: str
    engine: str
    profile: str
    policy: str
    levels: float
    """That stood."""
    planned: int
    is_bound: bool
    """True if a trial was stopped by its time limit: at least so many levels stand."""
    frame_ms: float


def cost_points(folder: Path, records: Sequence[TrialRecord]) -> list[CostPoint]:
    """The points of a results folder; none of engines that were set up in one way or two."""
    set_ups = {key: {one.profile for one in trials} for key, trials in grouped(records, "scene", "engine").items()}
    points = []
    for values, trials in grouped(records, *GroupKey._fields).items():
        key = GroupKey(*values)
        if len(set_ups[key.scene, key.engine]) >= LEAST_SET_UPS:
            timed = [(trial, time) for trial in trials if (time := _frame_ms(folder, trial)) is not None]
            if timed:
                points.append(_point(key, timed))
    return points


def _point(key: GroupKey, timed: Sequence[tuple[TrialRecord, float]]) -> CostPoint:
    """Return the point of a group, of its trials with their times of a frame [ms]."""
    return CostPoint(
        *key,
        levels=statistics.median(trial.height_levels for trial, _ in timed),
        planned=timed[0][0].levels_planned,
        is_bound=any(trial.status in CENSORED for trial, _ in timed),
        frame_ms=statistics.median(time for _, time in timed),
    )


def _frame_ms(folder: Path, record: TrialRecord) -> float | None:
    """Median time of a frame [ms] while the highest level stood as the top one; None if there is no such frame."""
    frames = ResultsFolder(folder).frames_file(record.trial)
    if not record.height_levels or record.timed_frames is None or not frames.exists():
        return None
    timed = read_frames(frames)[UNTIMED_FRAMES:][: record.timed_frames]
    times = [row.frame_ms for row in timed if row.level == record.height_levels]
    return statistics.median(times) if times else None


def frontier(points: Sequence[CostPoint]) -> list[CostPoint]:
    """The points that no other one beats: each reaches higher than all that cost as much or less, by rising cost."""
    best: list[CostPoint] = []
    for point in sorted(points, key=lambda point: (point.frame_ms, -point.levels)):
        if not best or point.levels > best[-1].levels:
            best.append(point)
    return best
