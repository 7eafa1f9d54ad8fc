"""The sentence of the page about an engine says what was built, under the policies that it names."""

from reports.page.summary import verdicts
from reports.statistics.groups import groups_of
from reports.statistics.scores import engine_scores
from tests.reports.studies import FALLS, fallen, record


def only_verdict(*trials):
    (verdict,) = verdicts(engine_scores(groups_of(trials)))
    return verdict


def headline(*trials) -> str:
    return only_verdict(*trials).headline


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


def test_right_pairs_do_not_hide_wrong_scenes_without_a_partner():
    pair = (
        record(scene="table", pair="table"),
        fallen(1, scene="table-margin-0.2", pair="table", expectation=FALLS, verdict="right"),
    )
    assert headline(*pair) == "Every pair right alone."
    alone = fallen(3, scene="card_house", verdict="false_collapse")
    assert headline(*pair, alone) == "Every pair right alone, but 1 of 3 trials wrong."
    assert headline(*pair, record(scene="wall")) == "Every pair and other scene right alone."
    [score] = only_verdict(*pair, alone, record(scene="wall")).scores
    assert score.summary.startswith("1 of 1 pair, 1 of 2 other scenes; ")
    assert score.units is not None
    assert (score.units.right_count, score.units.n) == (2, 3), "one pair and two other scenes, as the ranking counts"


def test_the_frame_rate_is_that_of_the_slowest_scene():
    """The median of 2, 3 and 20 ms fits into a frame at 90 Hz, but the slowest scene does not fit at 60 Hz."""
    scenes = {"table": 2.0, "four_stack": 3.0, "card_house": 20.0}
    verdict = only_verdict(*(record(scene=scene, frame_ms_p99=time) for scene, time in scenes.items()))
    assert verdict.sentences[-1] == (
        "Alone: too slow for a frame at 60 Hz (20 ms in card_house; 3.0 ms in the median scene)."
    )


def test_each_policy_has_a_frame_rate_of_its_own():
    times = {"none": 20.0, "paper": 12.0, "equilibrium": 2.0}
    verdict = only_verdict(*(record(policy=policy, frame_ms_p99=time) for policy, time in times.items()))
    rates = dict(one.partition(" (")[0].split(": ") for one in verdict.sentences if "Hz" in one)
    assert rates == {
        "Alone": "too slow for a frame at 60 Hz",
        "With paper": "within a frame at 60 Hz",
        "With equilibrium": "within a frame at 90 Hz",
    }
