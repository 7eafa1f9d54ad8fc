"""Mistakes of a SAPIEN user: each ends in a message that names the fix, or is put right without one."""

from __future__ import annotations

import numpy as np
import pytest

from stability_core.ports import attach
from stability_core.ports.shared.free_flight import FRAMES
from tests.stability_core.ports.sapien_scene import HEIGHT, STEP_S, add, arm, component, height, open_scene, run, sapien


@pytest.fixture
def scene():
    scene = open_scene()
    yield scene
    scene.clear()


@pytest.mark.parametrize(
    ("steps", "times"), [(4, "times its velocity times dt"), (0, "moved 0 times its velocity times dt = 0.01 s")]
)
def test_more_steps_or_none_between_two_updates(scene, steps: int, times: str) -> None:
    component(add(scene, (0.0, 0.0, 20.0))).linear_velocity = [0.0, 0.0, -3.0]

    def play() -> None:
        for _ in range(FRAMES + 3):
            for _ in range(steps):
                scene.step()
            extension.update(STEP_S)

    with attach(scene) as extension, pytest.raises(ValueError, match=f"{times}.*pass the time of all steps"):
        play()


def test_several_steps_a_frame_are_no_mistake(scene) -> None:
    add(scene, (0.0, 0.0, 20.0))
    with attach(scene) as extension:
        for _ in range(30):
            for _ in range(4):
                scene.step()
            extension.update(4 * STEP_S)


def test_a_time_that_is_no_number_of_steps(scene) -> None:
    with attach(scene) as extension, pytest.raises(ValueError, match=r"not a whole number.*scene.set_timestep\(\)"):
        extension.update(1 / 60)


def test_an_update_without_a_time(scene) -> None:
    with attach(scene) as extension, pytest.raises(ValueError, match="dt must be positive"):
        extension.update(0.0)


def test_no_gravity() -> None:
    scene = open_scene((0.0, 0.0, 0.0))
    with pytest.raises(ValueError, match=r"this SAPIEN world has no gravity.*before attach"):
        attach(scene)
    scene.clear()


def test_the_wrong_object_of_sapien(scene) -> None:
    with pytest.raises(TypeError, match=r"needs a sapien.Scene.*got Entity.*PhysxCpuSystem"):
        attach(add(scene, (0.0, 0.0, 1.0)))


def test_the_system_of_a_scene_is_the_same_world(scene) -> None:
    with attach(scene), pytest.raises(RuntimeError, match=r"already has an extension.*close\(\)"):
        attach(scene.physx_system)
    attach(scene).close()


def test_a_body_that_does_not_exist(scene) -> None:
    with pytest.raises(ValueError, match=r"no body 99: pass entity.per_scene_id of a body in the world"):
        attach(scene, bodies=[99])


@pytest.mark.parametrize(
    ("motion", "reason"), [("static", "is static already"), ("kinematic", "is kinematic.*list dynamic bodies")]
)
def test_a_body_that_does_not_fall(scene, motion: str, reason: str) -> None:
    body = add(scene, (0.0, 0.0, 1.0), motion=motion).per_scene_id
    with pytest.raises(ValueError, match=f"body {body} {reason}"):
        attach(scene, bodies=[body])


def test_a_robot(scene) -> None:
    link = arm(scene).links[1].entity.per_scene_id
    with pytest.raises(ValueError, match=f"body {link} is a link of an articulation: list free bodies only"):
        attach(scene, bodies=[link])


@pytest.mark.parametrize("joined", [0, 1])
def test_a_body_with_a_drive(scene, joined: int) -> None:
    """A drive belongs to its child's entity, and binds the parent as well."""
    pair = [add(scene, (x, 0.0, 1.0)) for x in (0.0, 0.2)]
    scene.create_drive(pair[0], sapien.Pose(), pair[1], sapien.Pose())
    with pytest.raises(ValueError, match="has joints: list free bodies only"):
        attach(scene, bodies=[pair[joined].per_scene_id])


def test_a_body_without_gravity_of_its_own(scene) -> None:
    entity = add(scene, (0.0, 0.0, 1.0))
    component(entity).disable_gravity = True
    with pytest.raises(ValueError, match="disable_gravity = False"):
        attach(scene, bodies=[entity.per_scene_id])


def test_a_body_with_locked_axes(scene) -> None:
    entity = add(scene, (0.0, 0.0, 1.0))
    component(entity).set_locked_motion_axes([False, False, False, True, True, False])
    with pytest.raises(ValueError, match=r"locked axes.*set_locked_motion_axes"):
        attach(scene, bodies=[entity.per_scene_id])


def test_a_body_listed_twice(scene) -> None:
    body = add(scene, (0.0, 0.0, 1.0)).per_scene_id
    with pytest.raises(ValueError, match=r"controls .* already: list each body once"):
        attach(scene, bodies=[body, body])


def test_a_drive_that_is_made_later_frees_its_body(scene) -> None:
    """The port checks a body in each frame, in turn."""
    entity = add(scene, (0.0, 0.0, HEIGHT / 2))
    with attach(scene) as extension:
        scene.create_drive(None, sapien.Pose([0.0, 0.0, 0.5]), entity, sapien.Pose()).set_drive_property_z(500.0, 50.0)
        run(scene, extension, 1.0)
        assert not len(extension.frozen)
        assert height(entity) > 0.4


def test_a_kinematic_body_that_is_removed_without_a_word(scene) -> None:
    add(scene, (0.0, 0.0, HEIGHT / 2))
    platform = add(scene, (1.0, 0.0, 0.5), motion="kinematic")
    with attach(scene) as extension:
        extension.adopt()
        scene.remove_entity(platform)
        run(scene, extension, 0.2)
        assert len(extension.frozen) == 1


def test_a_pose_that_is_not_finite(scene) -> None:
    entity = add(scene, (0.0, 0.0, 1.0))
    with attach(scene) as extension:
        entity.pose = sapien.Pose([np.nan, 0.0, 0.0])
        with pytest.raises(ValueError, match=f"body {entity.per_scene_id} .*diverged or .*: use a smaller step"):
            extension.update(STEP_S)


def test_use_after_close(scene) -> None:
    extension = attach(scene)
    extension.close()
    for use in (lambda: extension.update(STEP_S), extension.adopt, lambda: extension.add([1])):
        with pytest.raises(RuntimeError, match="closed: create a new"):
            use()


def test_a_scene_that_is_cleared_first(scene) -> None:
    entity = add(scene, (0.0, 0.0, HEIGHT / 2))
    extension = attach(scene)
    extension.adopt()
    scene.clear()
    extension.close()
    assert entity.scene is None


def test_a_frozen_body_that_is_moved_without_a_word(scene) -> None:
    entity = add(scene, (0.0, 0.0, HEIGHT / 2))
    with attach(scene) as extension:
        extension.adopt()
        entity.pose = sapien.Pose([0.5, 0.0, 0.5])
        run(scene, extension, 1.0)
        assert height(entity) == pytest.approx(HEIGHT / 2, abs=1e-3)
