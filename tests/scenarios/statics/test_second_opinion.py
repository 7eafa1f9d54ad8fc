"""Two criteria agree about every scene of the study `truth`."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

import pytest

from scenarios.model import Brick, Place, Pull, Push, Scene, World
from scenarios.shapes import are_boxes
from scenarios.statics.second_opinion import Agreement, agreed_verdict
from tests.scenarios.statics.masonry import TABLE, overhang
from tests.scenarios.studied import studied_scenes

SCENES = studied_scenes("truth")
QUICK = [
    name
    for name, scene in SCENES.items()
    if len(scene.bricks) < 8 and are_boxes([brick.shape for brick in scene.bricks])
]
"""Solids have up to 32 corners a patch, so they are in the slow part; ``tests/oracle`` confirms them by compas_cra."""
STRUCK = {"pushed_plank", "dropped_plank", "dominoes"}
"""Families whose outcome a blow or a push decides, of which statics says nothing: the bricks in their planned poses
stand. How far a striker must push a domino is the scene's closed form."""


def states_of(scene: Scene) -> Iterator[list[Brick]]:
    """The bricks that are there after each action that changes them; what is pulled is gone when the pull ends."""
    ends = [action.until if isinstance(action, Pull) else action.time for action in scene.actions]
    changes = [index for index, action in enumerate(scene.actions) if not isinstance(action, Push)]
    changes.sort(key=ends.__getitem__)
    present: list[int] = []
    placed = 0
    for index, then in zip(changes, [*changes[1:], None], strict=True):
        action = scene.actions[index]
        if isinstance(action, Place):
            present += range(placed, placed + len(action.bricks))
            placed += len(action.bricks)
        else:
            present.remove(action.brick)
        if present and (then is None or ends[then] != ends[index]):
            yield [scene.bricks[brick] for brick in present]


@cache
def final_agreement(name: str) -> Agreement:
    """What both criteria say of a scene's last state; cached, because several tests ask."""
    *_, last = states_of(SCENES[name])
    return agreed_verdict(last, SCENES[name].world)


def expected(scene: Scene) -> str:
    return "stands" if scene.expectation.outcome == "stand" or scene.scenario in STRUCK else "falls"


@pytest.mark.parametrize("name", QUICK)
def test_two_criteria_agree_with_the_expectation(name):
    assert final_agreement(name).verdict == expected(SCENES[name])


@pytest.mark.slow
@pytest.mark.parametrize("name", SCENES)
def test_two_criteria_agree_in_every_state(name):
    scene = SCENES[name]
    verdicts = []
    for state in states_of(scene):
        verdicts.append(agreed_verdict(state, scene.world).verdict)
        if verdicts[-1] != "stands":
            break
    assert verdicts[-1] == expected(scene)


@pytest.mark.parametrize(
    ("name", "second"),
    [
        ("pyramid", "normal forces"),
        ("card_house-2", "strong stability"),
        ("card_house-3", "other stiffness"),
        ("leaning_tower-4.5-levels5", "cone"),
        ("neighbour_side--0.15", "strong stability"),
    ],
)
def test_the_second_criterion_is_the_first_that_can_answer(name, second):
    assert final_agreement(name).second == second


def test_both_see_that_a_neighbours_side_holds_nothing():
    world = World(fixed=(TABLE,))
    agreement = agreed_verdict(overhang(5e-3), world)
    assert (agreement.verdict, agreement.second) == ("falls", "strong stability")
    assert agreed_verdict(overhang(-5e-3), world).verdict == "stands"
