"""A fixed calculation, timed beside every trial: what it costs tells how steady the machine is, and how fast."""

from __future__ import annotations

import math
import statistics
from collections.abc import Callable
from time import perf_counter

_LOOPS = 20
_STEPS = 2000


def calibrate(clock: Callable[[], float] = perf_counter) -> list[float]:
    """Times [ms] of the fixed calculation, done some times over: about 5 ms in all."""
    times_ms = []
    for _ in range(_LOOPS):
        begin = clock()
        total = 0.0
        for step in range(_STEPS):
            total += math.sqrt(step)
        times_ms.append((clock() - begin) * 1e3)
    return times_ms


def typical(before: list[float], after: list[float]) -> float:
    """Median time [ms] of what was measured before and after a trial."""
    return statistics.median([*before, *after])
