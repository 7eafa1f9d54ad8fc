"""Cases of ``tight_courses`` that decided how loading is solved, and what an engine's step has to do with a verdict."""

from __future__ import annotations

import pytest

from tests.stability_core.tight_courses import REFINED, ask_core, play, world


@pytest.mark.parametrize(("at", "place"), [(41, 16), (289, 16)])
def test_loading_finds_what_newtons_method_alone_does_not(at, place):
    """They stand in three engines. Halved steps of Newton's method end in a local minimum; rounds of bounds go on."""
    friction, group = world(at)
    assert ask_core(group[place], friction) == "stable"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("at", "place", "verdict", "tuned", "refined"),
    [
        (474, 4, "stable", "falls", "stands"),  # within 0.2 mm of where it would topple
        (306, 2, "stable", "falls", "stands"),
        (66, 19, "doubt", "falls", "falls"),  # only prestress could hold it
        (424, 17, "doubt", "falls", "falls"),
    ],
)
def test_what_only_a_coarse_step_brings_down_stands_with_an_eighth_of_it(at, place, verdict, tuned, refined):
    """What is called stable and falls in MuJoCo falls by the give of its contacts; what is in doubt goes on falling."""
    friction, group = world(at)
    bricks = group[place]
    assert ask_core(bricks, friction) == verdict
    assert play("mujoco", "tuned", friction, [bricks]) == [tuned]
    assert play("mujoco", REFINED["mujoco"], friction, [bricks]) == [refined]
