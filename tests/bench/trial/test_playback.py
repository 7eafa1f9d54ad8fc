"""Playing a scene: where and when bricks are placed, and the record of each way to end."""

import math

import numpy as np
import pytest

from bench.trial.builder import Builder
from bench.trial.playback import Playback
from bench.trial.sleep_stats import SleepStats
from bench.trial.timed_port import TimedPort
from scenarios.model import CLEARANCE, Action, Brick, Expectation, Place, Pull, Push, Remove, Scene, World
from scenarios.planks import LENGTH, THICKNESS, box, lay
from scenarios.registry import build


def scene_of(*actions: Action, fixed: tuple[Brick, ...] = ()) -> Scene:
    world = World(fixed=fixed)
    return Scene("test", "test", {}, world, actions, Expectation("stand", ""), "", watch_s=2.0)


def play(scene: Scene, simulation, wall_limit_s: float = math.inf) -> Playback:
    return Playback(scene, simulation, None, wall_limit_s, lambda _: None)


def test_a_brick_is_let_go_a_clearance_above_its_actual_support(fake_engine) -> None:
    """The lower plank has sunk by 1 mm; the upper one is let go 0.5 mm above where it really lies."""
    simulation = fake_engine()
    builder = Builder(scene_of(Place(0, (lay(0, level=1),)), Place(1, (lay(0, level=2),))), simulation)
    builder.act(0.0)
    assert simulation.pose[0][0][2] == pytest.approx(THICKNESS / 2 + CLEARANCE)
    simulation.move(0, (0, 0, THICKNESS / 2 - 1e-3), (1, 0, 0, 0))
    builder.act(1.0)
    assert simulation.pose[1][0][2] == pytest.approx(1.5 * THICKNESS - 1e-3 + CLEARANCE)


def test_a_neighbour_of_the_same_level_is_no_support(fake_engine) -> None:
    simulation = fake_engine()
    builder = Builder(scene_of(Place(0, (lay(0, level=1),)), Place(1, (lay(0.116, level=1),))), simulation)
    builder.act(0.0)
    builder.act(1.0)
    assert simulation.pose[1][0][2] == pytest.approx(THICKNESS / 2 + CLEARANCE)


def test_a_brick_is_let_go_above_a_fixed_box_beside_a_wall_and_under_a_ceiling(fake_engine) -> None:
    table = box((0.3, 0.1, 0.05), 0.0, level=1)
    wall = box((0.02, 0.1, 0.2), LENGTH / 2 + 0.01, level=1)
    ceiling = box((0.1, 0.1, 0.02), -0.02, level=1, bottom=0.05 + THICKNESS)
    simulation = fake_engine()
    scene = scene_of(Place(0, (lay(0.0, level=1, bottom=0.05),)), fixed=(table, wall, ceiling))
    Builder(scene, simulation).act(0.0)
    assert simulation.pose[0][0][2] == pytest.approx(0.05 + THICKNESS / 2 + CLEARANCE)


def test_a_neighbour_of_a_lower_level_is_no_support(fake_engine) -> None:
    """A block that is planned flush with a plank's end, and that has moved into its place by 20 um."""
    block = box((0.05, 0.05, 0.1), LENGTH / 2 + 0.025, level=1)
    simulation = fake_engine()
    builder = Builder(scene_of(Place(0, (block,)), Place(1, (lay(0.0, level=2),))), simulation)
    builder.act(0.0)
    simulation.move(0, (LENGTH / 2 + 0.025 - 2e-5, 0, 0.05), (1, 0, 0, 0))
    builder.act(1.0)
    assert simulation.pose[1][0][2] == pytest.approx(THICKNESS / 2 + CLEARANCE)


def test_a_level_is_placed_when_all_its_bricks_are(fake_engine) -> None:
    left, right = lay(-0.06, level=1), lay(0.06, level=1)
    builder = Builder(scene_of(Place(0, (left,)), Place(1, (right,)), Place(2, (lay(0, level=2),))), fake_engine())
    builder.act(0.0)
    assert (builder.placed, builder.level) == ({}, 1)
    builder.act(1.0)
    assert builder.placed == {1: 1.0}
    builder.act(2.0)
    assert builder.placed == {1: 1.0, 2: 2.0}
    assert builder.is_done


def test_bricks_are_removed_and_pushed_by_their_order_of_placement(fake_engine) -> None:
    simulation = fake_engine()
    bricks = (lay(0, level=1), lay(0.2, level=1), lay(0.4, level=1))
    builder = Builder(scene_of(Place(0, bricks), Remove(1, 0), Push(2, 2, (1, 0, 0))), simulation)
    for time in (0.0, 1.0, 2.0):
        builder.act(time)
    assert sorted(simulation.pose) == [1, 2]
    assert simulation.pushed == [2]
    assert builder.plan.position[:, 0] == pytest.approx([0.2, 0.4])


def test_a_stack_that_stays_is_completed_and_still(fake_engine) -> None:
    scene = build("plank_tower", levels=3)
    run = play(scene, fake_engine())
    assert run.run() == "completed"
    assert run.simulated_s == pytest.approx(2.0 + scene.watch_s)
    assert run.monitor.standing is not None
    assert run.monitor.standing.level == 3
    assert run.monitor.creep is not None
    assert run.monitor.creep.speed_m_s == 0.0
    assert sorted(run.at_level) == [1, 2, 3]
    assert [len(run.frames_of(level)) for level in (1, 2, 3)] == [60, 60, 60]  # each brick's second, no more


