"""The timing gate: whether a part of a frame became slower relative to another part of the same frames.

Times of two runs cannot be compared, because a shared machine may run twice as fast a minute later. But the parts of a
frame run within a millisecond: their ratio, its median over the frames of a trial, varies by some percent where the
times themselves vary by a factor. The yardstick is the unchanged part: the core, if both sides run the same sources, as
when builds of an engine are compared; else the engine's step, if it is of one version and all poses are the same, so
that its work was the same.

The median describes a typical frame; it does not show rare events such as freezing.
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
"""Parts of a frame: the engine's step, reading contacts, the core. Freezing and waking are too rare to judge."""
PARTS: tuple[Part, ...] = get_args(Part)
LEAST_PAIRS = 3
"""Fewest pairs of trials that have a spread."""
CONFIDENCE = 0.99
"""Confidence of the interval, so that fifty comparisons of the same code raise no alarm by chance."""
_LEAST_FRAMES = 60
"""Fewest timed frames, a second's, that describe a typical frame."""


@dataclass(frozen=True, slots=True)
class Interval:
    """A ratio of head to base, with its interval at ``CONFIDENCE``."""

    ratio: float
    low: float
    high: float

    def __str__(self) -> str:
        return f"{self.ratio:.2f} ({self.low:.2f}-{self.high:.2f})"


def shares(rows: Sequence[FrameRow], timed_frames: int) -> dict[Part, float]:
    """Return the time of each part over the engine's step in the same frame: the median over the timed frames.

    Empty for trials without an extension, and for trials of too few frames.
    """
    timed = rows[UNTIMED_FRAMES : UNTIMED_FRAMES + timed_frames]
    columns = [(row.engine_ms, row.readback_ms, row.core_ms) for row in timed]
    times = np.array(columns, np.float64)  # null becomes NaN
    if len(times) < _LEAST_FRAMES or not (times > 0).all():
        return {}
    medians = np.median(times / times[:, :1], axis=0)
    return dict(zip(PARTS, medians.tolist(), strict=True))


def interval(pairs: Sequence[tuple[float, float]]) -> Interval:
    """Return the mean ratio of pairs (base, head) of positive figures, and its Student interval on the logarithms.

    A bootstrap is not used, because its percentiles lie too close together for the four to sixteen pairs of a short
    study.

    Raises:
        ValueError: for fewer than ``LEAST_PAIRS``.
    """
    if len(pairs) < LEAST_PAIRS:
        raise ValueError(f"at least {LEAST_PAIRS} pairs are needed, got {len(pairs)}")
    logs = [math.log(head / base) for base, head in pairs]
    middle = statistics.fmean(logs)
    error = statistics.stdev(logs) / math.sqrt(len(logs))
    reach = float(stdtrit(len(logs) - 1, (1 + CONFIDENCE) / 2)) * error
    return Interval(math.exp(middle), math.exp(middle - reach), math.exp(middle + reach))


def judge_times(pairs: Sequence[tuple[float, float]], least: float) -> tuple[Judgement, str]:
    """Judge whether the head is slower by more than the share ``least``, faster by as much, neither, or undecided."""
    if len(pairs) < LEAST_PAIRS:
        return "open", f"undecided: {len(pairs)} pairs of trials, {LEAST_PAIRS} are needed"
    found = interval(pairs)
    message = f"{found} times the base"
    if found.low > 1 + least:
        return "worse", message
    if found.high < 1 / (1 + least):
        return "better", message
    if found.high <= 1 + least:
        return "same", message
    return "open", f"undecided: {message}"
