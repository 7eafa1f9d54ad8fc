"""Scenes of statics with all lengths times a factor: what changes, what stays, and that the answer is the same."""

import math
from dataclasses import replace
from functools import cache

import pytest

from bench.studies.plan import plan_trials
from bench.studies.schema import load_study
from scenarios.model import CLEARANCE, Place, Remove, pace_of
from scenarios.parameters import Value
from scenarios.placement_noise import SHIFT, deviates, with_placement_noise
from scenarios.registry import SCENARIOS, build
from scenarios.scenes.shared.prebuilt import STANDS_S, WITHIN
from scenarios.statics.falling import fall_time
from scenarios.statics.truth import first_fall
from tests.scenarios.statics.load_bearing import UNLOADED, first_fall_by_load

STATIC = [name for name, scenario in SCENARIOS.items() if scenario.is_static]
TRIALS = [trial for trial in plan_trials(load_study("any_size")) if trial.policy == "none" and trial.engine == "bullet"]
SCENES = {trial.scene: trial for trial in TRIALS if trial.parameters["size"] in (0.1, 100.0)}
QUICK = [name for name, trial in SCENES.items() if len(trial.planned_scene().bricks) < 8]
"""Exact statics takes seconds for the larger ones."""


def at_size_1(name):
    trial = SCENES[name]
    return build(trial.scenario, **{**trial.parameters, "size": 1.0})


def judged(scene):
    return first_fall_by_load(scene) if scene.scenario in UNLOADED else first_fall(scene)


@cache
def judged_at_size_1(scenario: str, parameters: tuple[tuple[str, Value], ...]) -> int | None:
    """The level at which a scene falls at size 1; cached, because it is compared with several sizes."""
    return judged(build(scenario, **dict(parameters)))


def same_answer(name):
    plain, scaled = at_size_1(name), SCENES[name].planned_scene()
    at_1 = judged_at_size_1(plain.scenario, tuple(plain.parameters.items()))
    return judged(scaled) == at_1 == scaled.expectation.level == plain.expectation.level


@pytest.mark.parametrize("name", QUICK)
def test_truth_is_free_of_scale(name):
    assert same_answer(name)


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(SCENES.keys() - set(QUICK)))
def test_truth_of_many_bricks_is_free_of_scale(name):
    assert same_answer(name)


def test_the_study_plays_every_family_that_has_a_size():
    played = {trial.scenario for trial in SCENES.values()}
    assert played == set(STATIC), f"add to bench/studies/any_size.toml and small_size.toml: {set(STATIC) - played}"
    small = {trial.scene for trial in plan_trials(load_study("small_size"))}
    assert small == {trial.scene for trial in TRIALS if trial.parameters["size"] == 0.1}


@pytest.mark.parametrize("name", STATIC)
def test_size_1_changes_nothing(name):
    plain, asked = build(name), build(name, size=1)
    assert asked == plain
    made = SCENARIOS[name]()
    assert replace(plain, parameters=made.parameters) == made


@pytest.mark.parametrize("built", ["one_by_one", "at_once"])
@pytest.mark.parametrize("size", [0.1, 3.0, 100.0])
def test_lengths_masses_and_times_change_alike(size, built):
    plain, scaled = (
        build("robbed_stack", stack="two_blocks", taken="support", built=built, size=factor) for factor in (1.0, size)
    )
    pace = max(1.0, math.sqrt(size))
    assert scaled.pace == pace_of(size) == pace
    assert scaled.world == plain.world, "gravity and friction stay"
    for before, after in zip(plain.bricks, scaled.bricks, strict=True):
        assert after.size == pytest.approx([size * edge for edge in before.size])
        assert after.position == pytest.approx([size * place for place in before.position])
        assert after.mass == pytest.approx(size**3 * before.mass)
        assert (after.quaternion, after.level) == (before.quaternion, before.level)
    assert [action.time for action in scaled.actions] == pytest.approx([pace * action.time for action in plain.actions])
    heights = {action.height for action in scaled.actions if isinstance(action, Place)}
    assert heights == {0.0 if built == "at_once" else CLEARANCE * size}
    assert scaled.expectation.not_before_s == pytest.approx(pace * plain.expectation.not_before_s)
    assert scaled.expectation.level == plain.expectation.level
    assert scaled.watch_s == pytest.approx(pace * plain.watch_s)


def test_fixed_boxes_change_with_the_bricks():
    plain, scaled = build("groove"), build("groove", size=10)
    assert plain.world.fixed
    for before, after in zip(plain.world.fixed, scaled.world.fixed, strict=True):
        assert after.size == pytest.approx([10 * edge for edge in before.size])
        assert after.position == pytest.approx([10 * place for place in before.position])


def test_a_prebuilt_stack_has_a_size_too():
    tower = build("leaning_tower", built="at_once", size=100)
    assert tower.variant == "leaning_tower-builtat_once-size100"
    assert (tower.parameters["built"], tower.parameters["size"]) == ("at_once", 100.0)
    assert tower.expectation.within_s == pytest.approx(WITHIN * fall_time(tower.bricks, tower.world), abs=0.01)
    below = build("leaning_tower", built="at_once_below", size=100)
    assert isinstance(below.actions[-1], Remove)
    assert below.actions[-1].time == below.expectation.not_before_s == STANDS_S * 10
    assert below.pair == tower.pair == "leaning_tower-at_once-size100"


def test_ids_contain_the_size():
    assert build("table", legs=3, size=0.1).variant == "table-3-size0.1"
    assert build("table", size=10.0).variant == build("table", size=10).variant == "table-size10"
    ids = {build("plank_tower", size=size).variant for size in (0.1, 0.1000001, 0.10000001, 10, 10.000001)}
    assert len(ids) == 5


def test_small_bricks_keep_their_times():
    assert build("leaning_tower", size=0.1).actions[-1].time == build("leaning_tower").actions[-1].time == 12.0


def test_placement_noise_grows_with_the_bricks():
    for size in (0.1, 1.0, 100.0):
        exact = build("four_stack", levels=1, size=size)
        planned, laid = exact.bricks[0], with_placement_noise(exact, 1).bricks[0]
        dx, dy, _ = deviates(exact.variant, 1, 0)
        errors = [after - before for before, after in zip(planned.position, laid.position, strict=True)]
        assert errors == pytest.approx([size * SHIFT * dx, size * SHIFT * dy, 0.0], rel=1e-6, abs=1e-12)


@pytest.mark.parametrize("size", [0, -1, 0.001, 1001, float("nan"), "large", True])
def test_a_size_that_makes_no_scene_names_what_is_allowed(size):
    with pytest.raises(ValueError, match=r"scenario table: size must be a number from 0.01 to 1000"):
        build("table", size=size)


def test_what_is_pulled_has_one_size_only():
    with pytest.raises(ValueError, match=r"scenario jenga: .* also pours or moves bricks: leave out 'size'"):
        build("jenga", speed=0.1, size=10)
    assert "size" not in SCENARIOS["pushed_plank"].parameters
