"""The policy `equilibrium` on real engines: what must stand stands, and what must fall falls as one."""

from __future__ import annotations

import math

import pytest

from adapters import open_engine
from bench.play import Play
from scenarios.registry import build
from tests.bench.kept_pose import ENGINES, watch_fall


@pytest.mark.parametrize("storeys", [2, 3])
def test_a_card_house_stands_on_vs_that_mujoco_skews(storeys):
    """The planks of a frozen V differ in height by some tenths of a millimetre: the roof lies on both all the same."""
    pytest.importorskip("mujoco")
    scene = build("card_house", storeys=storeys)
    simulation = open_engine("mujoco", "game", world=scene.world, sleeping="off", expected=scene.bricks)
    play = Play(scene, simulation, "equilibrium", math.inf, lambda _: None)
    assert play.run() == "completed"
    assert play.sleepers.wakes == 0


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
