"""Medians, spreads and rates, with the intervals that the number of seeds allows; none for a single seed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy  # scipy.stats takes seconds to load, so it is loaded on first use

from reports.statistics.survival import CONFIDENCE

RESAMPLES = 2000
"""Bootstrap samples: the end of a 95 % interval is then known to about a fiftieth of the interval's width."""
LEAST_RATIOS = 5
"""Fewest pairs of times for which a ratio is given: on a shared machine single ratios differ by a factor of 2, and the
range of five encloses the median with 93.75 %."""
_SEED = 20150608
"""Seed of the bootstrap, so that a report can be reproduced."""


@dataclass(frozen=True, slots=True)
class Estimate:
    """A number with its interval."""

    n: int
    """Number of values behind it."""
    value: float
    low: float | None = None
    high: float | None = None
    """Ends of the 95 % interval; None where n does not allow one."""


def median(values: Sequence[float]) -> Estimate | None:
    """Return the median, with a percentile interval of the bootstrap over values; None without values.

    Args:
        values: one per seed, none of them censored.
    """
    if not values:
        return None
    middle = float(np.median(values))
    if len(values) == 1:
        return Estimate(1, middle)
    interval = scipy.stats.bootstrap(
        (np.asarray(values),),
        np.median,
        method="percentile",
        n_resamples=RESAMPLES,
        confidence_level=CONFIDENCE,
        rng=np.random.default_rng(_SEED),
    ).confidence_interval
    return Estimate(len(values), middle, float(interval.low), float(interval.high))


def paired_ratio(ratios: Sequence[float]) -> Estimate | None:
    """Return the median of paired ratios with its interval from order statistics; None for fewer than ``LEAST_RATIOS``.

    The ratios of n pairs fall on either side of their true median like coins, so the k-th smallest and the k-th largest
    enclose it with a probability that the binomial distribution gives (David and Nagaraja, Order Statistics, 2003,
    section 7.1). The interval is the narrowest one that encloses it with at least 95 %. Five pairs allow none: theirs
    is the smallest to the largest, which encloses it with 93.75 %.

    Args:
        ratios: one per pair of times that were measured in one process.
    """
    if len(ratios) < LEAST_RATIOS:
        return None
    ordered = np.sort(np.asarray(ratios, np.float64))
    outside = int(scipy.stats.binom.ppf((1 - CONFIDENCE) / 2, len(ordered), 0.5))
    end = max(outside, 1) - 1
    return Estimate(len(ordered), float(np.median(ordered)), float(ordered[end]), float(ordered[-1 - end]))


def deviation(values: Sequence[float]) -> float | None:
    """Return the median absolute deviation from the median, unscaled; None for fewer than two values."""
    return float(scipy.stats.median_abs_deviation(values)) if len(values) > 1 else None


def success_rate(by_scene: Sequence[Sequence[bool]]) -> Estimate | None:
    """Return the success rate with its interval; None without trials.

    The interval is of a two-stage bootstrap: scenes are drawn, then seeds within each (Davison and Hinkley, Bootstrap
    Methods and their Application, 1997, section 3.8), because trials of a scene are alike. With one seed per scene
    there is no interval. A rate of 0 or 1 gets an interval of no width, because the bootstrap cannot estimate an event
    that never happened.

    Args:
        by_scene: for each scene, the success of each of its seeds.
    """
    scenes = [held for held in by_scene if held]
    if not scenes:
        return None
    trials = np.array([len(held) for held in scenes])
    rate = np.array([np.mean(held) for held in scenes])
    value = float(trials @ rate / trials.sum())
    if trials.max() == 1:
        return Estimate(int(trials.sum()), value)
    rng = np.random.default_rng(_SEED)
    drawn = rng.integers(len(scenes), size=(RESAMPLES, len(scenes)))
    held = rng.binomial(trials[drawn], rate[drawn]).sum(axis=1)  # successes among n seeds drawn from n
    tail = (1 - CONFIDENCE) / 2
    low, high = np.quantile(held / trials[drawn].sum(axis=1), [tail, 1 - tail]).tolist()
    return Estimate(int(trials.sum()), value, low, high)