def test_a_trial_ends_a_second_after_its_collapse_and_places_no_more(fake_engine) -> None:
    def topple(simulation, step: int) -> None:
        if step == 90:
            simulation.move(1, (0, 0, 0.01), (math.cos(0.5), math.sin(0.5), 0, 0))

    simulation = fake_engine(topple)
    run = play(build("plank_tower", levels=5), simulation)
    assert run.run() == "collapsed"
    assert run.monitor.collapse is not None
    assert (run.monitor.collapse.level, run.monitor.collapse.kind) == (2, "topple")
    assert simulation.steps == 90 + 60
    assert len(simulation.bricks) == 2


def test_poses_that_are_not_finite_are_an_outcome(fake_engine) -> None:
    def diverge(simulation, step: int) -> None:
        if step == 30:
            simulation.pose[0] = (math.nan, 0, 0), (1, 0, 0, 0)

    run = play(build("plank_tower", levels=2), fake_engine(diverge))
    assert run.run() == "diverged"
    assert run.simulated_s == pytest.approx(0.5)


def test_the_wall_limit_stops_a_trial(fake_engine) -> None:
    assert play(build("plank_tower"), fake_engine(), wall_limit_s=0.0).run() == "timeout"


@pytest.mark.parametrize("frame", [30, 180])
def test_one_long_step_that_ends_after_the_limit_is_a_timeout(monkeypatch, fake_engine, frame: int) -> None:
    """Also where it is the last one: 1 s of building and 2 s of watching make 180 frames."""
    clock = [0.0]
    monkeypatch.setattr("bench.trial.playback.perf_counter", lambda: clock[0])

    def take_long(simulation, step: int) -> None:
        clock[0] += 61.0 if step == frame else 0.0

    run = play(scene_of(Place(0, (lay(0, level=1),)), Place(1, (lay(0, level=2),))), fake_engine(take_long), 60.0)
    assert run.run() == "timeout"
    assert len(run.rows) == frame


def test_the_engine_alone_is_never_asked_for_its_port(fake_engine) -> None:
    simulation = fake_engine()
    play(build("plank_tower", levels=1), simulation).run()
    assert not simulation.is_observed


def test_the_pose_hash_differs_between_different_runs(fake_engine) -> None:
    def nudge(simulation, step: int) -> None:
        if step == 10:
            (x, y, z), q = simulation.pose[0]
            simulation.pose[0] = (np.nextafter(x, 1), y, z), q

    hashes = []
    for on_step in (lambda *_: None, lambda *_: None, nudge):
        run = play(build("plank_tower", levels=1), fake_engine(on_step))
        run.run()
        hashes.append(run.pose_hash)
    assert hashes[0] == hashes[1] != hashes[2]


def test_the_timed_port_splits_reading_from_steering(fake_engine) -> None:
    ticks = iter(range(100))
    simulation = fake_engine()
    body = simulation.spawn(lay(0, level=1))
    port = TimedPort(simulation.port, clock=lambda: float(next(ticks)))
    port.contacts()
    port.masses()
    port.sleep([body])
    assert (port.readback_s, port.steering_s) == (2.0, 1.0)
    port.reset()
    assert (port.readback_s, port.steering_s) == (0.0, 0.0)


def test_sleepers_count_wakes_refreezes_and_the_longest_live_time() -> None:
    stats = SleepStats()
    stats.see(0.0, 1.0, [0, 1], frozen=[0], woken=[])
    stats.see(1.0, 2.0, [0, 1], frozen=[1], woken=[0])
    stats.see(2.0, 3.5, [0, 1], frozen=[0], woken=[])
    assert (stats.wakes, stats.refreezes) == (1, 1)
    assert stats.longest_live_s(9.0) == 2.0  # body 1, from 0 to 2 s; body 0 later for 1.5 s


def test_watching_begins_when_a_pull_is_over(fake_engine) -> None:
    """Creep is that of the remaining bricks: during the pull there is one more."""
    bricks = (lay(0, level=1), lay(0.2, level=1))
    run = play(scene_of(Place(0.0, bricks), Pull(0.5, 0, (0.05, 0.0), 3.0)), fake_engine())
    assert run.run() == "completed"
    assert run.simulated_s == pytest.approx(0.5 + 3.0 + 2.0)
    assert run.monitor.creep is not None
    assert run.monitor.creep.speed_m_s == 0.0


def test_a_poured_brick_has_no_place_to_leave(fake_engine) -> None:
    """Bricks that roll ten centimetres away are no collapse; the pile is watched to the end."""

    def roll(simulation, step: int) -> None:
        if step == 120:
            for body, ((x, y, z), q) in list(simulation.pose.items()):
                simulation.pose[body] = (x + 0.1, y, z), q

    run = play(build("poured_pile", bricks=3), fake_engine(roll))
    assert run.run() == "completed"
    assert run.monitor.standing is not None
    assert run.monitor.standing.level == 3
    assert run.simulated_s == pytest.approx(0.5 + 10.0)
