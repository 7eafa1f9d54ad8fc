"""Scenes of SAPIEN for the tests of its port."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

with warnings.catch_warnings():
    warnings.simplefilter("ignore")  # of a missing Vulkan, although nothing is rendered
    sapien = pytest.importorskip("sapien")
    from sapien import physx

HALF = (0.05, 0.05, 0.03)
HEIGHT = 0.06
STEP_S = 0.01
HEXAGON = np.array(
    [[0.05 * np.cos(a), 0.05 * np.sin(a), z] for z in (-0.03, 0.03) for a in np.arange(6) * np.pi / 3], np.float32
)


def open_scene(gravity: tuple[float, float, float] = (0.0, 0.0, -9.81)):
    """Return a scene with a ground plane, without rendering."""
    kept = physx.get_scene_config().gravity.copy()
    physx.set_scene_config(gravity=gravity)
    scene = sapien.Scene([physx.PhysxCpuSystem()])
    physx.set_scene_config(gravity=kept)
    scene.add_ground(0, render=False)
    return scene


def add(scene, position, kind: str = "box", motion: str = "dynamic", turn=(1.0, 0.0, 0.0, 0.0)):
    """Add an actor, and return its entity."""
    builder = scene.create_actor_builder()
    builder.physx_body_type = motion
    if kind == "box":
        builder.add_box_collision(half_size=HALF)
    elif kind == "cylinder":  # whose axis is x
        builder.add_cylinder_collision(sapien.Pose(q=[np.sqrt(0.5), 0, np.sqrt(0.5), 0]), 0.05, HEIGHT / 2)
    elif kind == "offset":  # whose frame is at its lower face
        builder.add_box_collision(sapien.Pose([0.0, 0.0, HEIGHT / 2]), HALF)
        position = (*position[:2], position[2] - HEIGHT / 2)
    entity = builder.build() if kind != "mesh" else _mesh(scene)
    entity.pose = sapien.Pose(position, turn)
    return entity


def _mesh(scene):
    """A hexagonal prism, because the builder takes meshes from files only."""
    body = physx.PhysxRigidDynamicComponent()
    body.attach(physx.PhysxCollisionShapeConvexMesh(HEXAGON, np.ones(3, np.float32), physx.get_default_material()))
    entity = sapien.Entity()
    entity.add_component(body)
    scene.add_entity(entity)
    return entity


def arm(scene, at=(3.0, 0.0, 0.2)):
    """Return an arm of one hinge about y, on a fixed base, with a motor."""
    builder = scene.create_articulation_builder()
    base = builder.create_link_builder()
    base.add_box_collision(half_size=[0.1, 0.1, 0.1])
    link = builder.create_link_builder(base)
    link.add_box_collision(half_size=[0.03, 0.03, 0.2])
    turned = [np.sqrt(0.5), 0, 0, np.sqrt(0.5)]  # the hinge's axis is x in its frame
    link.set_joint_properties(
        "revolute", [[-3, 3]], sapien.Pose([0, 0, 0.1], turned), sapien.Pose([0, 0, -0.25], turned), 0.0, 0.01
    )
    robot = builder.build(fix_root_link=True)
    robot.pose = sapien.Pose(at)
    robot.active_joints[0].set_drive_properties(stiffness=20.0, damping=2.0)
    return robot


def run(scene, extension, seconds: float) -> None:
    """Play some time, with an update after each step."""
    for _ in range(round(seconds / STEP_S)):
        scene.step()
        extension.update(STEP_S)


def height(entity) -> float:
    """Return the height of an entity [m]."""
    return float(entity.pose.p[2])


def component(entity):
    """Return the dynamic body of an entity."""
    return entity.find_component_by_type(physx.PhysxRigidDynamicComponent)
