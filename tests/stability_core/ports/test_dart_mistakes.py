"""Mistakes of a DART user: each ends in a message that names the fix, or is put right without one."""

from __future__ import annotations

import numpy as np
import pytest

from stability_core.ports import attach
from stability_core.ports.shared.free_flight import FRAMES
from tests.stability_core.ports.dart_world import (
    FRAME_S,
    HEIGHT,
    STEP_S,
    add,
    arm,
    dartpy,
    frozen,
    open_world,
    place,
    run,
    step,
)


@pytest.mark.parametrize(("factor", "times"), [(4, "times its velocity times dt"), (0, "moved 0 times its velocity")])
def test_more_steps_or_none_between_two_updates(factor: int, times: str) -> None:
    world = open_world()
    add(world, (0.0, 0.0, 20.0)).setVelocities([0.0, 0.0, 0.0, 0.0, 0.0, -3.0])

    def play() -> None:
        for _ in range(FRAMES + 3):
            step(world, factor * FRAME_S)
            extension.update(FRAME_S)

    with attach(world) as extension, pytest.raises(ValueError, match=f"{times}.*pass the time of all steps"):
        play()


def test_a_time_that_is_no_number_of_steps() -> None:
    world = open_world()
    world.setTimeStep(0.01)
    with attach(world) as extension, pytest.raises(ValueError, match=r"not a whole number.*world.setTimeStep\(\)"):
        extension.update(1 / 60)


def test_no_gravity() -> None:
    with pytest.raises(ValueError, match=r"this DART world has no gravity.*before attach"):
        attach(open_world((0.0, 0.0, 0.0)))


def test_a_skeleton_instead_of_a_world() -> None:
    with pytest.raises(TypeError, match=r"needs a dartpy.simulation.World, got Skeleton: pass the world"):
        attach(add(open_world(), (0.0, 0.0, 1.0)))


def test_numbers_instead_of_skeletons() -> None:
    with pytest.raises(TypeError, match=r"needs a skeleton or a body node, got int: pass a skeleton"):
        attach(open_world(), bodies=[3])


def test_two_attachments() -> None:
    world = open_world()
    with attach(world), pytest.raises(RuntimeError, match=r"already has an extension.*close\(\)"):
        attach(world)
    attach(world).close()


def test_a_skeleton_that_is_not_in_the_world() -> None:
    with pytest.raises(KeyError, match=r"not in this DART world: call world.addSkeleton\(\) first"):
        attach(open_world(), bodies=[add(open_world(), (0.0, 0.0, 1.0))])


def test_a_robot() -> None:
    world = open_world()
    robot = arm(world)
    with pytest.raises(ValueError, match=r"'arm' has 2 bodies: list free bodies only"):
        attach(world, bodies=[robot])
    with pytest.raises(ValueError, match=r"'arm'\) has joints: list free bodies only"):
        attach(world, bodies=[robot.getBodyNode(1)])


def test_the_ground() -> None:
    world = open_world()
    with pytest.raises(ValueError, match=r"'ground'\) is fixed to the world.*list free bodies only"):
        attach(world, bodies=[world.getSkeleton(0)])


def test_an_immobile_skeleton() -> None:
    world = open_world()
    body = add(world, (0.0, 0.0, 1.0))
    body.setMobile(False)
    with pytest.raises(ValueError, match=r"is immobile.*call setMobile\(True\)"):
        attach(world, bodies=[body])


def test_a_body_that_an_actuator_drives() -> None:
    world = open_world()
    body = add(world, (0.0, 0.0, 1.0))
    body.getJoint(0).setActuatorType(dartpy.dynamics.ActuatorType.VELOCITY)
    with pytest.raises(ValueError, match=r"actuator.*ActuatorType.FORCE"):
        attach(world, bodies=[body])


def test_a_body_without_gravity_of_its_own() -> None:
    world = open_world()
    body = add(world, (0.0, 0.0, 1.0))
    body.getBodyNode(0).setGravityMode(False)
    with pytest.raises(ValueError, match=r"has no gravity.*setGravityMode\(True\)"):
        attach(world, bodies=[body])


