"""A fixed calculation, timed beside every trial, which measures the speed and the steadiness of the machine."""

from __future__ import annotations

import math
import statistics
from collections.abc import Callable
from time import perf_counter, thread_time
from typing import NamedTuple

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


class Speed(NamedTuple):
    """How fast the machine is now."""

    calibration_ms: float
    """Time [ms] of the fixed calculation while nobody disturbs: its 10th percentile."""
    busy: float
    """Wall time over processor time: 1 on an idle machine, 2 where this process gets half a core."""


def speed_now(
    seconds: float = 2.0, clock: Callable[[], float] = perf_counter, processor: Callable[[], float] = thread_time
) -> Speed:
    """Measure the machine for ``seconds`` [s]: long enough to see how the system shares its cores.

    Args:
        seconds: how long [s].
        clock: returns wall time [s].
        processor: returns the processor time [s] of this thread.
    """
    begin, begin_cpu = clock(), processor()
    times_ms: list[float] = []
    while clock() - begin < seconds:
        times_ms += calibrate(clock)
    undisturbed = statistics.quantiles(times_ms, n=10)[0]
    return Speed(undisturbed, max(1.0, (clock() - begin) / (processor() - begin_cpu)))


def typical(before: list[float], after: list[float]) -> float:
    """Return the median time [ms] of the measurements before and after a trial."""
    return statistics.median([*before, *after])
