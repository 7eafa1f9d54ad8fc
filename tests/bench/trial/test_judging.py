"""Verdicts: is the outcome what theory demands?"""

from dataclasses import replace

import pytest

from bench.trial.judging import verdict
from scenarios.model import Expectation

STANDS = Expectation("stand", "")
FALLS_AT_9 = Expectation("fall", "", 9)


@pytest.mark.parametrize(
    ("expectation", "status", "collapse_level", "kind", "expected"),
    [
        (STANDS, "completed", None, None, "right"),
        (STANDS, "collapsed", 3, "sink", "false_collapse"),
        (STANDS, "collapsed", 3, "topple", "false_collapse"),
        (STANDS, "timeout", None, None, "undecided"),
        (STANDS, "diverged", None, None, "failed"),
        (STANDS, "unsupported", None, None, "none"),
        (FALLS_AT_9, "collapsed", 9, "topple", "right"),
        (FALLS_AT_9, "collapsed", 9, "slide", "right"),
        (FALLS_AT_9, "collapsed", 9, "drop", "right"),
        (FALLS_AT_9, "collapsed", 8, "drop", "false_collapse"),
        (STANDS, "collapsed", 3, "drop", "false_collapse"),
        (FALLS_AT_9, "collapsed", 9, "sink", "failed"),
        (FALLS_AT_9, "collapsed", 8, "topple", "false_collapse"),
        (FALLS_AT_9, "collapsed", 10, "topple", "false_stand"),
        (FALLS_AT_9, "completed", None, None, "false_stand"),
        (FALLS_AT_9, "timeout", None, None, "undecided"),
        (FALLS_AT_9, "crashed", None, None, "failed"),
        (replace(STANDS, outcome="study"), "collapsed", 2, "topple", "none"),
    ],
)
def test_verdict(expectation, status, collapse_level, kind, expected) -> None:
    assert verdict(expectation, status, collapse_level, kind) == expected


def test_creep_decides_only_whether_what_must_stand_does() -> None:
    assert verdict(STANDS, "completed", None, None, creeps=True) == "creeps"
    assert verdict(STANDS, "collapsed", 3, "slide", creeps=True) == "false_collapse"
    assert verdict(FALLS_AT_9, "completed", None, None, creeps=True) == "false_stand"
    assert verdict(replace(STANDS, outcome="study"), "completed", None, None, creeps=True) == "none"


@pytest.mark.parametrize("status", ["completed", "collapsed", "timeout"])
def test_a_stack_in_neutral_balance_shows_nothing_of_an_engine(status) -> None:
    """A rounding error is enough to move such a stack, and nothing stops it; a fall is a fall without friction too."""
    assert verdict(STANDS, status, 3, "slide", is_neutral=True) == "none"
    assert verdict(FALLS_AT_9, "collapsed", 9, "slide", is_neutral=True) == "right"


def test_what_falls_before_it_is_due_is_no_right_fall() -> None:
    """A stack that is undermined at 11 s must stand until then."""
    undermined = replace(FALLS_AT_9, not_before_s=11.0)
    early, due = (verdict(undermined, "collapsed", 9, "topple", time) for time in (10.9, 11.2))
    assert (early, due) == ("false_collapse", "right")


@pytest.mark.parametrize(
    ("time", "expected"), [(2.9, "false_collapse"), (3.4, "right"), (3.5, "right"), (3.6, "false_stand")]
)
def test_what_falls_later_than_theory_allows_was_held_up(time, expected) -> None:
    """Due from 3 s on, and within half a second."""
    bounded = replace(FALLS_AT_9, not_before_s=3.0, within_s=0.5)
    assert verdict(bounded, "collapsed", 9, "topple", time) == expected
    assert verdict(bounded, "completed", None, None) == "false_stand"
    late = verdict(bounded, "collapsed", 9, "sink", 3.6)
    assert late == "false_stand", "how it went down in the end does not matter"
