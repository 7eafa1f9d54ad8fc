"""A user acts on bricks at rest: the listener's calls, and the motion of the brick."""

import math
from dataclasses import replace

import numpy as np
import pytest

from bench.trial.builder import HOLD_S, Builder
from bench.trial.playback import Playback
from scenarios.model import CLEARANCE, Drive, Expectation, Place, Press, Pull, Push, Scene, Tilt, World
from scenarios.planks import LENGTH, THICKNESS, WIDTH, lay
from scenarios.registry import build

FRAME_S = 1 / 60


class Recorder:
    """Records the calls that an extension would receive."""

    def __init__(self) -> None:
        self.words: list[tuple[str, object]] = []

    def disturb(self, bodies) -> None:
        self.words += [("disturb", body) for body in bodies]

    def release(self, bodies) -> None:
        self.words += [("release", body) for body in bodies]

    def turn_gravity(self, gravity) -> None:
        self.words.append(("gravity", gravity))


def scene_of(*actions) -> Scene:
    return Scene("test", "test", {}, World(), actions, Expectation("study", ""), "", watch_s=0.5)


def two_planks(*after) -> Scene:
    return scene_of(Place(0.0, (lay(0, level=1),)), Place(0.0, (lay(0, level=2),)), *after)


def test_the_extension_is_notified_of_a_blow_before_it_comes_and_after_it(fake_engine) -> None:
    """Notified in one frame, the extension unfreezes the brick at its end: a blow in the next frame finds it live."""
    simulation, listener = fake_engine(), Recorder()
    builder = Builder(two_planks(Push(1.0, 1, (1e-3, 0, 0))), simulation, listener)
    builder.act(0.0)
    builder.act(1.0 - HOLD_S - FRAME_S)
    assert listener.words == []
    builder.act(1.0 - 2 * FRAME_S)
    builder.act(1.0 - FRAME_S)
    assert (listener.words, simulation.pushed) == ([("disturb", 1)], [])
    builder.act(1.0)
    assert (listener.words, simulation.pushed) == ([("disturb", 1), ("release", 1)], [1])


def test_a_pulled_brick_is_in_place_wherever_the_hand_has_it_and_leaves_the_world_at_the_end(fake_engine) -> None:
    simulation = fake_engine()
    builder = Builder(two_planks(Pull(1.0, 0, (0.1, 0.0), 0.5)), simulation, Recorder())
    builder.act(0.0)
    builder.act(1.0)
    simulation.move(0, (0.04, 0.0, THICKNESS / 2), (1.0, 0.0, 0.0, 0.0))
    builder.act(1.0 + FRAME_S)
    assert builder.plan.position[0, 0] == pytest.approx(0.04)
    assert simulation.pushed, "it is pulled in every frame"
    assert not builder.is_done
    builder.act(1.5)
    assert list(simulation.bricks) == [1]
    assert builder.is_done


def test_a_brick_may_be_dropped_from_a_height(fake_engine) -> None:
    simulation = fake_engine()
    builder = Builder(scene_of(Place(0.0, (lay(0, level=1),), 0.05)), simulation)
    builder.act(0.0)
    assert simulation.pose[0][0][2] == pytest.approx(THICKNESS / 2 + 0.05)
    assert Place(0.0, ()).height == CLEARANCE


def test_a_pull_overcomes_friction_and_keeps_its_speed() -> None:
    """Alone on the ground, against mu = 0.45: after half a second to find its force, within 20 %."""
    pytest.importorskip("mujoco")
    from adapters import open_engine

    scene = scene_of(Place(0.0, (lay(0, level=1),)), Pull(1.0, 0, (0.2, 0.0), 1.0))
    simulation = open_engine("mujoco", "game", world=scene.world, sleeping="off", expected=scene.bricks)
    builder, at = Builder(scene, simulation), []
    for frame in range(119):
        builder.act(frame * FRAME_S)
        simulation.step(FRAME_S)
        at.append(float(simulation.poses()[1][0, 0]))
    assert (at[-1] - at[89]) / (29 * FRAME_S) == pytest.approx(0.2, rel=0.2)


@pytest.mark.parametrize(("is_carried", "least", "most"), [(True, 0.0, 0.5), (False, 5.0, 90.0)])
def test_a_plank_drawn_out_of_a_tower_tips_unless_the_hand_carries_its_weight(is_carried, least, most) -> None:
    """With 10 mm of the plank inside, its inner end lifts what lies on it with 4.8 times the plank's weight.

    The plank above the inner end gives way to its own weight, so that the pulled plank tips by degrees.
    """
    pytest.importorskip("pybullet")
    from adapters import open_engine

    scene = build("jenga", levels=3, speed=0.1)
    first = next(action for action in scene.actions if isinstance(action, Pull))
    scene = scene_of(*scene.actions[:3], replace(first, is_carried=is_carried))
    simulation = open_engine("bullet", "tuned", world=scene.world, sleeping="off", expected=scene.bricks)
    builder, frame, tilts = Builder(scene, simulation), 0, [0.0]
    while not builder.is_done:
        builder.act(frame * FRAME_S)
        simulation.step(FRAME_S)
        frame += 1
        bodies, position, quaternion = simulation.poses()
        if first.brick in bodies and position[first.brick, 1] < (LENGTH + 3 * WIDTH) / 2 - 0.01:
            _, x, y, _ = quaternion[first.brick]
            tilts.append(math.degrees(2 * math.asin(math.hypot(x, y))))
    simulation.close()
    assert least <= max(tilts) <= most


