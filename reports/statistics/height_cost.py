"""The cost of height: levels that stood against milliseconds per frame, for engines with several profiles.

The frame time of a trial is the median over the timed frames in which the highest level that stood was the top level.
Therefore the time of a stack that fell early describes the standing stack, not the fallen bricks.
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
"""Fewest profiles of an engine on a scene for a comparison of costs, because other tables are clearer for one or two
profiles."""


@dataclass(frozen=True, slots=True)
class CostPoint:
    """Median levels and median frame time of a group, over its trials with a frame time."""

    scene: str
    engine: str
    profile: str
    policy: str
    levels: float
    """Number of levels that stood."""
    planned: int
    """Number of levels of the whole scene."""
    is_bound: bool
    """True if the time limit stopped a trial, so that ``levels`` is a lower bound."""
    frame_ms: float
    """Frame time [ms]."""


def cost_points(folder: Path, records: Sequence[TrialRecord]) -> list[CostPoint]:
    """Return the cost points of a results folder, for engines with at least ``LEAST_SET_UPS`` profiles on a scene.

    Groups without a frame time have no point.

    Raises:
        pyarrow.ArrowException: if a file of frames is incomplete.
    """
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
    """Return the cost point of a group, from its trials with their frame times [ms]."""
    return CostPoint(
        *key,
        levels=statistics.median(trial.height_levels for trial, _ in timed),
        planned=timed[0][0].levels_planned,
        is_bound=any(trial.status in CENSORED for trial, _ in timed),
        frame_ms=statistics.median(time for _, time in timed),
    )


def _frame_ms(folder: Path, record: TrialRecord) -> float | None:
    """Return the median frame time [ms] while the highest level that stood was the top level.

    The result is None if no level stood, or if there are no timed frames of this level.
    """
    frames = ResultsFolder(folder).frames_file(record.trial)
    if not record.height_levels or record.timed_frames is None or not frames.exists():
        return None
    timed = read_frames(frames)[UNTIMED_FRAMES:][: record.timed_frames]
    times = [row.frame_ms for row in timed if row.level == record.height_levels]
    return statistics.median(times) if times else None


def frontier(points: Sequence[CostPoint]) -> list[CostPoint]:
    """Return the Pareto front, sorted by frame time.

    A point on the front has more levels than every other point whose frame time is equal or less. Of points that are
    equal in both, the front contains only the first.
    """
    best: list[CostPoint] = []
    for point in sorted(points, key=lambda point: (point.frame_ms, -point.levels)):
        if not best or point.levels > best[-1].levels:
            best.append(point)
    return best
