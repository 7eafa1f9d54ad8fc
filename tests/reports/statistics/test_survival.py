"""Statistics of levels that are partly lower bounds, against cases worked by hand and against `lifelines`."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from reports.statistics.survival import Lifetime, compare_pairs, holm, kaplan_meier, lifetime, wilcoxon_scores
from tests.reports.studies import record

CASES = json.loads((Path(__file__).parents[2] / "fixtures" / "survival.json").read_text(encoding="utf-8"))["cases"]


def fell(level: int) -> Lifetime:
    return Lifetime(level, True)


def stood(level: int) -> Lifetime:
    return Lifetime(level, False)


@pytest.mark.parametrize(
    ("fields", "expected"),
    [
        ({"status": "collapsed", "collapse_level": 9, "height_levels": 8}, fell(9)),
        ({"height_levels": 30}, stood(30)),
        ({"status": "timeout", "height_levels": 21, "levels_placed": 22}, stood(21)),
        ({"status": "diverged", "levels_placed": 3}, fell(3)),
        ({"status": "crashed", "levels_placed": 3}, None),
        ({"status": "unsupported"}, None),
    ],
)
def test_what_an_end_implies_for_the_stack(fields, expected) -> None:
    assert lifetime(record(**fields)) == expected


def test_a_curve_worked_by_hand() -> None:
    # 6 stacks: 1 of 6 falls at 3, 2 of 5 at 5, one is stopped at 7, the last two are completed
    curve = kaplan_meier([fell(3), fell(5), fell(5), stood(7), stood(9), stood(9)])
    assert curve.level.tolist() == [3, 5, 7, 9]
    assert curve.standing.tolist() == pytest.approx([5 / 6, 1 / 2, 1 / 2, 1 / 2])
    assert curve.median == 5


def test_completed_stacks_have_no_median_level_but_a_lower_bound() -> None:
    curve = kaplan_meier([stood(30)] * 20)
    assert curve.median == math.inf
    assert curve.median_interval == (math.inf, math.inf)


def test_a_single_stack_has_no_interval() -> None:
    curve = kaplan_meier([fell(9)])
    assert curve.median == 9
    assert curve.low is None
    assert curve.median_interval is None


@pytest.mark.parametrize("case", CASES)
def test_curves_and_medians_are_those_of_lifelines(case) -> None:
    curve = kaplan_meier([Lifetime(*one) for one in zip(case["levels"], case["fell"], strict=True)])
    assert curve.level.tolist() == case["at"]
    for ours, theirs in ((curve.standing, "standing"), (curve.low, "low"), (curve.high, "high")):
        np.testing.assert_allclose(ours, case[theirs], atol=1e-9)  # both are closed formulas in double precision
    output = [math.inf if end is None else end for end in [case["median"], *case["median_interval"]]]
    assert list(curve.median_interval) == output[1:]
    if not np.isclose(curve.standing, 0.5).any():  # there lifelines' median depends on how a half is rounded
        assert curve.median == output[0]


def test_exactly_half_is_enough_for_the_median() -> None:
    assert kaplan_meier([fell(level) for level in range(1, 21)]).median == 10


def test_scores_worked_by_hand() -> None:
    # S: 3/4 after 1, 3/4 * 1/2 = 3/8 after 4 (three at risk at 2, two at 4)
    scores = wilcoxon_scores([fell(1), stood(2), fell(4), stood(5)])
    assert scores.tolist() == pytest.approx([3 / 4 + 1 - 1, 3 / 4 - 1, 3 / 8 + 3 / 4 - 1, 3 / 8 - 1])
    assert scores.sum() == pytest.approx(0)


def test_without_censoring_the_scores_are_centred_midranks() -> None:
    levels = [7, 3, 3, 9, 1]
    midranks = np.array([4, 2.5, 2.5, 5, 1])
    assert wilcoxon_scores([fell(level) for level in levels]).tolist() == pytest.approx((6 - 2 * midranks) / 5)


def test_all_pairs_one_way_is_as_unlikely_as_so_many_equal_tosses() -> None:
    pairs = [(fell(4 + n), stood(30)) for n in range(6)]
    test = compare_pairs(pairs)
    assert (test.first_farther, test.second_farther, test.undecided) == (0, 6, 0)
    assert test.p_value == pytest.approx(2 / 2**6)
    assert compare_pairs([(b, a) for a, b in pairs]).p_value == test.p_value


def test_pairs_that_are_alike_speak_for_no_difference() -> None:
    assert compare_pairs([(stood(30), stood(30))] * 5).p_value == 1
    assert compare_pairs([(fell(9), fell(9))] * 5).p_value == 1


def test_a_single_pair_has_no_p_value() -> None:
    assert compare_pairs([(fell(4), stood(30))]).p_value is None


@pytest.mark.parametrize(
    ("one", "other", "certain"),
    [
        (fell(5), fell(4), True),
        (fell(4), fell(4), False),
        (stood(4), fell(4), True),  # it stood at the level at which the other fell
        (stood(3), fell(4), False),
        (fell(9), stood(8), False),
        (stood(30), stood(20), False),
    ],
)
def test_a_lower_bound_proves_only_what_it_excludes(one: Lifetime, other: Lifetime, certain: bool) -> None:
    assert one.outlives(other) is certain
    assert not other.outlives(one) or not certain


def test_the_seeds_are_paired() -> None:
    """Stacks that differ much from seed to seed, and always by one level within: only the pairing shows it."""
    levels = [3, 25, 9, 14, 20, 6, 28, 11]
    test = compare_pairs([(fell(level), fell(level + 1)) for level in levels])
    assert test.p_value == pytest.approx(2 / 2**8)


def test_several_p_values_are_corrected_as_by_hand() -> None:
    # sorted: 0.01 * 4, 0.02 * 3, then 0.03 * 2 = 0.06 and 0.5 * 1
    assert holm([0.03, 0.01, 0.5, 0.02]) == pytest.approx([0.06, 0.04, 0.5, 0.06])
    assert holm([0.04, 0.03]) == pytest.approx([0.06, 0.06]), "0.04 * 1 would be below the smaller one's"
    assert holm([0.6, 0.7]) == [1.0, 1.0]
    assert holm([0.02]) == [0.02]
    assert holm([]) == []