@pytest.mark.parametrize(("slide", "end"), [(4.0, "completed"), (20.0, "collapsed")])
def test_a_struck_plank_slides_as_far_as_friction_lets_it(slide, end) -> None:
    """(J / m)^2 / (2 mu g), within a quarter: an engine takes friction in steps."""
    pytest.importorskip("mujoco")
    from adapters import open_engine

    scene = build("pushed_plank", slide=slide, levels=2)
    simulation = open_engine("mujoco", "game", world=scene.world, sleeping="off", expected=scene.bricks)
    play = Playback(scene, simulation, None, math.inf, lambda _: None)
    assert play.run() == end
    _, position, _ = simulation.poses()
    assert position[1, 0] == pytest.approx(slide * 1e-3, rel=0.25)
    assert abs(position[0, 0]) < 0.5e-3


def test_a_press_begins_and_ends_in_its_frames(fake_engine) -> None:
    """It is held 0.1 s before, so that the extension keeps it live, and let go in the end."""
    simulation, listener = fake_engine(), Recorder()
    scene = scene_of(Place(0, (lay(0, level=1),)), Press(1.0, 0, (0.5, 0.0, 0.0), 0.5))
    builder = Builder(scene, simulation, listener)
    forces = {}
    for frame in range(120):
        builder.act(frame / 60)
        simulation.step(1 / 60)
        forces[frame] = simulation.pressed.get(0, (0.0, 0.0, 0.0))[0]
    assert {frame for frame, force in forces.items() if force} == set(range(60, 90))
    assert listener.words == [("disturb", 0), ("release", 0)]
    assert builder.is_done


def test_a_tilt_turns_gravity_and_stops(fake_engine) -> None:
    """20 degrees a second for half a second about y: gravity leans by 10 degrees towards +x."""
    simulation, listener = fake_engine(), Recorder()
    builder = Builder(scene_of(Place(0, (lay(0, level=1),)), Tilt(1.0, (0, 1), 20.0, 0.5)), simulation, listener)
    for frame in range(120):
        builder.act(frame / 60)
    lean = math.radians(10.0)
    assert simulation.world.gravity == pytest.approx((9.81 * math.sin(lean), 0.0, -9.81 * math.cos(lean)))
    assert len(listener.words) == 31
    assert listener.words[-1] == ("gravity", simulation.world.gravity)
    assert builder.is_done


def test_a_drive_reaches_its_velocity_evenly_and_the_plan_comes_along(fake_engine) -> None:
    """From rest to 0.6 m/s in half a second: 150 mm; what a platform carries is planned as far along."""
    platform = replace(lay(0, level=1), moved=True)
    for carries in (True, False):
        simulation = fake_engine()
        after = Drive(0.5, 0, (0.6, 0.0, 0.0), seconds=0.5, carries=carries)
        stop = Drive(1.0, 0, (0.0, 0.0, 0.0))
        builder = Builder(scene_of(Place(0.0, (platform,)), Place(0.0, (lay(0, level=2),)), after, stop), simulation)
        for frame in range(90):
            builder.act(frame * FRAME_S)
            simulation.step(FRAME_S)
        assert builder.is_done
        assert builder.plan.position[:, 0] == pytest.approx([0.15, 0.15 if carries else 0.0])


def test_a_plan_turns_about_the_platform_that_carries_it(fake_engine) -> None:
    """A quarter turn about y in half a second: a plank planned 7.8 mm above the platform is planned beside it."""
    platform = replace(lay(0, level=1), moved=True)
    builder = Builder(
        scene_of(
            Place(0.0, (platform,)),
            Place(0.0, (lay(0, level=2),)),
            Drive(0.5, 0, (0.0, 0.0, 0.0), (0.0, math.pi, 0.0), carries=True),
            Drive(1.0, 0, (0.0, 0.0, 0.0), carries=True),
        ),
        fake_engine(),
    )
    for frame in range(90):
        builder.act(frame * FRAME_S)
    below, above = builder.plan.position
    assert above - below == pytest.approx([THICKNESS, 0.0, 0.0], abs=1e-9)
    half = math.sqrt(0.5)
    assert builder.plan.quaternion == pytest.approx(np.tile((half, 0.0, half, 0.0), (2, 1)))
