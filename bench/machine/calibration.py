"""A fixed calculation, timed beside every trial, which measures the speed and the steadiness of the machine."""

from __future__ import annotations

import math
import statistics
from collections.abc import Callable
from time import perf_counter

_LOOPS = 20
_STEPS = 2000


def calibrate(clock: Callable[[], float] = perf_counter) -> list[float]:
    """Return the times [ms] of several runs of the fixed calculation: about 5 ms in all."""
    times_ms = []
    for _ in range(_LOOPS):
        begin = clock()
        total = 0.0
        for step in range(_STEPS):
            total += math.sqrt(step)
        times_ms.append((clock() - begin) * 1e3)
    return times_ms


def typical(before: list[float], after: list[float]) -> float:
    """Return the median time [ms] of the measurements before and after a trial."""
    return statistics.median([*before, *after])
