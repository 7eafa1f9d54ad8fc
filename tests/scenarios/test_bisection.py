"""Bisection: the bracket holds the threshold, resumes from its answers, and gives no number where there is none."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenarios.bisection import Bisection

SEARCH = Bisection(0.2, 0.6, 0.001)


@given(limit=st.floats(0.2001, 0.5999), rises=st.booleans())
def test_the_bracket_holds_the_threshold_and_is_no_wider_than_the_tolerance(limit: float, rises: bool) -> None:
    tried = []

    def stands(value: float) -> bool:
        tried.append(value)
        return (value >= limit) == rises

    found = SEARCH.search(stands)
    assert found.is_found
    assert found.low <= limit <= found.high
    assert 2 * found.half_width <= SEARCH.tolerance * (1 + 1e-6)
    assert found.low_stands is not rises
    assert len(tried) <= SEARCH.most_tries
    assert tried[:2] == [0.2, 0.6], "both ends come first"


def test_a_search_follows_from_its_answers_alone() -> None:
    answers: dict[float, bool | None] = {}
    while (bracket := SEARCH.bracket(answers)).next:
        again = SEARCH.bracket(dict(reversed(answers.items())))
        assert again == bracket
        answers |= {value: value > 0.35 for value in bracket.next}
    assert SEARCH.bracket(answers).middle == pytest.approx(0.35, abs=0.001)


@pytest.mark.parametrize(
    ("answers", "why"),
    [
        ({0.2: True, 0.6: True}, "stands from 0.2 to 0.6"),
        ({0.2: False, 0.6: False}, "falls from 0.2 to 0.6"),
        ({0.2: None, 0.6: True}, "no answer at 0.2"),
        ({0.2: False, 0.6: True, 0.4: None}, "no answer at 0.4"),
    ],
)
def test_without_a_change_or_an_answer_there_is_no_number(answers: dict[float, bool | None], why: str) -> None:
    bracket = SEARCH.bracket(answers)
    assert (bracket.next, bracket.why, bracket.is_found) == ((), why, False)
