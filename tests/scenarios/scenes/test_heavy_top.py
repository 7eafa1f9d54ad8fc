"""Heavy on light: the answers by closed form, and by exact statics."""

import pytest

from bench.studies.plan import plan_trials
from bench.studies.schema import load_study
from scenarios.registry import build
from scenarios.statics.truth import first_fall


@pytest.mark.parametrize("ratio", [10.0, 100.0, 300.0])
@pytest.mark.parametrize("shape", [{}, {"stack": "pyramid", "rows": 3}])
def test_weight_topples_nothing(ratio, shape):
    scene = build("heavy_top", ratio=ratio, **shape)
    assert scene.expectation.outcome == "stand"
    assert first_fall(scene) is None
    assert scene.bricks[-1].mass == pytest.approx(ratio * scene.bricks[0].mass)


@pytest.mark.slow
def test_a_pyramid_of_55_cubes_stands_under_any_cap():
    scene = build("heavy_top", stack="pyramid", ratio=300.0)
    assert len(scene.bricks) == 55
    assert first_fall(scene) is None


def test_a_cube_tips_over_an_edge_whatever_it_weighs():
    for ratio in (0.5 * 6, 300.0):
        stands, falls = (build("heavy_top", ratio=ratio, aside=aside) for aside in (0.4, 0.6))
        assert (stands.expectation.outcome, falls.expectation.level) == ("stand", 2)
        assert (first_fall(stands), first_fall(falls)) == (None, 2)
        assert stands.pair == falls.pair == stands.variant


def test_the_cap_of_a_pyramid_lies_in_the_middle():
    with pytest.raises(ValueError, match=r"'aside' applies only to stack = 'column', got .* with stack = 'pyramid'"):
        build("heavy_top", stack="pyramid", aside=0.4)


def test_the_study_has_every_scene_and_far_from_the_origin():
    scenes = {trial.scene for trial in plan_trials(load_study("heavy"))}
    assert len([name for name in scenes if "pyramid" in name]) == 3
    assert len([name for name in scenes if "aside" in name]) == 2
    assert "game@offset=100" in load_study("heavy").profiles
