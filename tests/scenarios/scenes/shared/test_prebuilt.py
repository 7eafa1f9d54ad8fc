"""Prebuilt stacks: which bricks, in place from the start, and that exact statics agrees with what must happen."""

from dataclasses import replace

import pytest

from reports.statistics.pairs import are_opposed
from scenarios.geometry import Boxes, height_above_ground
from scenarios.model import Place, Remove
from scenarios.placement_noise import with_placement_noise
from scenarios.registry import SCENARIOS, build
from scenarios.scenes.card_house import RIDGE_GAP
from scenarios.scenes.shared.pedestals import PEDESTAL
from scenarios.scenes.shared.prebuilt import RIDGES, STANDS_S, WITHIN, is_static
from scenarios.statics.contact_patch import contact_patches
from scenarios.statics.falling import fall_time
from scenarios.statics.truth import equilibrium, first_fall
from tests.scenarios.statics.load_bearing import UNLOADED, first_fall_by_load
from tests.scenarios.studied import studied_scenes

SCENES = studied_scenes("at_once")
AT_ONCE = {name: scene for name, scene in SCENES.items() if scene.expectation.within_s is not None}
LATER = {name: scene for name, scene in SCENES.items() if name not in AT_ONCE}
QUICK = sorted(name for name, scene in SCENES.items() if len(scene.bricks) < 8)
"""Exact statics takes seconds for the larger ones."""


def agrees(scene) -> bool:
    """Whether exact statics finds the level under both conventions for the normal at a ridge, if there is one."""
    if scene.scenario in UNLOADED:
        return first_fall_by_load(scene) == scene.expectation.level
    bisector, face = (contact_patches(scene.bricks, scene.world.fixed, ridge=ridge) for ridge in RIDGES)
    differ = any((one.normal != other.normal).any() for one, other in zip(bisector, face, strict=True))
    ridges = RIDGES if differ else RIDGES[:1]
    return {first_fall(scene, ridge=ridge) for ridge in ridges} == {scene.expectation.level}


@pytest.mark.parametrize("name", QUICK)
def test_exact_statics_agrees(name):
    assert agrees(SCENES[name])


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(SCENES.keys() - set(QUICK)))
def test_exact_statics_agrees_of_many_bricks(name):
    assert agrees(SCENES[name])


def test_every_scene_is_set_down_at_once_and_without_a_gap():
    for scene in SCENES.values():
        places = [action for action in scene.actions if isinstance(action, Place)]
        assert [(place.time, place.height) for place in places] == [(0.0, 0.0)]
        assert places[0].bricks == scene.bricks
        assert sorted({brick.level for brick in scene.bricks}) == list(range(1, scene.levels + 1))
        contact_patches(scene.bricks, scene.world.fixed)  # refuses overlap
        if not scene.world.fixed:
            assert height_above_ground(Boxes.of(scene.bricks)).min() == pytest.approx(0.0, abs=1e-12)


def test_no_scene_is_statics_without_physics():
    """Each falls: at once, or when a brick is taken, until which it stands."""
    assert len(AT_ONCE) >= 25
    assert len(LATER) >= 40
    for scene in SCENES.values():
        assert scene.expectation.outcome == "fall"
        assert scene.watch_s >= (scene.expectation.within_s or 0.0)
    for name, scene in LATER.items():
        removals = [action for action in scene.actions if isinstance(action, Remove)]
        assert scene.expectation.not_before_s == removals[-1].time >= 2.0, name
        if name in QUICK:
            assert equilibrium(scene.bricks, scene.world).stable, name


def test_a_fall_is_due_within_three_times_its_closed_form():
    for scene in AT_ONCE.values():
        assert scene.expectation.not_before_s == 0.0
        assert scene.expectation.within_s == pytest.approx(WITHIN * fall_time(scene.bricks, scene.world), abs=1e-3)


def test_pairs_ask_for_opposite_things():
    pairs: dict[str, list] = {}
    for scene in SCENES.values():
        if scene.pair:
            pairs.setdefault(scene.pair, []).append(scene)
    whole = [name for name, sides in pairs.items() if are_opposed([side.expectation for side in sides])]
    assert len(whole) >= 25
    lonely = {scene.scenario for name, sides in pairs.items() if name not in whole for scene in sides}
    assert lonely == {
        "plank_tower", "four_stack", "brick_wall", "pyramid", "log_cabin", "card_house", "jenga", "neighbour_side",
        "ceiling", "groove",
    }  # fmt: skip


@pytest.mark.parametrize("levels", [9, 13])
def test_a_tower_is_built_up_to_the_level_at_which_it_falls(levels):
    falls = build("leaning_tower", levels=levels, built="at_once")
    below = build("leaning_tower", levels=levels, built="at_once_below")
    assert (falls.levels, falls.expectation.level) == (9, 9)
    assert (below.levels, below.expectation.level) == (8, 8)
    assert below.expectation.not_before_s == STANDS_S
    assert below.pair == falls.pair


