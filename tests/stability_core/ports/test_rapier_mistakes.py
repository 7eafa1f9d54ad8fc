"""Mistakes of a Rapier user: each ends in a message that names the fix, or is put right without one."""

from __future__ import annotations

import numpy as np
import pytest

from stability_core.ports import attach
from stability_core.ports.shared.free_flight import FRAMES
from tests.stability_core.ports.rapier_world import (
    HEIGHT,
    STEP_S,
    add,
    arm,
    height,
    id_of,
    open_world,
    rapier3d,
    run,
    view,
)


@pytest.fixture
def world():
    return open_world()


@pytest.mark.parametrize(
    ("steps", "times"), [(4, "times its velocity times dt"), (0, "moved 0 times its velocity times dt = 0.01 s")]
)
def test_more_steps_or_none_between_two_updates(world, steps: int, times: str) -> None:
    view(world, add(world, (0.0, 0.0, 20.0))).linvel = (0.0, 0.0, -3.0)

    def play() -> None:
        for _ in range(FRAMES + 3):
            for _ in range(steps):
                world.step()
            extension.update(STEP_S)

    with attach(world) as extension, pytest.raises(ValueError, match=f"{times}.*pass the time of all steps"):
        play()


def test_several_steps_a_frame_are_no_mistake(world) -> None:
    add(world, (0.0, 0.0, 20.0))
    with attach(world) as extension:
        for _ in range(30):
            for _ in range(4):
                world.step()
            extension.update(4 * STEP_S)


def test_a_time_that_is_no_number_of_steps(world) -> None:
    with (
        attach(world) as extension,
        pytest.raises(ValueError, match=r"not a whole number.*set the step with world\.integration_parameters\.dt"),
    ):
        extension.update(1 / 60)


def test_no_gravity() -> None:
    with pytest.raises(ValueError, match=r"this Rapier world has no gravity.*before attach"):
        attach(open_world((0.0, 0.0, 0.0)))


def test_the_wrong_object_of_rapier(world) -> None:
    with pytest.raises(TypeError, match=r"needs a rapier3d.PhysicsWorld, got RigidBodySet: build the world"):
        attach(world.rigid_bodies)


def test_two_attachments(world) -> None:
    with attach(world), pytest.raises(RuntimeError, match=r"already has an extension.*close\(\)"):
        attach(world)
    attach(world).close()


def test_a_handle_instead_of_an_id(world) -> None:
    handle = add(world, (0.0, 0.0, 1.0))
    with pytest.raises(ValueError, match=r"no body RigidBodyHandle.*pass id_of\(handle\) of stability_core.ports"):
        attach(world, bodies=[handle])
    attach(world, bodies=[id_of(handle)]).close()


@pytest.mark.parametrize(
    ("motion", "reason"),
    [("fixed", "is fixed already"), ("kinematic_position_based", "is kinematic.*list dynamic bodies")],
)
def test_a_body_that_does_not_fall(world, motion: str, reason: str) -> None:
    body = id_of(add(world, (0.0, 0.0, 1.0), motion=motion))
    with pytest.raises(ValueError, match=f"body {body} {reason}"):
        attach(world, bodies=[body])


@pytest.mark.parametrize("is_multibody", [False, True])
def test_a_body_with_joints(world, is_multibody: bool) -> None:
    link = id_of(arm(world, is_multibody=is_multibody)[1])
    with pytest.raises(ValueError, match=f"body {link} has joints: list free bodies only"):
        attach(world, bodies=[link])


@pytest.mark.parametrize(
    ("attribute", "value", "fix"),
    [
        ("gravity_scale", 0.0, r"set gravity_scale = 1\.0"),
        ("enabled_rotations", (False, True, True), r"set locked_axes = rapier3d\.LockedAxes\.empty\(\)"),
        ("is_enabled", False, "set is_enabled = True"),
    ],
)
def test_a_body_with_a_setting_that_statics_does_not_know(world, attribute: str, value, fix: str) -> None:
    handle = add(world, (0.0, 0.0, 1.0))
    setattr(view(world, handle), attribute, value)
    with pytest.raises(ValueError, match=f"leave out the body, or {fix}"):
        attach(world, bodies=[id_of(handle)])


