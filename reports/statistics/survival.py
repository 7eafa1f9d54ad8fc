"""Survival statistics of the levels at which stacks fall; some of these levels are only lower bounds.

A level counts as censored in two cases: the stack stood to the end, or the time limit stopped the trial. In both
cases the stack might have carried more levels. Censored levels have no mean. They have a survival curve, the median of
this curve, and tests that account for censoring.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import scipy  # scipy loads scipy.stats, which takes seconds, only on first use

from reports.records.trial import TrialRecord

FloatArray = npt.NDArray[np.float64]

CONFIDENCE = 0.95
"""Confidence of every interval, by convention."""
PERMUTATIONS = 9999
"""Greatest number of sign combinations in a paired test: all combinations for up to 13 pairs, else a random sample. The
sample gives a p-value of 0.05 with an error of 0.004."""
_ROUNDING = 1e-9
"""Bound of the rounding error of a share, which is a product of fractions."""
_SEED = 20150608
"""Seed of the sample, so that equal records give equal p-values."""


@dataclass(frozen=True, slots=True)
class Lifetime:
    """The level that one stack reached."""

    level: int
    """Number of levels placed when the stack fell; the highest level that was seen intact if the stack did not fall."""
    fell: bool
    """True if the stack fell; False if the level is censored."""

    def outlives(self, other: Lifetime) -> bool:
        """Return whether this stack reached a higher level than ``other`` for certain, despite censoring."""
        return other.fell and (self.level > other.level or (not self.fell and self.level == other.level))


def lifetime(trial: TrialRecord) -> Lifetime | None:
    """Return the lifetime of a trial's stack; None if the trial has no result about the stack.

    A trial without a collapse has no result if its status is ``error``, ``crashed``, ``out_of_memory`` or
    ``unsupported``. A trial whose poses became non-finite counts as fallen.
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
    """A survival curve, given at n levels."""

    level: FloatArray
    """Levels at which a stack fell or was censored, ascending, shape (n,)."""
    standing: FloatArray
    """Share of stacks that outlive each level, shape (n,)."""
    low: FloatArray | None
    """Lower end of the pointwise interval of the share, shape (n,); equal to the share where the share is 0 or 1. None
    for a single stack."""
    high: FloatArray | None
    """Upper end of the pointwise interval of the share, shape (n,); equal to the share where the share is 0 or 1. None
    for a single stack."""

    @property
    def median(self) -> float:
        """Lowest level that at most half of the stacks outlive; inf if more than half outlive every level."""
        return _first_half(self.level, self.standing)

    @property
    def median_interval(self) -> tuple[float, float] | None:
        """Interval of the median (Brookmeyer and Crowley, Biometrics 38, 1982); None for a single stack.

        An end above every built level is inf.
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
        ValueError: if ``lifetimes`` is empty.
    """
    if not lifetimes:
        raise ValueError(
            "a survival curve needs at least one lifetime, got an empty list: leave out groups without lifetimes"
        )
    curve = scipy.stats.ecdf(_censored(lifetimes)).sf
    level, standing = curve.quantiles, curve.probabilities
    if len(lifetimes) == 1:
        return Survival(level, standing, None, None)
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "The confidence interval is undefined", RuntimeWarning)
        interval = curve.confidence_interval(CONFIDENCE, method="log-log")
    certain = (standing == 0) | (standing == 1)  # the log-log formula is undefined there
    low = np.where(certain, standing, interval.low.probabilities)
    high = np.where(certain, standing, interval.high.probabilities)
    return Survival(level, standing, low, high)


@dataclass(frozen=True, slots=True)
class PairedTest:
    """Result of a comparison of two methods on pairs of equal stacks."""

    pairs: int
    """Number of pairs."""
    first_farther: int
    """Number of pairs in which the first method certainly reached a higher level."""
    second_farther: int
    """Number of pairs in which the second method certainly reached a higher level."""
    p_value: float | None
    """Two-sided p-value for the hypothesis of no difference; None for fewer than two pairs."""

    @property
    def undecided(self) -> int:
        """Number of pairs with equal levels, or with an order that censoring leaves open."""
        return self.pairs - self.first_farther - self.second_farther


def compare_pairs(pairs: Sequence[tuple[Lifetime, Lifetime]]) -> PairedTest:
    """Return the paired Prentice-Wilcoxon test (O'Brien and Fleming, Biometrics 43, 1987), by permutation within pairs.

    The test pools all lifetimes and scores them by the generalised Wilcoxon scores of Peto and Peto (J. R. Statist.
    Soc. A 135, 1972), which allow ties. S is the pooled Kaplan-Meier estimate, and S(t-) is its value just before t:

        score      S(t) + S(t-) - 1   if the stack fell at level t
                   S(t) - 1           if the level t is censored
        statistic  sum over pairs of score(first) - score(second)

    If the two methods are equivalent, each difference has either sign with equal probability.

    Args:
        pairs: lifetimes of the first and of the second method on stacks with the same seed.
    """
    first_farther = sum(one.outlives(other) for one, other in pairs)
    second_farther = sum(other.outlives(one) for one, other in pairs)
    if len(pairs) < 2:
        return PairedTest(len(pairs), first_farther, second_farther, None)
    score = wilcoxon_scores([one for pair in pairs for one in pair]).reshape(-1, 2)
    difference = score[:, 0] - score[:, 1]
    return PairedTest(len(pairs), first_farther, second_farther, _sign_flip_p_value(difference))


def holm(p_values: Sequence[float]) -> list[float]:
    """Return the p-values of several tests, corrected for multiple testing by Holm's method (1979).

    With p_1 <= ... <= p_m the sorted p-values of m tests:

        corrected p_k = min(1, max over j <= k of (m - j + 1) p_j)
    """
    order = np.argsort(p_values, kind="stable")
    factors = np.arange(len(p_values), 0, -1)
    corrected = np.empty(len(p_values))
    corrected[order] = np.minimum(np.maximum.accumulate(factors * np.asarray(p_values, float)[order]), 1.0)
    values: list[float] = corrected.tolist()
    return values


def wilcoxon_scores(lifetimes: Sequence[Lifetime]) -> FloatArray:
    """Return the scores of Peto and Peto, shape (n,); a stack that reached a higher level has a lower score.

    The sum over all lifetimes is zero. Without censoring, the scores are proportional to the centred midranks.
    """
    curve = scipy.stats.ecdf(_censored(lifetimes)).sf
    at = np.searchsorted(curve.quantiles, [one.level for one in lifetimes])
    after = curve.probabilities[at]
    before = np.concatenate([[1.0], curve.probabilities])[at]
    fell = np.array([one.fell for one in lifetimes])
    scores: FloatArray = np.where(fell, after + before - 1, after - 1)
    return scores


def _sign_flip_p_value(difference: FloatArray) -> float:
    """Return the two-sided p-value of the sum of ``difference``, shape (n,).

    The hypothesis is that each difference has either sign with equal probability.
    """
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
