"""Mass and inertia in the engines, read back through their own interfaces, and free rotation against closed forms."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from adapters import capabilities, open_engine
from adapters.base import Simulation
from scenarios.geometry import rotation
from scenarios.model import Brick, Vector, World
from scenarios.shapes import name_of
from scenarios.solids import capsule, cylinder, moments_of, polyhedron, sphere

AT = (0.0, 0.0, 1.0)
SKEW = [(0, 0, 0), (0.06, 0, 0), (0, 0.05, 0), (0, 0, 0.04), (0.03, 0.03, 0.01), (0.05, 0.01, 0.03)]
BRICKS = {
    "cylinder": cylinder(0.02, 0.07, position=AT, mass=0.3),
    "capsule": capsule(0.02, 0.07, position=AT, mass=0.3),
    "sphere": sphere(0.02, position=AT, mass=0.3),
    "polyhedron": polyhedron(SKEW, position=AT, mass=0.3),
    "box with moments": Brick((0.03, 0.04, 0.05), 0.3, AT, moments=(2e-4, 3e-4, 4e-4)),
}


def of_bullet(simulation: Simulation, body: int) -> tuple[float, Any]:
    import pybullet

    info = pybullet.getDynamicsInfo(simulation._handles[body], -1, simulation._client)
    return info[0], info[2]


def of_mujoco(simulation: Simulation, body: int) -> tuple[float, Any]:
    slots = simulation._engine.slots
    row = 1 + simulation._engine.slot_of[body]
    turn = slots.model.body_iquat[row]
    assert abs(turn[0]) == pytest.approx(1.0), "the inertial frame is the body's"
    assert slots.model.body_ipos[row] == pytest.approx((0.0, 0.0, 0.0), abs=1e-12)
    return float(slots.model.body_mass[row]), slots.model.body_inertia[row]


def of_rapier(simulation: Simulation, body: int) -> tuple[float, Any]:
    """Rapier's principal axes may lie otherwise than the brick's: a cylinder's collider is turned in its body."""
    properties = simulation._views[body].mass_properties
    x, y, z, w = properties.principal_inertia_local_frame.to_tuple()
    turn = rotation(np.array([[w, x, y, z]]))[0]
    tensor = turn @ np.diag(properties.principal_inertia.to_tuple()) @ turn.T
    assert np.abs(tensor - np.diag(np.diag(tensor))).max() < 1e-6 * tensor.max()
    return properties.mass, np.diag(tensor)


def of_physx(simulation: Simulation, body: int) -> tuple[float, Any]:
    component = simulation._engine.components[body]
    assert np.abs(component.cmass_local_pose.p).max() < 1e-7
    assert abs(component.cmass_local_pose.q[0]) == pytest.approx(1.0)
    return float(component.mass), component.inertia


def of_dart(simulation: Simulation, body: int) -> tuple[float, Any]:
    node = simulation._engine.skeletons[body].getBodyNode(0)
    return node.getMass(), np.diag(node.getInertia().getMoment())


def of_box3d(simulation: Simulation, body: int) -> tuple[float, Any]:
    from robox3d._ffi import lib

    data = lib.b3Body_GetMassData(simulation._engine.handles[body])
    inertia = data.inertia
    off = (inertia.cx.y, inertia.cx.z, inertia.cy.z)
    assert np.abs(off).max() < 1e-6 * inertia.cx.x
    return data.mass, (inertia.cx.x, inertia.cy.y, inertia.cz.z)


READ: dict[str, Callable[[Simulation, int], tuple[float, Any]]] = {
    "bullet": of_bullet,
    "mujoco": of_mujoco,
    "rapier": of_rapier,
    "physx": of_physx,
    "dart": of_dart,
    "box3d": of_box3d,
}


@pytest.mark.parametrize("engine", READ)
def test_mass_and_inertia_are_those_of_the_brick(engine: str) -> None:
    can = capabilities(engine)
    simulation = open_engine(engine, "game", world=World())
    try:
        for what, brick in BRICKS.items():
            if name_of(brick.shape) not in can.shapes or (brick.moments and not can.own_moments):
                continue
            body = simulation.spawn(brick)
            mass, moments = READ[engine](simulation, body)
            assert mass == pytest.approx(0.3, rel=1e-6), what
            assert np.asarray(moments) == pytest.approx(moments_of(brick), rel=1e-6), what
            simulation.port.sleep([body])
            simulation.port.wake([body])
            mass, moments = READ[engine](simulation, body)
            assert (mass, *moments) == pytest.approx((0.3, *moments_of(brick)), rel=1e-6), f"{what}, unfrozen"
    finally:
        simulation.close()


def spin_bullet(simulation: Simulation, body: int, spin: Vector) -> None:
    import pybullet

    pybullet.resetBaseVelocity(simulation._handles[body], (0, 0, 0), spin, simulation._client)


def spin_mujoco(simulation: Simulation, body: int, spin: Vector) -> None:
    simulation._engine.slots.velocities[simulation._engine.slot_of[body], 3:] = spin


def spin_rapier(simulation: Simulation, body: int, spin: Vector) -> None:
    import rapier3d

    simulation._views[body].angvel = rapier3d.Vec3(*spin)


def spin_physx(simulation: Simulation, body: int, spin: Vector) -> None:
    simulation._engine.components[body].angular_velocity = spin


def spin_dart(simulation: Simulation, body: int, spin: Vector) -> None:
    simulation._engine.joints[body].setVelocities([*spin, 0.0, 0.0, 0.0])


SPIN = {"bullet": spin_bullet, "mujoco": spin_mujoco, "rapier": spin_rapier, "physx": spin_physx, "dart": spin_dart}


@pytest.mark.parametrize("engine", SPIN)
@pytest.mark.parametrize("axis", range(3))
def test_a_free_body_turns_about_each_principal_axis_for_ever(engine: str, axis: int) -> None:
    """Without weight, a spin w about a principal axis stays, and turns the body by w t about this axis."""
    can = capabilities(engine)
    for what, brick in BRICKS.items():
        if name_of(brick.shape) not in can.shapes:
            continue
        simulation = open_engine(engine, "tuned", world=World(gravity=(0.0, 0.0, 0.0)))
        try:
            upright = Brick(
                brick.size, brick.mass, brick.position, shape=brick.shape, moments=brick.moments
            )  # in its own frame
            body = simulation.spawn(upright)
            spin = [0.0, 0.0, 0.0]
            spin[axis] = 2.0
            SPIN[engine](simulation, body, (spin[0], spin[1], spin[2]))
            frames = 30
            for _ in range(frames):
                simulation.step(simulation.info.frame_s)
            quaternion = simulation.poses()[2][0]
            half = 2.0 * frames * simulation.info.frame_s / 2
            ideal = np.array([math.cos(half), 0.0, 0.0, 0.0])
            ideal[1 + axis] = math.sin(half)
            # 1 %: DART and PhysX damp a little, and integrators of first order turn by a step more or less.
            assert abs(quaternion @ ideal) == pytest.approx(1.0, abs=1e-3), (what, quaternion, ideal)
        finally:
            simulation.close()