def test_a_collider_with_a_skin(world) -> None:
    handle = add(world, (0.0, 0.0, 1.0))
    (collider,) = view(world, handle).colliders
    world.colliders[collider].contact_skin = 0.01
    with pytest.raises(ValueError, match=r"skin.*set contact_skin = 0\.0"):
        attach(world, bodies=[id_of(handle)])


def test_a_body_without_mass(world) -> None:
    body = id_of(world.add_body(rapier3d.RigidBody.dynamic()))
    with pytest.raises(ValueError, match="has no mass: give its collider a density or a mass"):
        attach(world, bodies=[body])


def test_a_body_listed_twice(world) -> None:
    body = id_of(add(world, (0.0, 0.0, 1.0)))
    with pytest.raises(ValueError, match=r"controls .* already: list each body once"):
        attach(world, bodies=[body, body])


def test_a_joint_that_is_made_later_frees_its_body(world) -> None:
    """The port checks a live body in each frame, in turn."""
    handle = add(world, (0.0, 0.0, HEIGHT / 2))
    pivot = world.add_body(rapier3d.RigidBody.fixed().translation((0.0, 0.0, 0.5)))
    with attach(world) as extension:
        run(world, extension, 0.05)
        joint = rapier3d.SphericalJoint.builder().local_anchor2((0.0, 0.0, 0.47)).build()
        world.impulse_joints.insert(pivot, handle, joint)
        run(world, extension, 1.0)
        assert not len(extension.frozen)


def test_a_pose_that_is_not_finite(world) -> None:
    handle = add(world, (0.0, 0.0, 1.0))
    with attach(world) as extension:
        view(world, handle).linvel = (np.nan, 0.0, 0.0)
        world.step()
        with pytest.raises(ValueError, match=r"disabled the bodies \[0\].*diverged: use a smaller step"):
            extension.update(STEP_S)


def test_use_after_close(world) -> None:
    extension = attach(world)
    extension.close()
    for use in (lambda: extension.update(STEP_S), extension.adopt, lambda: extension.add([1])):
        with pytest.raises(RuntimeError, match="closed: create a new"):
            use()


def test_a_world_that_is_cleared_first(world) -> None:
    add(world, (0.0, 0.0, HEIGHT / 2))
    extension = attach(world)
    extension.adopt()
    world.clear()
    extension.close()
    assert not len(world.rigid_bodies)


def test_a_kinematic_body_that_is_removed_without_a_word(world) -> None:
    add(world, (0.0, 0.0, HEIGHT / 2))
    platform = add(world, (1.0, 0.0, 0.5), motion="kinematic_position_based")
    with attach(world) as extension:
        extension.adopt()
        world.remove_body(platform)
        run(world, extension, 0.2)
        assert len(extension.frozen) == 1


def test_a_frozen_body_that_is_moved_without_a_word(world) -> None:
    handle = add(world, (0.0, 0.0, HEIGHT / 2))
    with attach(world) as extension:
        extension.adopt()
        view(world, handle).translation = (0.5, 0.0, 0.5)
        run(world, extension, 1.0)
        assert height(world, handle) == pytest.approx(HEIGHT / 2, abs=1e-3)


def test_a_collider_that_another_replaces_between_two_updates(world) -> None:
    """The number of colliders stays the same, so that only its contacts show the new one."""
    platform = rapier3d.Collider.cuboid(0.2, 0.2, 0.1)
    first = world.add_collider(platform.translation((5.0, 0.0, 0.1)))
    handle = add(world, (0.0, 0.0, 0.3))
    with attach(world) as extension:
        run(world, extension, 0.02)
        world.remove_collider(first)
        world.add_collider(platform.translation((0.0, 0.0, 0.1)))
        run(world, extension, 1.5)
        assert list(extension.frozen) == [id_of(handle)], extension.why(id_of(handle))
        assert height(world, handle) == pytest.approx(0.2 + HEIGHT / 2, abs=1e-3)
