"""An extension on a DART world that a user owns."""

from __future__ import annotations

import numpy as np
import pytest

from stability_core import check_port
from stability_core.ports import attach
from tests.stability_core.ports.dart_world import (
    FRAME_S,
    HEIGHT,
    STEP_S,
    STEPS,
    add,
    arm,
    dartpy,
    fixed,
    frozen,
    open_world,
    place,
    plane,
    run,
    step,
    tower,
)

KINDS = ["box", "cylinder", "offset"]
SINK = 1e-3
"""Depth [m] by which DART, as shipped, lets a landing body sink in its support."""


def test_the_port_keeps_the_promises_of_a_port() -> None:
    from stability_core.ports.dart import open_port

    world = open_world(ground=plane())
    world.setCollisionDetector(dartpy.simulation.CollisionDetectorType.BULLET)  # which collides planes
    tower(world, 2)
    port = open_port(world, None)

    def play() -> None:
        world.step()
        port.begin_update(STEP_S)

    assert "stayed frozen for 10 frames without moving" in check_port(port, play)[-1]


@pytest.mark.parametrize("kind", KINDS)
def test_a_prebuilt_tower_freezes_before_its_first_step_and_does_not_move(kind: str) -> None:
    world = open_world()
    skeletons = tower(world, 4, kind)
    with attach(world) as extension:
        extension.adopt()
        assert frozen(extension) == skeletons, [extension.why(each) for each in skeletons]
        before = [each.getPositions() for each in skeletons]
        run(world, extension, 0.5)
        assert np.array_equal(before, [each.getPositions() for each in skeletons])


@pytest.mark.parametrize("kind", ["box", "offset"])
def test_bodies_that_come_one_by_one_freeze_where_they_land(kind: str) -> None:
    world = open_world()
    with attach(world) as extension:
        for level in range(3):
            body = add(world, (0.0, 0.0, (level + 0.5) * HEIGHT + 5e-4), kind)
            run(world, extension, 1.5)
            assert body in frozen(extension), extension.why(body)


def test_an_overhang_beyond_the_edge_stays_live_and_falls() -> None:
    """The centre of the upper box lies 1 cm outside its support."""
    world = open_world()
    add(world, (0.0, 0.0, HEIGHT / 2))
    upper = add(world, (0.06, 0.0, 1.5 * HEIGHT))
    with attach(world) as extension:
        extension.adopt()
        run(world, extension, 1.0)
        assert place(upper)[2] < HEIGHT


@pytest.mark.parametrize("is_announced", [True, False])
def test_removing_a_support_wakes_what_rests_on_it(is_announced: bool) -> None:
    """DART's list of contacts refers to freed memory once a skeleton is removed."""
    world = open_world()
    lower, upper = tower(world, 2)
    with attach(world) as extension:
        extension.adopt()
        if is_announced:
            extension.remove([lower])
        world.removeSkeleton(lower)
        del lower
        run(world, extension, 1.0)
        assert place(upper)[2] == pytest.approx(HEIGHT / 2, abs=SINK)


def test_a_live_body_that_is_removed_after_a_step() -> None:
    world = open_world()
    with attach(world) as extension:
        for _ in range(20):
            bodies = [add(world, (x, 0.0, HEIGHT / 2)) for x in (0.0, 0.3)]
            run(world, extension, FRAME_S)
            step(world)
            world.removeSkeleton(bodies.pop(0))
            extension.update(FRAME_S)
            world.removeSkeleton(bodies.pop())
        run(world, extension, FRAME_S)
        assert not len(extension.frozen)


def test_a_tower_that_dart_has_put_to_sleep_freezes_and_falls_without_its_support() -> None:
    world = open_world()
    lower, upper = tower(world, 2)
    step(world, 1.0)
    assert world.getDeactivationOptions().mEnabled
    assert not upper.getVelocities().any()
    with attach(world) as extension:
        run(world, extension, 1.0)
        assert frozen(extension) == [lower, upper]
        world.removeSkeleton(lower)
        run(world, extension, 1.0)
        assert place(upper)[2] == pytest.approx(HEIGHT / 2, abs=SINK)


def test_a_platform_that_the_user_lowers_takes_its_load_along() -> None:
    """The platform is immobile, and the user sets its positions."""
    world = open_world()
    platform = add(world, (0.0, 0.0, 0.5))
    platform.setMobile(False)
    body = add(world, (0.0, 0.0, 0.5 + HEIGHT))
    with attach(world) as extension:
        extension.adopt()
        assert frozen(extension) == [body]
        for frame in range(100):
            platform.setPositions([0.0, 0.0, 0.0, 0.0, 0.0, 0.5 - frame * 5e-4])
            run(world, extension, FRAME_S)
        assert place(body)[2] == pytest.approx(0.5 - 99 * 5e-4 + HEIGHT, abs=2e-3)


def test_a_platform_that_turns_in_place_wakes_its_load() -> None:
    world = open_world()
    platform = fixed("platform", (0.0, 0.0, 0.5), (0.2, 0.2, 0.06))
    world.addSkeleton(platform)
    body = add(world, (0.0, 0.0, 0.5 + HEIGHT))
    with attach(world) as extension:
        extension.adopt()
        assert frozen(extension) == [body]
        tilted = dartpy.math.Isometry3()
        tilted.set_translation([0.0, 0.0, 0.5])
        c, s = np.cos(0.8), np.sin(0.8)  # steeper than the friction 0.8 holds
        tilted.set_rotation(np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]]))
        platform.getJoint(0).setTransformFromParentBodyNode(tilted)
        run(world, extension, 1.0)
        assert place(body)[2] < 0.4


