"""The outcome gate: what is worse, what is better, and what is only different."""

import pytest

from bench.compare.outcomes import LEAST_REPEATS, judge_draws, judge_outcome
from bench.studies.tolerance import Tolerance

EXACT = Tolerance()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"status": "collapsed", "height_levels": 2, "collapse_level": 3, "verdict": "false_collapse"}, "was right"),
        ({"height_levels": 2}, "2 of 3 levels, 3 before"),
        ({"status": "crashed", "message": "segmentation fault"}, "crashed, was completed (segmentation fault)"),
        ({"status": "diverged"}, "diverged, was completed"),
        ({"sink_m": 3e-4}, "sinks 0.3 mm, 0.1 mm before"),
        ({"creep_m_s": 8e-6}, "creeps 0.008 mm/s, 0.004 mm/s before"),
    ],
    ids=lambda value: "" if isinstance(value, dict) else value,
)
def test_what_is_worse_one_way_is_better_the_other(make, change, message) -> None:
    base, head = make.record(), make.record(**change)
    judgement, why = judge_outcome(base, head, EXACT)
    assert judgement == "worse"
    assert message in why
    assert judge_outcome(head, base, EXACT)[0] == "better"


def test_the_same_is_the_same(make) -> None:
    for one in (make.record(), make.falling(), make.record(status="crashed"), make.record(status="unsupported")):
        assert judge_outcome(one, one, EXACT) == ("same", "")


def test_differences_within_tolerance_are_the_same(make) -> None:
    """A tenth of a brick's penetration deeper, and a quarter faster creep: other last digits do as much."""
    head = make.record(sink_m=1.2e-4, creep_m_s=5e-6)
    assert judge_outcome(make.record(), head, EXACT)[0] == "same"
    assert judge_outcome(make.record(), make.record(height_levels=2), Tolerance(levels=1))[0] == "same"


def test_what_creeps_is_worse_than_what_stands_and_better_than_what_falls(make) -> None:
    stands, creeps = make.record(), make.record(creep_m_s=9e-6, verdict="creeps")
    falls = make.record(status="collapsed", height_levels=2, collapse_level=3, verdict="false_collapse", creep_m_s=None)
    assert judge_outcome(stands, creeps, EXACT)[0] == "worse"
    assert "creeps, was right" in judge_outcome(stands, creeps, EXACT)[1]
    assert judge_outcome(creeps, falls, EXACT)[0] == "worse"
    assert judge_outcome(falls, creeps, EXACT)[0] == "better"
    assert judge_outcome(creeps, creeps, EXACT) == ("same", "")


def test_a_creep_that_may_be_trembling_is_no_alarm(make) -> None:
    trembles = make.record(creep_m_s=20e-6, creep_error_m_s=25e-6)
    assert judge_outcome(make.record(), trembles, EXACT)[0] == "same"
    assert judge_outcome(make.record(), make.record(creep_m_s=20e-6, creep_error_m_s=5e-6), EXACT)[0] == "worse"


def test_a_base_from_before_creep_counted_raises_no_alarm_by_it(make) -> None:
    base, head = make.record(creep_m_s=None, mean_motion_m_s=4e-6), make.record(creep_m_s=9e-6, verdict="creeps")
    judgement, message = judge_outcome(base, head, EXACT)
    assert (judgement, "the creep of one side is unknown" in message) == ("open", True)
    assert judge_outcome(base, make.record(), EXACT)[0] == "same"


def test_a_lost_verdict_is_worse_whatever_levels_are_tolerated(make) -> None:
    head = make.record(status="collapsed", height_levels=2, collapse_level=3, verdict="false_collapse")
    assert judge_outcome(make.record(), head, Tolerance(levels=10))[0] == "worse"


def test_what_must_fall_is_judged_by_how_near_it_falls_to_its_level(make) -> None:
    at = {
        level: make.falling(collapse_level=level, verdict="right" if level == 9 else "false_collapse")
        for level in (6, 7, 9)
    }
    stands = make.falling(status="completed", height_levels=13, collapse_level=None, verdict="false_stand")
    assert judge_outcome(at[9], at[7], EXACT)[0] == "worse"
    assert judge_outcome(at[7], at[6], EXACT)[0] == "worse"
    assert judge_outcome(at[6], at[9], EXACT)[0] == "better"
    assert judge_outcome(at[9], stands, EXACT)[0] == "worse"
    assert judge_outcome(at[7], stands, EXACT) == ("worse", "stands, falls at 7 before")


def test_wrong_in_another_way_is_neither_better_nor_worse(make) -> None:
    sank = make.falling(verdict="failed")
    early = make.falling(verdict="false_collapse")
    assert judge_outcome(sank, early, EXACT)[0] == "open"


def test_the_sink_of_another_level_is_not_compared(make) -> None:
    head = make.record(height_levels=4, levels_planned=4, sink_m=5e-3)
    assert judge_outcome(make.record(levels_planned=4), head, EXACT)[0] == "better"


@pytest.mark.parametrize("repeats", [1, LEAST_REPEATS - 1, LEAST_REPEATS])
def test_draws_are_worse_only_if_enough_of_them_all_are(make, repeats) -> None:
    base = [make.record(repeat=repeat) for repeat in range(repeats)]
    head = [make.record(repeat=repeat, height_levels=2) for repeat in range(repeats)]
    assert judge_draws(base, head, EXACT)[0] == ("worse" if repeats == LEAST_REPEATS else "open")
    assert judge_draws(base, [*head[:-1], base[0]], EXACT)[0] == "same"
