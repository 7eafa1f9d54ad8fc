"""The timing gate: did a part of a frame become slower against another part of the very same frames?

A machine that runs twice as fast a minute later, as shared ones do, makes times of two runs useless, and those of two
machines always are. But the parts of a frame run within a millisecond: their ratio, its median over the frames of a
trial, varies by some percent where the times themselves vary by a factor. The yardstick is the part that has not
changed: the core, if both sides run the same sources, as when builds of an engine are compared; else the engine's step,
if it is of one version and every brick went the same way, so that its work was the same.

The median tells of a typical frame; what happens in few frames, such as freezing, it does not see.
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
"""Parts of a frame: the engine's step, reading contacts, the core. Freezing and waking take too few frames to tell."""
PARTS: tuple[Part, ...] = get_args(Part)
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


def shares(rows: Sequence[FrameRow], timed_frames: int) -> dict[Part, float]:
    """Time of each part over that of the engine's step in the same frame: its median over a trial's timed frames.

    Empty for trials without an extension, and for those of too few frames.
    """
    timed = rows[UNTIMED_FRAMES : UNTIMED_FRAMES + timed_frames]
    columns = [(row.engine_ms, row.readback_ms, row.core_ms) for row in timed]
    times = np.array(columns, np.float64)  # what is null becomes NaN
    if len(times) < _LEAST_FRAMES or not (times > 0).all():
        return {}
    medians = np.median(times / times[:, :1], axis=0)
    return dict(zip(PARTS, medians.tolist(), strict=True))


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
    reach = float(stdtrit(len(logs) - 1, (1 + CONFIDENCE) / 2)) * error
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
