"""A fixed calculation, timed before and after every trial to measure the speed of the machine and its variation."""

from __future__ import annotations

import math
import statistics
from collections.abc import Callable
from time import perf_counter, thread_time
from typing import NamedTuple

_LOOPS = 20
"""Number of timed runs of the fixed calculation in one measurement."""
_STEPS = 2000
"""Number of square roots in one run of the fixed calculation."""


def calibrate(clock: Callable[[], float] = perf_counter) -> list[float]:
    """Time several runs of the fixed calculation, which take a few milliseconds in all.

    Args:
        clock: function that returns the time [s].

    Returns:
        Time of each run [ms].
    """
    times_ms = []
    for _ in range(_LOOPS):
        begin = clock()
        total = 0.0
        for step in range(_STEPS):
            total += math.sqrt(step)
        times_ms.append((clock() - begin) * 1e3)
    return times_ms


class Speed(NamedTuple):
    """Present speed and load of the machine."""

    calibration_ms: float
    """Time of the undisturbed fixed calculation [ms], estimated by the 10th percentile of all runs."""
    busy: float
    """Ratio of wall time to processor time: 1 on an idle machine, 2 if this process gets half a core."""


def speed_now(
    seconds: float = 2.0, clock: Callable[[], float] = perf_counter, processor: Callable[[], float] = thread_time
) -> Speed:
    """Measure the speed and the load of the machine.

    Args:
        seconds: duration of the measurement [s]; 2 s are long enough to see how the system shares its cores.
        clock: function that returns the wall time [s].
        processor: function that returns the processor time of this thread [s].
    """
    begin, begin_cpu = clock(), processor()
    times_ms: list[float] = []
    while clock() - begin < seconds:
        times_ms += calibrate(clock)
    undisturbed = statistics.quantiles(times_ms, n=10)[0]
    return Speed(undisturbed, max(1.0, (clock() - begin) / (processor() - begin_cpu)))


def typical(before: list[float], after: list[float]) -> float:
    """Return the median time [ms] of the runs of the fixed calculation before and after a trial."""
    return statistics.median([*before, *after])
