"""Survival statistics: levels at which stacks fall, of which some are only lower bounds.

A stack that was completed, or stopped by its time limit, might have carried more: its level is censored. Such levels
have no mean; they have a survival curve, its median, and tests that allow for censoring.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import scipy  # scipy.stats takes seconds to load, so it is loaded on first use

from reports.records.trial import TrialRecord

FloatArray = npt.NDArray[np.float64]

CONFIDENCE = 0.95
"""Confidence of every interval, by convention."""
PERMUTATIONS = 9999
"""Most sign changes of a paired test: all of them up to 13 pairs, beyond that a sample, which gives a p-value of 0.05
to within 0.004."""
_ROUNDING = 1e-9
"""Rounding error of a share, which is a product of fractions."""
_SEED = 20150608
"""Seed of the sample, so that a report can be reproduced."""


@dataclass(frozen=True, slots=True)
class Lifetime:
    """The level that one stack reached."""

    level: int
    """Levels placed when it fell; else the highest level that was seen intact."""
    fell: bool
    """False: censored, the stack would have carried more."""

    def outlives(self, other: Lifetime) -> bool:
        """Return whether it certainly reached a higher level than ``other``."""
        return other.fell and (self.level > other.level or (not self.fell and self.level == other.level))


def lifetime(trial: TrialRecord) -> Lifetime | None:
    """Return a trial's lifetime; None if the engine's process failed, which says nothing about the stack.

    Poses that are not finite end the stack's lifetime.
    """
    if trial.collapse_level is not None:
        return Lifetime(trial.collapse_level, True)
    if trial.status == "diverged":
        return Lifetime(trial.levels_placed, True)
    if trial.status in ("completed", "timeout"):
        return Lifetime(trial.height_levels, False)
    return None


@dataclass(frozen=True, slots=True)
class Survival:
    """A survival curve: a step at each level. All arrays have shape (n,)."""

    level: FloatArray
    """Levels at which a stack fell or was censored, in ascending order."""
    standing: FloatArray
    """Share that outlives each level."""
    low: FloatArray | None
    high: FloatArray | None
    """Pointwise interval of the share, without width where all stand or none does; None for a single stack."""

    @property
    def median(self) -> float:
        """The first level that at most half outlive; inf if more than half outlive all built levels."""
        return _first_half(self.level, self.standing)

    @property
    def median_interval(self) -> tuple[float, float] | None:
        """The levels that the data do not exclude as the median (Brookmeyer and Crowley, Biometrics 38, 1982).

        Ends may be inf: no such level was built. None for a single stack.
        """
        if self.low is None or self.high is None:
            return None
        return _first_half(self.level, self.low), _first_half(self.level, self.high)


def _first_half(level: FloatArray, share: FloatArray) -> float:
    reached = np.flatnonzero(share <= 0.5 + _ROUNDING)
    return float(level[reached[0]]) if len(reached) else math.inf


def kaplan_meier(lifetimes: Sequence[Lifetime]) -> Survival:
    """Return the Kaplan-Meier estimate, with log-log intervals by Greenwood's variance (Kalbfleisch and Prentice 1980).

    Raises:
        ValueError: if there are no lifetimes.
    """
    if not lifetimes:
        raise ValueError("no lifetimes: a survival curve needs at least one")
    curve = scipy.stats.ecdf(_censored(lifetimes)).sf
    level, standing = curve.quantiles, curve.probabilities
    if len(lifetimes) == 1:
        return Survival(level, standing, None, None)
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "The confidence interval is undefined", RuntimeWarning)
        interval = curve.confidence_interval(CONFIDENCE, method="log-log")
    certain = (standing == 0) | (standing == 1)  # the logarithms of the formula do not exist there
    low = np.where(certain, standing, interval.low.probabilities)
    high = np.where(certain, standing, interval.high.probabilities)
    return Survival(level, standing, low, high)


@dataclass(frozen=True, slots=True)
class PairedTest:
    """Two methods on the same stacks, compared pair by pair."""

    pairs: int
    first_farther: int
    """Pairs in which the first method certainly reached a higher level."""
    second_farther: int
    p_value: float | None
    """Two-sided p-value of no difference; None with fewer than two pairs."""

    @property
    def undecided(self) -> int:
        """Pairs with equal levels, or with a lower bound that does not decide."""
        return self.pairs - self.first_farther - self.second_farther


def compare_pairs(pairs: Sequence[tuple[Lifetime, Lifetime]]) -> PairedTest:
    """Return the paired Prentice-Wilcoxon test (O'Brien and Fleming, Biometrics 43, 1987), by permutation within pairs.

    All lifetimes are pooled and scored by the generalised Wilcoxon scores of Peto and Peto (J. R. Statist. Soc. A 135,
    1972), which take ties: S(t) + S(t-) - 1 where a stack fell at t, S(t) - 1 where it was censored, with S the pooled
    Kaplan-Meier estimate. The statistic is the sum of the differences of scores within pairs; if the two methods are
    alike, each difference could as well have had the other sign.

    Args:
        pairs: stacks that share their seed.
    """
    first_farther = sum(one.outlives(other) for one, other in pairs)
    second_farther = sum(other.outlives(one) for one, other in pairs)
    if len(pairs) < 2:
        return PairedTest(len(pairs), first_farther, second_farther, None)
    score = wilcoxon_scores([one for pair in pairs for one in pair]).reshape(-1, 2)
    difference = score[:, 0] - score[:, 1]
    return PairedTest(len(pairs), first_farther, second_farther, _sign_flip_p_value(difference))


def holm(p_values: Sequence[float]) -> list[float]:
    """Return p-values of several tests, corrected by Holm's method (1979) for all of them.

    The smallest of m is multiplied by m, the next by m - 1, and so on; none becomes smaller than the one before.
    """
    order = np.argsort(p_values, kind="stable")
    factors = np.arange(len(p_values), 0, -1)
    corrected = np.empty(len(p_values))
    corrected[order] = np.minimum(np.maximum.accumulate(factors * np.asarray(p_values, float)[order]), 1.0)
    values: list[float] = corrected.tolist()
    return values


def wilcoxon_scores(lifetimes: Sequence[Lifetime]) -> FloatArray:
    """Return Peto and Peto's scores, shape (n,); a stack that reached a higher level has a lower score.

    The sum over all lifetimes is zero; without censoring the scores are the centred midranks, scaled.
    """
    curve = scipy.stats.ecdf(_censored(lifetimes)).sf
    at = np.searchsorted(curve.quantiles, [one.level for one in lifetimes])
    after = curve.probabilities[at]
    before = np.concatenate([[1.0], curve.probabilities])[at]
    fell = np.array([one.fell for one in lifetimes])
    scores: FloatArray = np.where(fell, after + before - 1, after - 1)
    return scores


def _sign_flip_p_value(difference: FloatArray) -> float:
    """Return the two-sided p-value of the sum of ``difference``, shape (n,), when both signs are equally likely."""
    if not difference.any():
        return 1.0
    test = scipy.stats.permutation_test(
        (difference, np.zeros_like(difference)),
        lambda one, other, axis: (one - other).sum(axis=axis),
        permutation_type="samples",
        vectorized=True,
        n_resamples=PERMUTATIONS,
        rng=np.random.default_rng(_SEED),
    )
    return float(test.pvalue)


def _censored(lifetimes: Sequence[Lifetime]) -> scipy.stats.CensoredData:
    return scipy.stats.CensoredData(
        uncensored=[one.level for one in lifetimes if one.fell],
        right=[one.level for one in lifetimes if not one.fell],
    )