def test_an_immobile_pusher_moves_a_frozen_body() -> None:
    """DART lists no contact of two immobile skeletons, so that the pusher would go through the body."""
    world = open_world()
    body, pusher = add(world, (0.0, 0.0, HEIGHT / 2)), add(world, (-0.2, 0.0, HEIGHT / 2 + 0.01))
    pusher.setMobile(False)
    with attach(world) as extension:
        extension.adopt()
        assert frozen(extension) == [body]
        for count in range(800):
            pusher.setPositions([0.0, 0.0, 0.0, -0.2 + 2e-4 * count, 0.0, HEIGHT / 2 + 0.01])
            pusher.setVelocities([0.0, 0.0, 0.0, 0.2, 0.0, 0.0])
            world.step()
            if count % STEPS == 0:
                extension.update(FRAME_S)
        assert place(body)[0] == pytest.approx(-0.2 + 2e-4 * 799 + 0.1, abs=2e-3)


def test_a_pusher_with_an_actuator_moves_a_frozen_body() -> None:
    world = open_world()
    body, pusher = add(world, (0.0, 0.0, HEIGHT / 2)), add(world, (-0.15, 0.0, HEIGHT / 2 + 0.01))
    pusher.getJoint(0).setActuatorType(dartpy.dynamics.ActuatorType.VELOCITY)
    with attach(world) as extension:
        extension.adopt()
        assert frozen(extension) == [body]
        for count in range(1000):
            pusher.setCommands([0.0, 0.0, 0.0, 0.2, 0.0, 0.0])
            world.step()
            if count % STEPS == 0:
                extension.update(FRAME_S)
        assert place(body)[0] > 0.1


def test_an_arm_pushes_a_frozen_body_aside() -> None:
    """A motor swings the tip of the arm down from the right, to 3 cm above the ground, through the place of the box."""
    world = open_world()
    robot = arm(world, (0.0, 0.0, 0.4))
    robot.setPositions([-1.2])
    body = add(world, (0.05, 0.0, HEIGHT / 2))
    with attach(world) as extension:
        extension.adopt()
        assert frozen(extension) == [body]
        for count in range(1000):
            robot.setForces([10.0])
            world.step()
            if count % STEPS == 0:
                extension.update(FRAME_S)
    assert place(body)[0] < 0.0


def test_gravity_along_y_is_followed() -> None:
    """The box stands on a wall: down is where the world says."""
    world = open_world((0.0, -9.81, 0.0))
    world.addSkeleton(fixed("wall", (0.0, 1.0, 5.0), (0.1, 0.1, 0.1)))
    body = add(world, (0.0, 1.1, 5.0))
    with attach(world) as extension:
        assert extension.gravity == (0.0, -9.81, 0.0)
        extension.adopt()
        assert frozen(extension) == [body]


def test_close_returns_every_body() -> None:
    world = open_world()
    (body,) = tower(world, 1)
    extension = attach(world)
    extension.adopt()
    assert not body.isMobile()
    extension.close()
    assert body.isMobile()
    assert not body.getVelocities().any()


def test_bodies_that_are_not_listed_are_left_alone() -> None:
    world = open_world()
    first, second = (add(world, (x, 0.0, HEIGHT / 2)) for x in (0.0, 1.0))
    with attach(world, bodies=[first]) as extension:
        extension.adopt()
        run(world, extension, 1.0)
        assert frozen(extension) == [first]
        extension.add([second])
        run(world, extension, 1.0)
        assert frozen(extension) == [first, second]
        extension.remove([first])
        assert first.isMobile()
        assert not second.isMobile()


def trajectory(*, attached: bool) -> np.ndarray:
    """Positions and velocities of a swinging arm that strikes a box, a driven body, and falling boxes."""
    world = open_world()
    robot = arm(world, (0.0, 0.0, 0.4))
    robot.setPositions([-1.2])
    driven = add(world, (2.0, 0.0, 0.5))
    driven.getJoint(0).setActuatorType(dartpy.dynamics.ActuatorType.VELOCITY)
    bodies = [robot, driven, add(world, (0.0, 0.0, 0.3)), add(world, (0.05, 0.0, 1.0)), add(world, (2.0, 0.0, 0.8))]
    extension = attach(world) if attached else None
    rows = []
    for _ in range(40):
        for _ in range(STEPS):
            robot.setForces([0.3])
            driven.setCommands([0.0, 0.0, 1.0, 0.1, 0.0, 0.0])
            world.step()
        if extension:
            extension.update(FRAME_S)
            assert not len(extension.frozen)
        rows.append([value for body in bodies for value in (*body.getPositions(), *body.getVelocities())])
    if extension:
        extension.close()
    return np.array(rows)


def test_joints_and_motors_keep_their_trajectories_to_the_bit_while_nothing_is_frozen() -> None:
    np.testing.assert_array_equal(trajectory(attached=True), trajectory(attached=False))


def test_finding_contacts_changes_no_trajectory_by_a_bit() -> None:
    def last(*, finds: bool) -> list[np.ndarray]:
        from stability_core.ports.dart import open_port

        world = open_world()
        bodies = [add(world, (0.005 * level, 0.0, (level + 0.5) * HEIGHT)) for level in range(3)]
        port = open_port(world, None)
        for _ in range(60):
            if finds:
                port.find_contacts()
                assert len(port.contacts())
            world.step()
        return [body.getPositions() for body in bodies]

    assert np.array_equal(last(finds=True), last(finds=False))
