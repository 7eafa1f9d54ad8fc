"""Two criteria agree about every scene of the study `truth`."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from bench.plan import plan_trials
from bench.studies import load_study
from scenarios.model import Brick, Place, Pull, Push, Scene, World
from scenarios.registry import build
from scenarios.second_opinion import agreed_verdict
from tests.scenarios.masonry import overhang

SCENES = {
    scene.variant: scene
    for scene in (build(trial.scenario, **trial.parameters) for trial in plan_trials(load_study("truth")))
}
QUICK = [name for name, scene in SCENES.items() if len(scene.bricks) < 8]
"""Their last states take a second at most."""


def states_of(scene: Scene) -> Iterator[list[Brick]]:
    """The bricks that are there after each action that changes them; what is pulled is gone when the pull ends."""
    times = {
        index: action.until if isinstance(action, Pull) else action.time for index, action in enumerate(scene.actions)
    }
    changes = [index for index in sorted(times, key=times.__getitem__) if not isinstance(scene.actions[index], Push)]
    present: list[int] = []
    placed = 0
    for index, then in zip(changes, [*changes[1:], None], strict=True):
        action = scene.actions[index]
        if isinstance(action, Place):
            present += range(placed, placed + len(action.bricks))
            placed += len(action.bricks)
        else:
            present.remove(action.brick)
        if present and (then is None or times[then] != times[index]):
            yield [scene.bricks[brick] for brick in present]


def statics_of(scene: Scene) -> str:
    """What statics must say of the last state that counts; of a blow it says nothing."""
    is_struck = any(isinstance(action, Push) for action in scene.actions)
    return "stable" if scene.expectation.outcome == "stand" or is_struck else "unstable"


@pytest.mark.parametrize("name", QUICK)
def test_two_criteria_agree_with_the_expectation(name):
    scene = SCENES[name]
    states = list(states_of(scene))
    if statics_of(scene) == "stable":
        assert agreed_verdict(states[-1], scene.world).verdict == "stable"
        return
    fallen = next(index for index, state in enumerate(states) if agreed_verdict(state, scene.world).verdict != "stable")
    assert agreed_verdict(states[fallen], scene.world).verdict == "unstable"


@pytest.mark.slow
@pytest.mark.parametrize("name", SCENES)
def test_two_criteria_agree_in_every_state(name):
    scene = SCENES[name]
    verdicts = []
    for state in states_of(scene):
        verdicts.append(agreed_verdict(state, scene.world).verdict)
        if verdicts[-1] != "stable":
            break
    assert verdicts[-1] == statics_of(scene)


def test_of_114_scenes_normal_forces_or_strong_stability_confirm_all_but_the_large_card_houses():
    """The second criterion of a state that has many bricks, leans and stands is the weakest one."""
    house = SCENES["card_house-3"]
    assert agreed_verdict(house.bricks, house.world).second == "other stiffness"
    assert agreed_verdict(SCENES["card_house-2"].bricks, house.world).second == "strong stability"
    assert agreed_verdict(SCENES["pyramid"].bricks, house.world).second == "normal forces"


def test_they_do_not_agree_about_the_side_of_a_neighbour():
    pedestal = Brick((0.4, 0.06, 0.1), 100.0, (-0.2, 0.0, 0.05))
    agreement = agreed_verdict([pedestal, *overhang(5e-3)], World())
    assert (agreement.verdict, agreement.first) == ("doubt", "loading")
    assert agreement.why.startswith("needs prestress")
