"""Mistakes of a PyBullet user: each ends in a message that names the fix, or is put right without one."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

pybullet = pytest.importorskip("pybullet")

from stability_core.lookup import UnknownNameError  # noqa: E402
from stability_core.ports import attach  # noqa: E402
from stability_core.ports.shared.free_flight import FRAMES  # noqa: E402

STEP_S = 1 / 240


@pytest.fixture
def client() -> Iterator[int]:
    client = pybullet.connect(pybullet.DIRECT)
    pybullet.setGravity(0, 0, -9.81, client)
    pybullet.createMultiBody(
        0, pybullet.createCollisionShape(pybullet.GEOM_PLANE, physicsClientId=client), physicsClientId=client
    )
    yield client
    if pybullet.isConnected(client):
        pybullet.disconnect(client)


def add(client: int, height: float = 0.05, mass: float = 1.0, x: float = 0.0) -> int:
    shape = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=[0.05] * 3, physicsClientId=client)
    return pybullet.createMultiBody(mass, shape, basePosition=[x, 0, height], physicsClientId=client)


def arm(client: int) -> int:
    shape = pybullet.createCollisionShape(pybullet.GEOM_SPHERE, radius=0.05, physicsClientId=client)
    return pybullet.createMultiBody(
        0.0,
        shape,
        basePosition=[2, 0, 1],
        linkMasses=[1.0],
        linkCollisionShapeIndices=[shape],
        linkVisualShapeIndices=[-1],
        linkPositions=[[0, 0, 0.2]],
        linkOrientations=[[0, 0, 0, 1]],
        linkInertialFramePositions=[[0, 0, 0]],
        linkInertialFrameOrientations=[[0, 0, 0, 1]],
        linkParentIndices=[0],
        linkJointTypes=[pybullet.JOINT_REVOLUTE],
        linkJointAxis=[[0, 1, 0]],
        physicsClientId=client,
    )


@pytest.mark.parametrize(
    ("steps", "times"),
    [(4, "times its velocity times dt"), (0, "moved 0 times its velocity times dt = 0.00416667 s")],
)
def test_more_steps_or_none_between_two_updates(client: int, steps: int, times: str) -> None:
    body = add(client, 20.0)
    pybullet.resetBaseVelocity(body, (0, 0, -3.0), physicsClientId=client)

    def run() -> None:
        for _ in range(FRAMES + 3):
            for _ in range(steps):
                pybullet.stepSimulation(client)
            extension.update(STEP_S)

    with attach(client) as extension, pytest.raises(ValueError, match=f"{times}.*pass the time of all steps"):
        run()


def test_several_steps_a_frame_are_no_mistake(client: int) -> None:
    add(client, 20.0)
    with attach(client) as extension:
        for _ in range(30):
            for _ in range(4):
                pybullet.stepSimulation(client)
            extension.update(4 * STEP_S)


def test_a_time_that_is_no_number_of_steps(client: int) -> None:
    with attach(client) as extension, pytest.raises(ValueError, match=r"not a whole number.*setTimeStep"):
        extension.update(1 / 100)


def test_an_update_without_a_time(client: int) -> None:
    with attach(client) as extension, pytest.raises(ValueError, match="dt must be positive"):
        extension.update(0.0)


def test_the_engines_own_clock(client: int) -> None:
    pybullet.setRealTimeSimulation(1, client)
    with attach(client) as extension, pytest.raises(ValueError, match=r"setRealTimeSimulation\(0\)"):
        extension.update(STEP_S)


def test_no_gravity(client: int) -> None:
    pybullet.setGravity(0, 0, 0, client)
    with pytest.raises(ValueError, match=r"no gravity.*before attach"):
        attach(client)


def test_a_body_that_does_not_exist(client: int) -> None:
    with pytest.raises(ValueError, match=r"no body 99: pass ids that createMultiBody"):
        attach(client, bodies=[99])


def test_a_static_body(client: int) -> None:
    with pytest.raises(ValueError, match=r"body 0 has no mass.*list bodies with a mass"):
        attach(client, bodies=[0])


def test_a_robot(client: int) -> None:
    with pytest.raises(ValueError, match=r"body 1 has joints: list free bodies only"):
        attach(client, bodies=[arm(client)])


def test_a_body_listed_twice(client: int) -> None:
    body = add(client)
    with pytest.raises(ValueError, match=r"controls .* already: list each body once"):
        attach(client, bodies=[body, body])


def test_two_attachments(client: int) -> None:
    with attach(client), pytest.raises(RuntimeError, match=r"already has an extension.*close\(\)"):
        attach(client)
    attach(client).close()


def test_a_world_that_is_closed_first(client: int) -> None:
    add(client)
    with attach(client) as extension:
        extension.adopt()
        pybullet.disconnect(client)
        with pytest.raises(ValueError, match=r"call close\(\) before pybullet.disconnect"):
            extension.update(STEP_S)


def test_a_client_that_was_never_opened() -> None:
    with pytest.raises(ValueError, match=r"client 77 is not connected.*pybullet.connect"):
        attach(77)


def test_a_pose_that_is_not_finite(client: int) -> None:
    body = add(client)
    with attach(client) as extension:
        pybullet.resetBaseVelocity(body, (float("nan"), 0, 0), physicsClientId=client)
        pybullet.stepSimulation(client)
        with pytest.raises(ValueError, match=f"body {body} .*diverged or .*: use a smaller step"):
            extension.update(STEP_S)


def test_use_after_close(client: int) -> None:
    extension = attach(client)
    extension.close()
    for use in (lambda: extension.update(STEP_S), extension.adopt, lambda: extension.add([1])):
        with pytest.raises(RuntimeError, match="closed: create a new"):
            use()


def test_an_unknown_policy(client: int) -> None:
    with pytest.raises(UnknownNameError, match=r"equilibriun.*did you mean 'equilibrium'"):
        attach(client, policy="equilibriun")


def test_an_object_that_is_no_world() -> None:
    with pytest.raises(TypeError, match=r"cannot use ndarray.*PyBullet's client id"):
        attach(np.zeros(3))


def test_a_new_body_under_the_id_of_a_frozen_one(client: int) -> None:
    """Bullet gives the id of a removed body to the next one; the port finds that it is another body."""
    body = add(client)
    with attach(client) as extension:
        extension.adopt()
        pybullet.removeBody(body, client)
        assert add(client, height=0.5, mass=3.0) == body
        for _ in range(480):
            pybullet.stepSimulation(client)
            extension.update(STEP_S)
        assert body in extension.frozen
        assert pybullet.getBasePositionAndOrientation(body, client)[0][2] == pytest.approx(0.05, abs=1e-3)
    assert pybullet.getDynamicsInfo(body, -1, client)[0] == 3.0


def test_a_frozen_body_that_is_moved_without_a_word(client: int) -> None:
    body = add(client)
    with attach(client) as extension:
        extension.adopt()
        pybullet.resetBasePositionAndOrientation(body, (0.5, 0, 0.5), (0, 0, 0, 1), client)
        for _ in range(240):
            pybullet.stepSimulation(client)
            extension.update(STEP_S)
        assert pybullet.getBasePositionAndOrientation(body, client)[0][2] == pytest.approx(0.05, abs=1e-3)


def trajectory(client: int, *, attached: bool) -> np.ndarray:
    """Poses and velocities of a driven arm beside two falling boxes."""
    robot = arm(client)
    first, second = add(client, 3.0), add(client, 5.0, x=1.0)
    pybullet.setJointMotorControl2(robot, 0, pybullet.VELOCITY_CONTROL, targetVelocity=2.0, physicsClientId=client)
    pybullet.enableJointForceTorqueSensor(robot, 0, physicsClientId=client)
    extension = attach(client) if attached else None
    rows = []
    for _ in range(150):
        pybullet.stepSimulation(client)
        if extension:
            extension.update(STEP_S)
            assert not len(extension.frozen)
        joint = pybullet.getJointState(robot, 0, client)
        boxes = [
            value
            for body in (first, second)
            for part in pybullet.getBasePositionAndOrientation(body, client)
            for value in part
        ]
        rows.append([joint[0], joint[1], *joint[2], *boxes])
    return np.array(rows)


def test_arm_and_sensors_keep_their_trajectories_to_the_bit_while_nothing_is_frozen(client: int) -> None:
    alone = trajectory(client, attached=False)
    pybullet.resetSimulation(physicsClientId=client)
    pybullet.setGravity(0, 0, -9.81, client)
    pybullet.createMultiBody(
        0, pybullet.createCollisionShape(pybullet.GEOM_PLANE, physicsClientId=client), physicsClientId=client
    )
    np.testing.assert_array_equal(trajectory(client, attached=True), alone)