def test_a_body_listed_twice() -> None:
    world = open_world()
    body = add(world, (0.0, 0.0, 1.0))
    with pytest.raises(ValueError, match=r"controls .* already: list each body once"):
        attach(world, bodies=[body, body])


def test_constraints_between_skeletons() -> None:
    """DART does not say which bodies a constraint joins. The free ones may still be listed."""
    world = open_world()
    free, *pair = (add(world, (x, 0.0, HEIGHT / 2)) for x in (0.0, 1.0, 1.2))
    joined = [body.getBodyNode(0) for body in pair]
    constraint = dartpy.constraint.BallJointConstraint(*joined, [1.1, 0.0, HEIGHT / 2])
    world.getConstraintSolver().addConstraint(constraint)
    with pytest.raises(
        ValueError, match=r"has constraints between bodies \(count 1\).*attach\(world, bodies=\[...\]\)"
    ):
        attach(world)
    with attach(world, bodies=[free]) as extension:
        extension.adopt()
        assert frozen(extension) == [free]


def test_a_constraint_that_comes_later() -> None:
    world = open_world()
    pair = [add(world, (x, 0.0, HEIGHT / 2)).getBodyNode(0) for x in (1.0, 1.2)]
    constraint = dartpy.constraint.WeldJointConstraint(*pair)
    with attach(world) as extension:
        world.getConstraintSolver().addConstraint(constraint)
        world.step()
        with pytest.raises(ValueError, match=r"constraints between bodies"):
            extension.update(STEP_S)


def test_an_actuator_that_is_set_later_frees_its_body() -> None:
    """The port checks a live body in each frame, in turn."""
    world = open_world()
    body = add(world, (0.0, 0.0, 0.5))
    with attach(world) as extension:
        run(world, extension, 0.05)
        body.getJoint(0).setActuatorType(dartpy.dynamics.ActuatorType.VELOCITY)
        run(world, extension, 1.0)
        assert not len(extension.frozen)
        assert body.isMobile()


def test_a_pose_that_is_not_finite() -> None:
    world = open_world()
    body = add(world, (0.0, 0.0, 1.0))
    with attach(world) as extension:
        body.setVelocities([0.0, 0.0, 0.0, np.nan, 0.0, 0.0])
        with pytest.raises(
            ValueError, match=r"not finite, because the simulation has diverged or .*: use a smaller step"
        ):
            extension.update(STEP_S)


def test_use_after_close() -> None:
    world = open_world()
    body = add(world, (0.0, 0.0, 1.0))
    extension = attach(world)
    extension.close()
    for use in (lambda: extension.update(STEP_S), extension.adopt, lambda: extension.add([body])):
        with pytest.raises(RuntimeError, match="closed: create a new"):
            use()


def test_an_unknown_body() -> None:
    with attach(open_world()) as extension:
        with pytest.raises(KeyError, match=r"not in this DART world: call world.addSkeleton"):
            extension.why(add(open_world(), (0.0, 0.0, 1.0)))
        with pytest.raises(KeyError, match=r"no body of this DART world has the id 7"):
            extension.body_of(7)


def test_a_body_that_comes_after_the_latest_update() -> None:
    world = open_world()
    with attach(world) as extension:
        body = add(world, (0.0, 0.0, HEIGHT / 2))
        extension.adopt([body])
        assert frozen(extension) == [body]


def test_a_frozen_body_that_is_moved_without_a_word() -> None:
    """It lands at 0.6 m/s, and DART lets it sink by the way of a step, 0.6 mm."""
    world = open_world()
    body = add(world, (0.0, 0.0, HEIGHT / 2))
    with attach(world) as extension:
        extension.adopt()
        body.setPositions([0.0, 0.0, 0.0, 0.5, 0.0, HEIGHT / 2 + 0.02])
        run(world, extension, 1.0)
        assert place(body) == pytest.approx((0.5, 0.0, HEIGHT / 2), abs=1e-3)


def test_a_world_that_is_emptied_first() -> None:
    world = open_world()
    body = add(world, (0.0, 0.0, HEIGHT / 2))
    extension = attach(world)
    extension.adopt()
    world.removeAllSkeletons()
    extension.close()
    assert body.isMobile()
