"""Worlds of DART for the tests of its port, as DART ships them."""

from __future__ import annotations

import numpy as np
import pytest

dartpy = pytest.importorskip("dartpy")
from dartpy import dynamics  # noqa: E402

SIZE = (0.1, 0.1, 0.06)
HEIGHT = 0.06
STEP_S = 1e-3
STEPS = 10
"""Number of steps a frame."""
FRAME_S = STEPS * STEP_S
_count = 0


def open_world(gravity: tuple[float, float, float] = (0.0, 0.0, -9.81), ground=None):
    """Return a world with a wide fixed box, or another skeleton, as its ground."""
    world = dartpy.simulation.World()
    world.setGravity(list(gravity))
    world.addSkeleton(ground or fixed("ground", (0.0, 0.0, -0.5), (10.0, 10.0, 1.0)))
    return world


def plane():
    """Return the plane z = 0, fixed to the world."""
    skeleton = dynamics.Skeleton("plane")
    _, node = skeleton.createWeldJointAndBodyNodePair()
    _add_shape(node, dynamics.PlaneShape([0.0, 0.0, 1.0], 0.0))
    return skeleton


def fixed(name: str, position, size):
    """Return a box that is welded to the world."""
    skeleton = dynamics.Skeleton(name)
    joint, node = skeleton.createWeldJointAndBodyNodePair()
    _add_shape(node, dynamics.BoxShape(list(size)))
    pose = dartpy.math.Isometry3()
    pose.set_translation(list(position))
    joint.setTransformFromParentBodyNode(pose)
    return skeleton


def _add_shape(node, shape) -> None:
    shape_node = node.createShapeNode(shape)
    shape_node.createCollisionAspect()
    shape_node.createDynamicsAspect().setFrictionCoeff(0.8)


def add(world, position, kind: str = "box", mass: float = 1.0):
    """Add a free body at rest, and return its skeleton."""
    global _count
    _count += 1
    skeleton = dynamics.Skeleton(f"body {_count}")
    joint, node = skeleton.createFreeJointAndBodyNodePair()
    shape = dynamics.CylinderShape(0.05, HEIGHT) if kind == "cylinder" else dynamics.BoxShape(list(SIZE))
    _add_shape(node, shape)
    inertia = dynamics.Inertia()
    inertia.setMass(mass)
    inertia.setMoment(shape.computeInertia(mass))
    offset = 0.0
    if kind == "offset":  # the frame is at the lower face
        offset = HEIGHT / 2
        node.getShapeNode(0).setRelativeTranslation([0.0, 0.0, offset])
        inertia.setLocalCOM([0.0, 0.0, offset])
    node.setInertia(inertia)
    joint.setPositions([0.0, 0.0, 0.0, *position[:2], position[2] - offset])
    world.addSkeleton(skeleton)
    return skeleton


def arm(world, at=(3.0, 0.0, 0.4)):
    """Add an arm of one hinge about y that hangs from a weld, and return its skeleton."""
    skeleton = dynamics.Skeleton("arm")
    weld, base = skeleton.createWeldJointAndBodyNodePair()
    pose = dartpy.math.Isometry3()
    pose.set_translation(list(at))
    weld.setTransformFromParentBodyNode(pose)
    joint, link = skeleton.createRevoluteJointAndBodyNodePair(base)
    joint.setAxis([0.0, 1.0, 0.0])
    down = dartpy.math.Isometry3()
    down.set_translation([0.0, 0.0, 0.2])
    joint.setTransformFromChildBodyNode(down)
    shape = dynamics.BoxShape([0.06, 0.06, 0.34])
    _add_shape(link, shape)
    inertia = dynamics.Inertia()
    inertia.setMass(1.0)
    inertia.setMoment(shape.computeInertia(1.0))
    link.setInertia(inertia)
    world.addSkeleton(skeleton)
    return skeleton


def step(world, seconds: float = FRAME_S) -> None:
    """Make the steps of a frame."""
    for _ in range(round(seconds / STEP_S)):
        world.step()


def run(world, extension, seconds: float) -> None:
    """Play some time, with an update after each frame."""
    for _ in range(round(seconds / FRAME_S)):
        step(world)
        extension.update(FRAME_S)


def place(skeleton) -> np.ndarray:
    """Return the position of the centre of mass of a body [m]."""
    return np.array(skeleton.getCOM())


def tower(world, count: int, kind: str = "box") -> list:
    """Add a tower without gaps, and return its skeletons."""
    return [add(world, (0.0, 0.0, (level + 0.5) * HEIGHT), kind) for level in range(count)]


def frozen(extension) -> list:
    """Return the frozen skeletons."""
    return [extension.body_of(body).getSkeleton() for body in extension.frozen]
