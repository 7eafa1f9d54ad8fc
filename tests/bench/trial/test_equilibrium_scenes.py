"""The policy `equilibrium` on real engines: what must stand stands, and what must fall falls as one."""

from __future__ import annotations

import math

import pytest

from adapters import open_engine
from bench.publishing.kept_pose import ENGINES, watch_fall
from bench.trial.playback import Playback
from scenarios.registry import build


def plays_to_its_end(engine: str, profile: str, **parameters: float) -> Playback:
    pytest.importorskip({"bullet": "pybullet"}.get(engine, engine))
    scene = build("card_house", **parameters)
    assert scene.expectation.outcome == "stand"
    simulation = open_engine(engine, profile, world=scene.world, sleeping="off", expected=scene.bricks)
    play = Playback(scene, simulation, "equilibrium", math.inf, lambda _: None)
    assert play.run() == "completed"
    return play


@pytest.mark.parametrize("storeys", [2, 3])
def test_a_card_house_stands_on_vs_that_mujoco_skews(storeys):
    """The planks of a frozen V differ in height by some tenths of a millimetre: the roof lies on both all the same."""
    assert plays_to_its_end("mujoco", "game", storeys=storeys).sleep_stats.wakes == 0


@pytest.mark.parametrize("storeys", [3, 4])
def test_a_card_house_stands_on_roofs_that_bullet_shows_on_some_of_their_edges(storeys):
    """A roof that tilts by a milliradian penetrates one plank of a V only; over the other it ends a hair above."""
    assert plays_to_its_end("bullet", "tuned", storeys=storeys).sleep_stats.wakes == 0


@pytest.mark.parametrize("theta", [72.0, 78.0, 84.0])
def test_a_v_stands_however_deep_its_feet_land(theta):
    """One step of 1/60 s a frame lets feet land 2.2 mm deep; of a steep V the heels go in as well."""
    plays_to_its_end("mujoco", "game", theta=theta)


@pytest.mark.slow
def test_a_card_house_of_five_storeys_stands_on_mujoco():
    """Its Vs land on roofs that tilt by half a milliradian: the two feet of one are let go at unequal heights."""
    assert plays_to_its_end("mujoco", "tuned", storeys=5).sleep_stats.wakes == 0


@pytest.mark.slow
@pytest.mark.parametrize("engine", ENGINES)
def test_a_leaning_tower_falls_as_one(engine):
    """All but the lowest plank are let go at once; six of seven keep their pose until the tower strikes the ground.

    It turns by 20 degrees at least: planks that fell straight down one by one would not turn.
    """
    fall = watch_fall(engine, "equilibrium")
    assert fall.woken == 7
    assert fall.kept.sum() >= 6
    assert fall.tilt > 0.35
