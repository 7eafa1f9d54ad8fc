"""Neighbours whose faces touch: plans, closed forms and placement noise of scenes with ``gap = 0``."""

import numpy as np
import pytest

from scenarios.geometry import Boxes, overlap_in_plan
from scenarios.model import Brick, Expectation, Place, Scene, World
from scenarios.placement_noise import CUT, SHIFT, NoRoomError, with_placement_noise
from scenarios.planks import LENGTH, WIDTH, box, lay
from scenarios.registry import SCENARIOS, build
from scenarios.statics import truth
from scenarios.statics.contact_patch import contact_patches
from scenarios.statics.truth import first_fall

TIGHT = [
    ("four_stack", {"levels": 3}),
    ("brick_wall", {"courses": 5, "width": 2}),
    ("pyramid", {}),
    ("jenga", {"left": "middle"}),
    ("jenga", {"left": "side"}),
    ("robbed_stack", {"stack": "four_stack", "taken": "load"}),
    ("robbed_stack", {"stack": "four_stack", "taken": "support"}),
    ("robbed_stack", {"stack": "brick_wall", "taken": "load"}),
    ("robbed_stack", {"stack": "brick_wall", "taken": "support"}),
    ("card_house", {"storeys": 3}),
    ("wall_plank", {"held_by": 3}),
    ("wall_plank", {"held_by": 4}),
]
every_tight_scene = pytest.mark.parametrize(
    ("name", "parameters"), TIGHT, ids=["-".join(map(str, (name, *p.values()))) for name, p in TIGHT]
)


def is_side(patch) -> bool:
    return abs(patch.normal[2]) < 1e-9


def upright(bricks, patch) -> bool:
    return all(bricks[index].quaternion[1:3] == (0.0, 0.0) for index in (patch.first, patch.second))


@pytest.mark.parametrize("name", sorted({name for name, _ in TIGHT}))
def test_the_gap_of_before_is_the_default(name):
    gap = SCENARIOS[name].parameters["gap"]
    assert build(name, gap=gap).variant == build(name).variant == name
    assert build(name, gap=0).variant == f"{name}-gap0"


@every_tight_scene
def test_without_a_gap_faces_touch_and_with_one_they_do_not(name, parameters):
    """A touch is exact, and no overlap: ``contact_patches`` refuses that. What leans is left out: boxes of one height
    alone are neighbours."""
    for gap, touches in (({"gap": 0}, True), ({}, False)):
        bricks = build(name, **gap, **parameters).bricks
        neighbours = [
            patch
            for patch in contact_patches(bricks)
            if is_side(patch) and bricks[patch.first].size[2] == bricks[patch.second].size[2] and upright(bricks, patch)
        ]
        assert bool(neighbours) == touches


@every_tight_scene
def test_bricks_are_as_many_and_as_planned_but_for_the_gap(name, parameters):
    tight, apart = build(name, gap=0, **parameters), build(name, **parameters)
    assert tight.expectation.outcome == apart.expectation.outcome
    assert tight.expectation.level == apart.expectation.level
    assert [type(action) for action in tight.actions] == [type(action) for action in apart.actions]


@every_tight_scene
def test_load_bearing_contacts_alone_decide(name, parameters, monkeypatch):
    """Sides that touch press on nothing, so that without them the answer is the same; so it is in the closed forms."""
    if name in ("wall_plank", "card_house"):
        pytest.skip("there a vertical face is what a plank leans on")
    scene = build(name, gap=0, **parameters)
    monkeypatch.setattr(
        truth, "contact_patches", lambda *a, **k: [patch for patch in contact_patches(*a, **k) if not is_side(patch)]
    )
    assert first_fall(scene) == scene.expectation.level


def test_a_gap_that_a_stack_does_not_have_is_refused():
    with pytest.raises(
        ValueError,
        match=r"applies only if stack is four_stack or brick_wall, got gap = .* with stack = 'log_cabin'",
    ):
        build("robbed_stack", stack="log_cabin", gap=0)


# -- closed forms ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("gap", [0.0, 2.0, 5.0])
def test_what_is_left_of_a_robbed_level_carries_or_does_not(gap):
    """The upper part's centre of mass lies half a width inside the middle plank; half a width and the gap beside a side
    plank."""
    for left, place, beyond in (("middle", 1, -WIDTH / 2), ("side", 2, WIDTH / 2 + gap * 1e-3)):
        scene = build("jenga", left=left, gap=gap)
        plank = scene.bricks[3 + place]
        above = [brick for brick in scene.bricks if brick.level > 2]
        centre = sum(brick.mass * brick.position[0] for brick in above) / sum(brick.mass for brick in above)
        edge = abs(plank.position[0] - centre) - WIDTH / 2  # planks of level 2 lie along y, side by side in x
        assert edge == pytest.approx(beyond)
        assert (edge > 0) == (scene.expectation.outcome == "fall")


