"""Medians, spreads and rates, against cases that are worked by hand or whose interval has a closed form."""

import math

import pytest
from scipy import stats

from reports.statistics.intervals import LEAST_RATIOS, deviation, median, paired_ratio, success_rate


def test_a_median_lies_between_the_ends_of_its_interval_which_are_values() -> None:
    values = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0]
    estimate = median(values)
    assert estimate is not None
    assert (estimate.n, estimate.value) == (7, 8.0)
    assert estimate.low in values
    assert estimate.high in values
    assert estimate.low < 8 < estimate.high


def test_one_seed_says_so_and_gives_no_interval() -> None:
    estimate = median([3.0])
    assert estimate is not None
    assert (estimate.n, estimate.value, estimate.low, estimate.high) == (1, 3.0, None, None)
    assert deviation([3.0]) is None
    rates = success_rate([[True], [False]])
    assert rates is not None
    assert (rates.n, rates.value, rates.low) == (2, 0.5, None)


def test_nothing_has_no_median_and_no_share() -> None:
    assert median([]) is None
    assert success_rate([[], []]) is None


@pytest.mark.parametrize("n", [5, 6, 9, 20, 61])
def test_the_interval_of_a_ratio_encloses_the_median_as_often_as_it_says(n: int) -> None:
    """Counted over all ways in which n pairs fall on either side of the median; five allow no more than 93.75 %."""
    ratios = [float(rank) for rank in range(1, n + 1)]
    estimate = paired_ratio(ratios[::-1])
    assert estimate is not None
    assert (estimate.n, estimate.value) == (n, (n + 1) / 2)
    low, high = int(estimate.low), int(estimate.high)
    assert low == n + 1 - high, "as far from either end"
    below = [math.comb(n, count) / 2**n for count in range(n + 1)]  # chance of so many pairs below the median
    assert sum(below[low:high]) >= (0.95 if n > 5 else 0.9375)
    assert sum(below[low + 1 : high - 1]) < 0.95, "a narrower one would enclose it less often"


def test_fewer_than_five_pairs_give_no_ratio() -> None:
    assert paired_ratio([0.1] * (LEAST_RATIOS - 1)) is None


def test_the_deviation_is_that_of_the_median() -> None:
    assert deviation([1.0, 1.0, 2.0, 2.0, 4.0, 6.0, 9.0]) == 1  # deviations 1 1 0 0 2 4 7


def test_within_one_scene_the_interval_is_the_binomials() -> None:
    estimate = success_rate([[True] * 14 + [False] * 6])
    assert estimate is not None
    low, high = stats.binom(20, 0.7).ppf([0.025, 0.975]) / 20
    assert estimate.low == pytest.approx(low, abs=0.05)  # one of the 20 that can be drawn
    assert estimate.high == pytest.approx(high, abs=0.05)


def test_scenes_that_differ_widen_the_interval_beyond_that_of_as_many_independent_trials() -> None:
    alike = success_rate([[True] * 10 + [False] * 10] * 4)
    apart = success_rate([[True] * 20, [True] * 20, [False] * 20, [False] * 20])
    assert alike is not None
    assert apart is not None
    assert alike.value == apart.value == 0.5
    assert (apart.low, apart.high) == (0.0, 1.0)  # of four scenes drawn, all are of one kind once in eight
    assert alike.low > 0.3
    assert alike.high < 0.7


def test_an_interval_is_the_same_each_time() -> None:
    values = [0.3, 0.1, 0.7, 0.2]
    assert median(values) == median(values)
