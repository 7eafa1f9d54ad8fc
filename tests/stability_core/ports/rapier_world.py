"""Worlds of Rapier for the tests of its port."""

from __future__ import annotations

import numpy as np
import pytest

rapier3d = pytest.importorskip("rapier3d")
from stability_core.ports.rapier import id_of  # noqa: E402 # it imports rapier3d

HALF = (0.05, 0.05, 0.03)
HEIGHT = 0.06
STEP_S = 0.01
UPRIGHT = (0.0, 0.0, 0.0, 1.0)
QUARTER_TURN = (np.pi / 2, 0.0, 0.0)  # of a cylinder, from its axis y to z
HEXAGON = np.array([[0.05 * np.cos(a), 0.05 * np.sin(a), z] for z in (-0.03, 0.03) for a in np.arange(6) * np.pi / 3])


def open_world(gravity: tuple[float, float, float] = (0.0, 0.0, -9.81)):
    """Return a world on a half space."""
    world = rapier3d.PhysicsWorld(gravity=gravity)
    world.set_num_threads(1)
    world.integration_parameters.dt = STEP_S
    world.add_collider(rapier3d.Collider.halfspace((0.0, 0.0, 1.0)))
    return world


def add(world, position, kind: str = "box", motion: str = "dynamic", turn=UPRIGHT):
    """Add a body, and return its handle."""
    shapes = rapier3d.SharedShape
    if kind == "cylinder":
        colliders = [rapier3d.Collider.cylinder(HEIGHT / 2, 0.05).rotation(QUARTER_TURN)]
    elif kind == "hull":
        colliders = [rapier3d.Collider.convex_hull(HEXAGON)]
    elif kind == "offset":  # whose frame is at its lower face
        colliders = [rapier3d.Collider.cuboid(*HALF).translation((0.0, 0.0, HEIGHT / 2))]
        position = (*position[:2], position[2] - HEIGHT / 2)
    elif kind == "two colliders":
        colliders = [rapier3d.Collider.cuboid(0.025, 0.05, 0.03).translation((x, 0.0, 0.0)) for x in (-0.025, 0.025)]
    elif kind == "compound":
        halves = [((x, 0.0, 0.0), UPRIGHT) for x in (-0.025, 0.025)]
        colliders = [rapier3d.Collider.compound([(half, shapes.cuboid(0.025, 0.05, 0.03)) for half in halves])]
    else:
        colliders = [rapier3d.Collider.cuboid(*HALF)]
    body = getattr(rapier3d.RigidBody, motion)().position((position, turn))
    return world.add_body(body, [collider.density(1000.0) for collider in colliders])


def arm(world, at=(3.0, 0.0, 0.2), *, is_multibody: bool = False):
    """Return base and link of an arm of one hinge about y, with a motor."""
    base = world.add_body(rapier3d.RigidBody.fixed().translation(at), [rapier3d.Collider.cuboid(0.1, 0.1, 0.1)])
    x, y, z = at
    link = world.add_body(
        rapier3d.RigidBody.dynamic().translation((x, y, z + 0.35)), [rapier3d.Collider.cuboid(0.03, 0.03, 0.2)]
    )
    hinge = rapier3d.RevoluteJoint.builder((0.0, 1.0, 0.0)).local_anchor1((0.0, 0.0, 0.1))
    hinge = hinge.local_anchor2((0.0, 0.0, -0.25)).contacts_enabled(False)
    hinge = hinge.motor_model(rapier3d.MotorModel.FORCE_BASED).motor_position(0.0, 100.0, 5.0)  # [N m/rad], [N m s/rad]
    joints = world.multibody_joints if is_multibody else world.impulse_joints
    return base, link, joints.insert(base, link, hinge.build())


def run(world, extension, seconds: float) -> None:
    """Play some time, with an update after each step."""
    for _ in range(round(seconds / STEP_S)):
        world.step()
        extension.update(STEP_S)


def view(world, handle):
    """Return Rapier's view of a body."""
    return world.rigid_bodies[handle]


def position(world, handle) -> tuple[float, ...]:
    """Return the position of a body's frame [m]."""
    return view(world, handle).translation.to_tuple()


def height(world, handle) -> float:
    """Return the height of a body's frame [m]."""
    return position(world, handle)[2]


def ids(handles) -> list[int]:
    """Return the ids of bodies."""
    return [id_of(handle) for handle in handles]