def test_its_id_and_parameters_say_how_it_is_built_and_old_ids_stay():
    plain, prebuilt = (build("leaning_tower", levels=8, built=built) for built in ("one_by_one", "at_once"))
    assert plain.variant == build("leaning_tower", levels=8).variant == "leaning_tower-levels8"
    assert prebuilt.variant == "leaning_tower-levels8-builtat_once"
    assert (plain.parameters["built"], prebuilt.parameters["built"]) == ("one_by_one", "at_once")
    assert plain.actions == build("leaning_tower", levels=8).actions


def test_what_is_taken_anyway_keeps_its_distance_from_the_last_brick():
    plain, prebuilt = (build("robbed_stack", taken="support", built=built) for built in ("one_by_one", "at_once"))
    last = plain.actions[-2].time
    assert prebuilt.actions[-1] == Remove(plain.actions[-1].time - last, plain.actions[-1].brick)
    assert prebuilt.expectation.not_before_s == plain.expectation.not_before_s - last
    assert prebuilt.expectation.level == plain.expectation.level


@pytest.mark.parametrize(
    ("name", "parameters", "taken"),
    [
        ("plank_tower", {"levels": 5}, 0),  # all that it carried drops by its thickness
        ("cantilever", {}, 0),  # the pier
        ("card_house", {}, 0),  # what it leaned against falls over
        ("brick_wall", {"courses": 3, "width": 2}, 0),  # the half plank above drops
        ("neighbour_side", {}, 0),
    ],
)
def test_the_first_brick_whose_loss_is_seen_is_taken(name, parameters, taken):
    plain, prebuilt = build(name, **parameters), build(name, built="at_once", **parameters)
    for here, there in zip(prebuilt.bricks, plain.bricks, strict=True):
        assert replace(here, position=there.position) == there
        assert here.position == pytest.approx(there.position, abs=0.51 * RIDGE_GAP)
    assert prebuilt.actions[-1] == Remove(prebuilt.expectation.not_before_s, taken)


@pytest.mark.parametrize(("name", "below"), [("four_stack", 4), ("log_cabin", 2), ("pyramid", 4)])
def test_flat_planks_with_two_supports_each_stand_on_pedestals(name, below):
    """Without a plank of the lowest level the next one's end would sink by a thickness, which cannot be seen."""
    parameters = {"levels": 3} if name != "pyramid" else {}
    plain, prebuilt = build(name, **parameters), build(name, built="at_once", **parameters)
    assert prebuilt.levels == plain.levels + 1
    assert [brick.size[2] for brick in prebuilt.bricks[:below]] == [PEDESTAL] * below
    assert [brick.position[2] for brick in prebuilt.bricks[below:]] == pytest.approx(
        [brick.position[2] + PEDESTAL for brick in plain.bricks]
    )


def test_placement_noise_moves_the_whole():
    """A prebuilt stack is one group: noise shifts and turns it, so that its levels still touch."""
    scene = build("four_stack", levels=2, built="at_once")
    touched = {(patch.first, patch.second) for patch in contact_patches(scene.bricks)}
    assert {(patch.first, patch.second) for patch in contact_patches(with_placement_noise(scene, 3).bricks)} == touched


@pytest.mark.parametrize(
    ("name", "parameters", "message"),
    [
        (
            "leaning_tower",
            {"built": "at_onec"},
            "built must be one of one_by_one, at_once or at_once_below, got",
        ),
        ("leaning_tower", {"ratio": 9, "built": "at_once"}, r"leaning_tower-9 has no known answer \(n d = L within 5%"),
        (
            "card_house",
            {"friction": 0.2, "built": "at_once"},
            "has no known answer .*the ridge's contact normal",
        ),
        ("jenga", {"speed": 0.1, "built": "at_once"}, "jenga-speed0.1 also pours or moves bricks"),
        ("plank_tower", {"built": "at_once_below"}, "falls above level 1 .*, but plank_tower does not"),
        ("groove", {"margin": -0.35, "built": "at_once_below"}, "needs a scene that falls above level 1"),
        ("groove", {"built": "at_once"}, "groove-builtat_once has no brick of this kind"),
    ],
)
def test_what_cannot_be_prebuilt_says_why(name, parameters, message):
    with pytest.raises(ValueError, match=f"scenario {name}: .*{message}"):
        build(name, **parameters)


@pytest.mark.parametrize("name", SCENARIOS)
def test_every_scenario_of_statics_has_the_parameter(name):
    """A scene of one's own says in its file which bricks come together; those that are measured have one way."""
    has_one_way = name in {"dropped_plank", "own_scene", "slope", "overhang", "leaning_pair", "tipping_post", "asleep"}
    assert SCENARIOS[name].is_static == (is_static(build(name)) and not has_one_way)
    assert ("built" in SCENARIOS[name].parameters) == SCENARIOS[name].is_static


def test_ridges_are_closed():
    """The planks of each V touch, to rounding, and the truth of the house is the same."""
    house = build("card_house", storeys=3, built="at_once")
    corners = Boxes.of(house.bricks).corners
    ridges = [patch for patch in contact_patches(house.bricks) if patch.first >= 0 and abs(patch.normal[2]) < 0.1]
    assert len(ridges) == 6
    for patch in ridges:
        apart = (corners[patch.second] @ patch.normal).min() - (corners[patch.first] @ patch.normal).max()
        assert abs(apart) < 1e-12
    assert equilibrium(house.bricks, house.world).stable
