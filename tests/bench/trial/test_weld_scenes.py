"""Joined bricks in scenes with known answers: a load that is carried parts in time, a brick's own weight too late."""

from functools import cache

import numpy as np
import pytest

from adapters import open_engine
from bench.studies.policies import BENCH_POLICIES
from bench.trial.playback import Playback
from scenarios.model import Remove, Scene
from scenarios.registry import build


def played(scene: Scene, engine: str, policy: str, on_frame=None) -> tuple[Playback, str]:
    """Return the playback of a scene, profile ``tuned``, and its status."""
    steering = policy if BENCH_POLICIES[policy].is_steered else None
    simulation = open_engine(engine, "tuned", world=scene.world, expected=scene.bricks)
    try:
        playback = Playback(scene, simulation, steering, 600.0, lambda _: None, on_frame=on_frame)
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


@cache
def kept_without_walls(policy: str) -> float:
    """Return the share of 30 poured bricks that move less than a thickness in 5 s after the walls are removed."""
    scene = build("mould", bricks=30)
    removed_s = next(action.time for action in scene.actions if isinstance(action, Remove))
    seen: list[tuple[float, dict[int, np.ndarray]]] = []

    def note(now, bodies, position, *_) -> None:
        seen.append((now, dict(zip(bodies.tolist(), position, strict=True))))

    played(scene, "mujoco", policy, note)
    before, after = (min(seen, key=lambda frame: abs(frame[0] - time))[1] for time in (removed_s, removed_s + 5.0))
    thickness = min(scene.bricks[-1].size)
    poured = [body for body in after if body >= 4]  # the walls have the first four ids
    return float(np.mean([np.linalg.norm(after[body] - before[body]) < thickness for body in poured]))


@pytest.mark.slow
@pytest.mark.parametrize("policy", ["weld", "weld_own"])
def test_joints_keep_the_shape_of_a_mould(policy) -> None:
    """Measured: alone half of the bricks stay, joined four fifths; 0.2 is twice the binomial spread of 30 bricks."""
    assert kept_without_walls(policy) >= kept_without_walls("none") + 0.2
