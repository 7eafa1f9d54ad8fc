"""What holds for every scene: its bricks rest on each other, apart from each other, in good time."""

import numpy as np
import pytest

from scenarios.geometry import Boxes, height_above_ground, overlap_in_plan, vertical_clearance
from scenarios.model import Place
from scenarios.planks import LENGTH, MASS, THICKNESS, WIDTH
from scenarios.registry import build

SCENES = [
    build("plank_tower"),
    build("four_stack"),
    build("leaning_tower"),
    build("leaning_tower", ratio=12.5),
    build("brick_wall"),
    build("brick_wall", width=4, courses=5),
    build("card_house"),
    build("card_house", storeys=2),
    build("card_house", storeys=3),
    build("card_house", storeys=3, theta=70),
    build("card_house", storeys=3, theta=85),
]

every_scene = pytest.mark.parametrize("scene", SCENES, ids=lambda scene: scene.variant)


def levels(scene):
    return [[brick for brick in scene.bricks if brick.level == level] for level in range(1, scene.levels + 1)]


@every_scene
def test_every_brick_touches_the_level_below_and_sinks_into_nothing(scene):
    assert height_above_ground(Boxes.of(levels(scene)[0])) == pytest.approx(0, abs=1e-12)
    for index, level in enumerate(levels(scene)[1:], start=1):
        lower = Boxes.of([brick for below in levels(scene)[:index] for brick in below])
        assert vertical_clearance(Boxes.of(level), lower).min(axis=1) == pytest.approx(0, abs=1e-12)


@every_scene
def test_no_two_bricks_of_a_level_overlap_in_plan(scene):
    for level in levels(scene):
        boxes = Boxes.of(level)
        assert (overlap_in_plan(boxes, boxes) == np.eye(len(level))).all()


@every_scene
def test_bricks_come_one_place_a_second_and_never_before_their_support(scene):
    assert [action.time for action in scene.actions] == list(range(len(scene.actions)))
    assert all(isinstance(action, Place) for action in scene.actions)
    order = [brick.level for brick in scene.bricks]
    assert order == sorted(order)


@every_scene
def test_planar_scenes_stay_in_the_plane(scene):
    for brick in scene.bricks:
        _, i, _, k = brick.quaternion
        assert not scene.planar or (brick.position[1] == 0 and i == 0 and k == 0)


@every_scene
def test_bricks_are_planks_of_the_nominal_density(scene):
    for brick in scene.bricks:
        assert brick.size[1:] == (WIDTH, THICKNESS)
        assert brick.mass / brick.size[0] == pytest.approx(MASS / LENGTH)


def test_only_the_pinwheel_needs_three_dimensions():
    assert {scene.scenario for scene in SCENES if not scene.planar} == {"four_stack"}


def test_the_nominal_plank_is_15_to_3_to_1():
    assert np.divide((LENGTH, WIDTH), THICKNESS) == pytest.approx([15, 3])


@pytest.mark.parametrize("name", ["four_stack", "brick_wall"])
def test_neighbours_of_a_level_leave_two_millimetres(name):
    for level in levels(build(name))[:2]:
        boxes = Boxes.of(level)
        apart = np.abs(boxes.center[:, None] - boxes.center) - boxes.reach[:, None] - boxes.reach
        gap = apart.max(axis=2)[~np.eye(len(level), dtype=bool)]
        assert gap.min() == pytest.approx(2e-3)
