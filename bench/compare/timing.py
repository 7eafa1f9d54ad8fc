"""The timing gate, which judges whether a part of a frame became slower relative to a reference part of that frame.

Times of two runs are not comparable, because a shared machine may run twice as fast a minute later. The parts of one
frame, however, run within milliseconds of each other. Therefore the median ratio of two parts over a trial's frames
varies by a few percent, while the times vary by a factor of two.

The reference part is the part that is the same in base and head:

- the core, if both sides run the same sources, for example to compare two builds of an engine;
- else the engine's step, if the engine's version and all poses are the same, because its work was then the same.

The median describes a typical frame. It does not show rare events such as freezing.
"""

from __future__ import annotations

import math
import statistics
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

import numpy as np
from scipy.special import stdtrit

from bench.compare.findings import Judgement
from reports.records.frames import UNTIMED_FRAMES, FrameRow

Part: TypeAlias = Literal["engine", "readback", "core"]
"""Part of a frame: the engine's step, the reading of contacts and masses, or the core. Freezing and unfreezing are no
parts, because they are too rare to judge."""
PARTS: tuple[Part, ...] = get_args(Part)
"""All parts of a frame."""
LEAST_PAIRS = 3
"""Fewest pairs of trials for an interval."""
CONFIDENCE = 0.99
"""Confidence of the interval. At this confidence, fifty measured comparisons of the same code raised no alarm
(``docs/ci.md``)."""
_LEAST_FRAMES = 60
"""Fewest timed frames of a trial whose median describes a typical frame: one second at 60 Hz."""


@dataclass(frozen=True, slots=True)
class Interval:
    """A ratio of head to base, with its interval at the confidence ``CONFIDENCE``."""

    ratio: float
    low: float
    high: float

    def __str__(self) -> str:
        return f"{self.ratio:.2f} ({self.low:.2f}-{self.high:.2f})"


def shares(rows: Sequence[FrameRow], timed_frames: int) -> dict[Part, float]:
    """Return the ratio of each part's time to the time of the engine's step: the median over the timed frames.

    Args:
        rows: all frames of the trial.
        timed_frames: number of timed frames, which follow the first ``UNTIMED_FRAMES``.

    Returns:
        The ratios by part; empty with fewer than ``_LEAST_FRAMES`` timed frames, or if a time is zero or unknown, as in
        a trial without an extension.
    """
    timed = rows[UNTIMED_FRAMES : UNTIMED_FRAMES + timed_frames]
    columns = [(row.engine_ms, row.readback_ms, row.core_ms) for row in timed]
    times = np.array(columns, np.float64)  # null becomes NaN
    if len(times) < _LEAST_FRAMES or not (times > 0).all():
        return {}
    medians = np.median(times / times[:, :1], axis=0)
    return dict(zip(PARTS, medians.tolist(), strict=True))


def interval(pairs: Sequence[tuple[float, float]]) -> Interval:
    """Return the geometric mean of the ratio head / base, with Student's interval of the mean of its logarithm.

    A bootstrap would be unsuitable, because its percentiles lie too close together for the four to sixteen pairs of a
    short study.

    Args:
        pairs: figures (base, head), all positive.

    Raises:
        ValueError: if there are fewer than ``LEAST_PAIRS`` pairs.
    """
    if len(pairs) < LEAST_PAIRS:
        raise ValueError(
            f"an interval needs at least {LEAST_PAIRS} pairs of trials, got {len(pairs)}: run the study with more "
            "repeats"
        )
    logs = [math.log(head / base) for base, head in pairs]
    middle = statistics.fmean(logs)
    error = statistics.stdev(logs) / math.sqrt(len(logs))
    reach = float(stdtrit(len(logs) - 1, (1 + CONFIDENCE) / 2)) * error
    return Interval(math.exp(middle), math.exp(middle - reach), math.exp(middle + reach))


def judge_times(pairs: Sequence[tuple[float, float]], least: float) -> tuple[Judgement, str]:
    """Judge the interval of the ratio head / base; return the judgement and a message.

    The cases, in order:

    - ``open``: there are fewer than ``LEAST_PAIRS`` pairs;
    - ``worse``: the whole interval lies above 1 + ``least``;
    - ``better``: the whole interval lies below 1 / (1 + ``least``);
    - ``same``: the interval ends at or below 1 + ``least``;
    - ``open``: otherwise.

    Args:
        pairs: figures (base, head), all positive.
        least: smallest relative slowdown that counts.
    """
    if len(pairs) < LEAST_PAIRS:
        return "open", f"undecided: {len(pairs)} pairs of trials, {LEAST_PAIRS} are needed"
    ratio = interval(pairs)
    message = f"{ratio} times the base"
    if ratio.low > 1 + least:
        return "worse", message
    if ratio.high < 1 / (1 + least):
        return "better", message
    if ratio.high <= 1 + least:
        return "same", message
    return "open", f"undecided: {message}"
