"""Joined bricks in scenes with known answers: a load that is carried parts in time, a brick's own weight too late."""

import pytest

from adapters import open_engine
from bench.studies.policies import BENCH_POLICIES
from bench.trial.playback import Playback
from scenarios.model import Scene
from scenarios.registry import build
from tests.bench.trial.moulds import mould


def played(scene: Scene, engine: str, policy: str) -> tuple[Playback, str]:
    """Return the playback of a scene, profile ``tuned``, and its status."""
    steering = policy if BENCH_POLICIES[policy].is_steered else None
    simulation = open_engine(engine, "tuned", world=scene.world, expected=scene.bricks)
    try:
        playback = Playback(scene, simulation, steering, 600.0, lambda _: None)
        return playback, playback.run()
    finally:
        simulation.close()


@pytest.mark.parametrize(("policy", "level"), [("weld", 9), ("weld_own", 10)])
def test_the_leaning_tower_falls_in_time_only_with_the_load_that_it_carries(policy, level) -> None:
    """By moments the tower falls at 9. With its lowest plank joined on, it tips about that plank's edge, one later."""
    playback, status = played(build("leaning_tower", levels=10), "mujoco", policy)
    assert status == "collapsed"
    assert playback.monitor.collapse is not None
    assert playback.monitor.collapse.level == level
    assert sum(row.joined or 0 for row in playback.rows) >= 7, "all planks up to the fall were joined"


@pytest.mark.parametrize(("margin", "status"), [(0.3, "completed"), (-0.3, "collapsed")])
def test_a_joined_cantilever_stands_up_to_its_limit(margin, status) -> None:
    assert played(build("cantilever", margin=margin), "mujoco", "weld")[1] == status


def test_an_engine_without_joints_says_so() -> None:
    scene = build("leaning_tower", levels=2)
    simulation = open_engine("pymunk", "game", world=scene.world)
    try:
        with pytest.raises(NotImplementedError, match="pymunk: the adapter joins no bodies"):
            Playback(scene, simulation, "weld", 600.0, lambda _: None)
    finally:
        simulation.close()


@pytest.mark.slow
@pytest.mark.parametrize("policy", ["weld", "weld_own"])
def test_joints_keep_the_shape_of_a_mould(policy) -> None:
    """Measured: alone half of the bricks stay, joined four fifths; 0.2 is twice the binomial spread of 30 bricks."""
    assert mould("mujoco", policy).kept >= mould("mujoco", "none").kept + 0.2


@pytest.mark.slow
@pytest.mark.parametrize("engine", ["bullet", "mujoco", "physx", "rapier", "box3d"])
def test_a_strike_parts_joints_near_the_struck_brick_only(engine) -> None:
    """Measured: a strike parts at most a third of the joints and moves at most 3 of 30 bricks; others stay joined."""
    struck = mould(engine, "weld")
    assert struck.parted <= struck.joints / 2
    assert struck.moved <= 5