@pytest.mark.parametrize("gap", [0.0, 2.0, 58.5])
def test_every_plank_of_a_pyramid_lies_on_two_alike(gap):
    scene = build("pyramid", gap=gap)
    for level in (2, 3, 4):
        lower = [brick.position[0] for brick in scene.bricks if brick.level == level - 1]
        for brick in (brick for brick in scene.bricks if brick.level == level):
            left, right = sorted(x - brick.position[0] for x in lower if abs(x - brick.position[0]) < LENGTH)
            assert left == pytest.approx(-right)
            assert right == pytest.approx((LENGTH + gap * 1e-3) / 2)


# -- placement noise ---------------------------------------------------------------------------------------------------


@every_tight_scene
def test_noise_opens_a_joint_and_never_pushes_one_brick_into_another(name, parameters):
    plan = build(name, gap=0, **parameters)
    level = np.array([brick.level for brick in plan.bricks])
    places = [action for action in plan.actions if isinstance(action, Place)]
    group = np.repeat(np.arange(len(places)), [len(place.bricks) for place in places])
    beside = (level[:, None] == level) & (group[:, None] != group)
    for seed in range(1, 6):
        laid = with_placement_noise(plan, seed)
        boxes = Boxes.of(laid.bricks)
        assert not (overlap_in_plan(boxes, boxes) & beside).any()
        assert laid.bricks != plan.bricks


def test_a_row_of_touching_planks_grows_and_finds_room():
    """Each must err farther than the one before it: nine planks find no room within three standard deviations."""
    row = tuple(Place(float(k), (lay(k * LENGTH, level=1),)) for k in range(9))
    scene = Scene("test", "test", {}, World(), row, Expectation("study", ""), "", planar=True)
    for seed in range(1, 11):
        errors = [b.position[0] - k * LENGTH for k, b in enumerate(with_placement_noise(scene, seed).bricks)]
        assert (np.diff(errors) > -1e-9).all()
        assert errors[0] <= CUT * SHIFT


def between_walls(gap: float) -> Scene:
    """A plank on a prop, ``gap`` [m] away from a fixed wall at each end."""
    walls = tuple(box((0.05, WIDTH, 0.2), side * (LENGTH / 2 + gap + 0.025), level=1) for side in (-1, 1))
    prop, plank = box((0.02, WIDTH, 0.05), 0.0, level=1), lay(0.0, level=2, bottom=0.05)
    actions = (Place(0.0, (prop,)), Place(1.0, (plank,)))
    return Scene("test", "test", {}, World(fixed=walls), actions, Expectation("study", ""), "", planar=True)


def test_a_brick_between_fixed_walls_has_no_room_for_noise():
    assert with_placement_noise(between_walls(0.0), 0).bricks[1].position[0] == 0.0
    with pytest.raises(NoRoomError, match=r"test, seed 1: brick 1 has no room for placement noise.*use seed 0"):
        with_placement_noise(between_walls(0.0), 1)


def test_noise_never_pushes_a_brick_into_a_fixed_wall():
    """0.1 mm from either wall, three of four draws would."""
    for seed in range(1, 20):
        assert abs(with_placement_noise(between_walls(1e-4), seed).bricks[1].position[0]) <= 1e-4


def test_noise_never_pushes_a_brick_into_a_neighbour_of_another_level():
    """A plank whose end touches a block that stands beside the pile: levels 2 and 1."""
    block, low = box((0.05, 0.05, 0.1), LENGTH / 2 + 0.025, level=1), box((LENGTH / 2, WIDTH, 0.02), -0.02, level=1)
    plank: Brick = lay(0.0, level=2, bottom=0.02)
    actions = (Place(0.0, (block,)), Place(1.0, (low,)), Place(2.0, (plank,)))
    scene = Scene("test", "test", {}, World(), actions, Expectation("study", ""), "")
    for seed in range(1, 20):
        laid = with_placement_noise(scene, seed).bricks
        assert not overlap_in_plan(Boxes.of([laid[2]]), Boxes.of([laid[0]])).any()
