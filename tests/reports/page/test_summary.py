"""The sentence of the page about an engine says what was built, under the policies that it names."""

from reports.page.summary import verdicts
from reports.statistics.groups import groups_of
from reports.statistics.scores import engine_scores
from tests.reports.studies import FALLS, fallen, record


def headline(*trials) -> str:
    (verdict,) = verdicts(engine_scores(groups_of(trials)))
    return verdict.headline


def must_fall(policy: str, *, right: bool):
    if right:
        return fallen(9, scene="leaning_tower", policy=policy, expectation=FALLS, verdict="right")
    return record(scene="leaning_tower", policy=policy, expectation=FALLS, verdict="false_stand")


def test_a_policy_that_is_right_on_both_sides_is_named_though_another_played_one_side_only():
    trials = (record(policy="paper"), must_fall("paper", right=True), must_fall("at_rest", right=False))
    assert headline(*trials) == "Every stack right with paper."


def test_a_policy_that_only_built_what_must_stand_is_not_called_right_of_all():
    assert headline(record()) == "Right alone, though only stacks that must stand were built."
    assert headline(must_fall("none", right=True)) == "Right alone, though only stacks that must fall were built."
