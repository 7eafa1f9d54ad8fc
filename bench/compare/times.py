"""The timing gate: did the core, or reading contacts, become slower against the engine's step of the very same frames?

A machine that runs twice as fast a minute later, as shared ones do, makes times of two runs useless, and those of two
machines always are. But both parts of a frame run within a millisecond: their ratio, its median over the frames of a
trial, varies by some percent where the times themselves vary by a factor. The engine is a fair yardstick only while it
does the same work, so only trials of one engine version that went the same way on one model of processor are compared.

The median tells of a typical frame; what happens in few frames, such as freezing, it does not see.
"""

from __future__ import annotations

import math
import statistics
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import t as student_t

from bench.compare.findings import Judgement
from reports.frames import UNTIMED_FRAMES, FrameRow

PARTS = ("core_ms", "readback_ms")
"""Parts of a frame that are judged, by their column. Freezing and waking take place in too few frames to tell."""
LEAST_PAIRS = 3
"""Fewer pairs of trials than this have no spread to speak of."""
CONFIDENCE = 0.99
"""Of the interval, so that fifty comparisons of the same code raise no alarm by chance alone."""
_LEAST_FRAMES = 60
"""A trial of fewer timed frames than this, a second's, says nothing of a typical one."""


@dataclass(frozen=True, slots=True)
class Interval:
    """A ratio of head to base, and where it lies with ``CONFIDENCE``."""

    ratio: float
    low: float
    high: float

    def __str__(self) -> str:
        return f"{self.ratio:.2f} ({self.low:.2f}-{self.high:.2f})"


def shares(rows: Sequence[FrameRow], timed_frames: int) -> dict[str, float]:
    """Time of each part over that of the engine's step in the same frame: its median over a trial's timed frames.

    Empty for trials without an extension, and for those of too few frames.
    """
    timed = rows[UNTIMED_FRAMES : UNTIMED_FRAMES + timed_frames]
    if len(timed) < _LEAST_FRAMES:
        return {}
    engine = np.array([row.engine_ms for row in timed])
    found = {}
    for part in PARTS:
        times = [getattr(row, part) for row in timed]
        if None not in times and engine.min() > 0:
            found[part] = float(np.median(np.array(times) / engine))
    return {part: share for part, share in found.items() if share > 0}


def interval(pairs: Sequence[tuple[float, float]]) -> Interval:
    """Mean ratio of pairs (base, head) of positive figures, and its Student interval on the logarithms.

    Not a bootstrap: of the four to sixteen pairs that a short study gives, its percentiles lie too close together.

    Raises:
        ValueError: for fewer than ``LEAST_PAIRS``.
    """
    if len(pairs) < LEAST_PAIRS:
        raise ValueError(f"at least {LEAST_PAIRS} pairs are needed, got {len(pairs)}")
    logs = [math.log(head / base) for base, head in pairs]
    middle = statistics.fmean(logs)
    error = statistics.stdev(logs) / math.sqrt(len(logs))
    reach = float(student_t.ppf((1 + CONFIDENCE) / 2, len(logs) - 1)) * error
    return Interval(math.exp(middle), math.exp(middle - reach), math.exp(middle + reach))


def judge_times(pairs: Sequence[tuple[float, float]], least: float) -> tuple[Judgement, str]:
    """Whether the head is slower by more than the share ``least``, faster by as much, neither, or cannot be told."""
    if len(pairs) < LEAST_PAIRS:
        return "open", f"cannot tell from {len(pairs)} pairs of trials: {LEAST_PAIRS} are needed"
    found = interval(pairs)
    told = f"{found} times the base"
    if found.low > 1 + least:
        return "worse", told
    if found.high < 1 / (1 + least):
        return "better", told
    if found.high <= 1 + least:
        return "same", told
    return "open", f"cannot tell: {told}"
