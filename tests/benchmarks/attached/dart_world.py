"""A user's world of DART with the planks of ``tests.benchmarks.attach_cost``."""

from __future__ import annotations

from typing import Any

import dartpy

from stability_core.ports import attach
from tests.benchmarks.attached.side import ABOVE, FRAME_S, FRICTION, FROZEN, MASS, PARKED, SIZE, Side, place


class AttachedDart(Side):
    """A user's world of DART, with as many steps a frame as the suite's profile ``default``.

    As in the suite, the ground is immobile, so that DART lists no contacts of frozen planks, and DART's own sleeping is
    off.
    """

    def __init__(self, steps: int) -> None:
        self.steps = steps
        self.world = dartpy.simulation.World()
        self.world.setGravity([0.0, 0.0, -9.81])
        self.world.setTimeStep(FRAME_S / steps)
        sleeping = self.world.getDeactivationOptions()
        sleeping.mEnabled = False
        self.world.setDeactivationOptions(sleeping)
        self._add((40.0, 40.0, 2.0), (0.0, 0.0, -1.0)).setMobile(False)
        for index in range(FROZEN):
            self._add(SIZE, place(index))
        self.plank = self._add(SIZE, PARKED)
        self.extension = attach(self.world)
        self.falling = self.extension.id_of(self.plank)
        self.build()

    def _add(self, size: tuple[float, ...], position: tuple[float, ...]) -> Any:
        skeleton = dartpy.dynamics.Skeleton(f"plank {position}")
        joint, node = skeleton.createFreeJointAndBodyNodePair()
        box = dartpy.dynamics.BoxShape(list(size))
        shape = node.createShapeNode(box)
        shape.createCollisionAspect()
        shape.createDynamicsAspect().setFrictionCoeff(FRICTION)
        inertia = dartpy.dynamics.Inertia()
        inertia.setMass(MASS)
        inertia.setMoment(box.computeInertia(MASS))
        node.setInertia(inertia)
        joint.setPositions([0.0, 0.0, 0.0, *position])
        self.world.addSkeleton(skeleton)
        return skeleton

    def step(self) -> None:
        for _ in range(self.steps):
            self.world.step()

    def drop(self) -> None:
        self.extension.wake([self.falling])
        self.plank.setPositions([0.0, 0.0, 0.0, *ABOVE])
        self.plank.resetVelocities()
