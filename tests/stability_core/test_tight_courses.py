"""Cases of ``tight_courses`` that decided how loading is solved, and what an engine's step has to do with a verdict."""

from __future__ import annotations

import pytest

from tests.stability_core.tight_courses import REFINED, ask_core, play, world


@pytest.mark.parametrize(("at", "place"), [(41, 16), (289, 16)])
def test_loading_finds_what_newtons_method_alone_does_not(at, place):
    """They stand in three engines. Halved steps of Newton's method end in a local minimum; rounds of bounds go on."""
    friction, group = world(at)
    assert ask_core(group[place], friction) == "stable"


DENIED = [
    (31, 15),
    (41, 8),
    (103, 18),
    (114, 10),
    (131, 2),
    (148, 1),
    (223, 5),
    (257, 7),
    (278, 13),
    (306, 2),
    (426, 2),
    (459, 5),
    (474, 4),
]
"""All cases that are called stable and fall in two or three of the engines, by world and place."""
FALL_IN_BULLET = {(148, 1), (459, 5)}
"""Cases within 0.05 mm of their balance, which Bullet lets fall at any step."""


@pytest.mark.slow
@pytest.mark.parametrize(("at", "place"), DENIED)
def test_what_is_stable_stands_where_contacts_give_less(at, place):
    """The engines' contacts give under load and let it fall; it stands at an eighth of the step, and without give."""
    friction, group = world(at)
    bricks = group[place]
    assert ask_core(bricks, friction) == "stable"
    ends = {engine: play(engine, profile, friction, [bricks]) for engine, profile in REFINED.items()}
    assert ends["mujoco"] == ends["staggered"] == ["stands"]
    assert ends["bullet"] == (["falls"] if (at, place) in FALL_IN_BULLET else ["stands"])


@pytest.mark.slow
@pytest.mark.parametrize(("at", "place"), [(66, 19), (424, 17)])
def test_what_only_prestress_could_hold_goes_on_falling(at, place):
    friction, group = world(at)
    bricks = group[place]
    assert ask_core(bricks, friction) == "doubt"
    assert {play(engine, profile, friction, [bricks])[0] for engine, profile in REFINED.items()} == {"falls"}
