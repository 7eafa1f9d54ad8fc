"""Medians, ratios and success rates with their intervals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy  # scipy loads scipy.stats, which takes seconds, only on first use

from reports.statistics.survival import CONFIDENCE

RESAMPLES = 2000
"""Number of bootstrap samples, chosen so that the end of a 95 % interval has an error of about 1/50 of its width."""
LEAST_RATIOS = 5
"""Fewest pairs of times that give a ratio, because on a shared machine single ratios differ by a factor of 2. The range
of five ratios encloses the true median with a probability of 93.75 %."""
_SEED = 20150608
"""Seed of the bootstrap, so that equal records give equal intervals."""


@dataclass(frozen=True, slots=True)
class Estimate:
    """An estimated value with its interval."""

    n: int
    """Number of values behind the estimate."""
    value: float
    low: float | None = None
    """Lower end of the 95 % interval; None without an interval."""
    high: float | None = None
    """Upper end of the 95 % interval; None without an interval."""


def median(values: Sequence[float]) -> Estimate | None:
    """Return the median with its bootstrap percentile interval; None without values.

    The median of a single value has no interval.

    Args:
        values: uncensored values, one per seed.
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

    Each ratio lies above the true median with probability 1/2. Therefore the binomial distribution gives the
    probability that the k-th smallest and the k-th largest ratio enclose the true median:

        P(enclosed) = 1 - 2 P(B < k),   B ~ Binomial(n, 1/2) for n ratios

    The interval is the narrowest interval with P >= 95 %. For five ratios, no interval has this P. The function then
    returns the full range, with P = 93.75 %.

    Source: David and Nagaraja, Order Statistics, 2003, section 7.1.

    Args:
        ratios: ratios of pairs of times, each pair measured in one process.
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

    The interval comes from a two-stage bootstrap, because trials of one scene depend on each other. The bootstrap draws
    scenes, and then seeds within each scene. With one seed per scene there is no interval. A rate of 0 or 1 has an
    interval of zero width, because a bootstrap draws only outcomes that happened.

    Source: Davison and Hinkley, Bootstrap Methods and their Application, 1997, section 3.8.

    Args:
        by_scene: successes of the seeds of each scene.
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
