"""An extension on a PyBullet world that a user owns."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

pybullet = pytest.importorskip("pybullet")

from stability_core.ports import Attachment, attach  # noqa: E402

STEP_S = 1 / 240
HEIGHT = 0.06
HEXAGON = [[0.05 * np.cos(a), 0.05 * np.sin(a), z] for z in (-0.03, 0.03) for a in np.arange(6) * np.pi / 3]


@pytest.fixture
def client() -> Iterator[int]:
    client = pybullet.connect(pybullet.DIRECT)
    pybullet.setGravity(0, 0, -9.81, client)
    floor = pybullet.createCollisionShape(pybullet.GEOM_PLANE, physicsClientId=client)
    pybullet.createMultiBody(0, floor, physicsClientId=client)
    yield client
    if pybullet.isConnected(client):
        pybullet.disconnect(client)


def shape(kind: str, client: int) -> int:
    if kind == "box":
        return pybullet.createCollisionShape(
            pybullet.GEOM_BOX, halfExtents=[0.05, 0.05, HEIGHT / 2], physicsClientId=client
        )
    if kind == "cylinder":
        return pybullet.createCollisionShape(pybullet.GEOM_CYLINDER, radius=0.05, height=HEIGHT, physicsClientId=client)
    return pybullet.createCollisionShape(pybullet.GEOM_MESH, vertices=HEXAGON, physicsClientId=client)


def add(client: int, position: tuple[float, float, float], kind: str = "box", mass: float = 0.5, **more: object) -> int:
    return pybullet.createMultiBody(mass, shape(kind, client), basePosition=position, physicsClientId=client, **more)


def tower(client: int, count: int, kind: str = "box") -> list[int]:
    return [add(client, (0.0, 0.0, (level + 0.5) * HEIGHT), kind) for level in range(count)]


def run(client: int, extension: Attachment, seconds: float) -> None:
    for _ in range(round(seconds / STEP_S)):
        pybullet.stepSimulation(client)
        extension.update(STEP_S)


def position(client: int, body: int) -> np.ndarray:
    return np.array(pybullet.getBasePositionAndOrientation(body, client)[0])


@pytest.mark.parametrize("kind", ["box", "cylinder", "mesh"])
def test_a_prebuilt_tower_freezes_before_its_first_step_and_does_not_move(client: int, kind: str) -> None:
    bodies = tower(client, 4, kind)
    with attach(client) as extension:
        assert list(extension.adopt().frozen) == bodies
        before = [position(client, body) for body in bodies]
        run(client, extension, 0.5)
        assert np.array_equal(before, [position(client, body) for body in bodies])


@pytest.mark.parametrize("kind", ["box", "cylinder", "mesh"])
def test_bodies_that_come_one_by_one_freeze_where_they_land(client: int, kind: str) -> None:
    with attach(client) as extension:
        top = 0.0
        for _ in range(3):
            body = add(client, (0.0, 0.0, top + HEIGHT / 2 + 0.0005), kind)
            run(client, extension, 1.0)
            assert body in extension.frozen, extension.why(body)
            top = float(position(client, body)[2]) + HEIGHT / 2


def test_an_overhang_beyond_the_edge_stays_live_and_falls(client: int) -> None:
    """The centre of the upper box lies 1 cm outside its support."""
    add(client, (0.0, 0.0, HEIGHT / 2))
    upper = add(client, (0.06, 0.0, 1.5 * HEIGHT))
    with attach(client) as extension:
        extension.adopt()
        run(client, extension, 1.0)
        assert position(client, upper)[2] < HEIGHT


def test_removing_a_support_wakes_what_rests_on_it(client: int) -> None:
    lower, upper = tower(client, 2)
    with attach(client) as extension:
        extension.adopt()
        extension.remove([lower])
        pybullet.removeBody(lower, client)
        run(client, extension, 1.0)
        assert position(client, upper)[2] == pytest.approx(HEIGHT / 2, abs=1e-3)


def test_a_body_removed_behind_the_ports_back_is_noticed(client: int) -> None:
    lower, upper = tower(client, 2)
    with attach(client) as extension:
        extension.adopt()
        pybullet.removeBody(lower, client)
        run(client, extension, 1.0)
        assert position(client, upper)[2] == pytest.approx(HEIGHT / 2, abs=1e-3)


def test_a_platform_that_the_user_lowers_takes_its_tower_along(client: int) -> None:
    platform = add(client, (0.0, 0.0, 0.5), mass=0.0)
    body = add(client, (0.0, 0.0, 0.5 + HEIGHT))
    with attach(client) as extension:
        extension.adopt()
        assert list(extension.frozen) == [body]
        for frame in range(120):
            pybullet.resetBasePositionAndOrientation(platform, (0.0, 0.0, 0.5 - frame * 5e-4), (0, 0, 0, 1), client)
            run(client, extension, STEP_S)
        assert position(client, body)[2] == pytest.approx(0.5 - 119 * 5e-4 + HEIGHT, abs=2e-3)


@pytest.mark.parametrize("calm_s", [0.0, 3.0])
def test_a_platform_that_turns_in_place_wakes_its_load(client: int, calm_s: float) -> None:
    platform = add(client, (0.0, 0.0, 0.5), mass=0.0)
    body = add(client, (0.0, 0.0, 0.5 + HEIGHT))
    with attach(client) as extension:
        extension.adopt()
        run(client, extension, calm_s)
        turned = pybullet.getQuaternionFromEuler((0.0, np.radians(40.0), 0.0))  # steeper than friction 0.5 * 0.5 holds
        pybullet.resetBasePositionAndOrientation(platform, (0.0, 0.0, 0.5), turned, client)
        run(client, extension, 1.0)
        assert position(client, body)[2] < 0.3


def test_gravity_along_y_is_followed(client: int) -> None:
    """The stack stands on a wall: down is where the world says."""
    pybullet.setGravity(0, -9.81, 0, client)
    wall = pybullet.createCollisionShape(pybullet.GEOM_PLANE, planeNormal=[0, 1, 0], physicsClientId=client)
    pybullet.createMultiBody(0, wall, basePosition=[0, 5, 0], physicsClientId=client)
    body = add(client, (0.0, 5.05, 5.0))
    with attach(client) as extension:
        assert extension.gravity == (0.0, -9.81, 0.0)
        assert extension.adopt().frozen == (body,)


def test_a_woken_body_falls_with_the_gravity_of_the_day(client: int) -> None:
    """Bullet gives a new gravity to active bodies only: a frozen body must not keep the old one."""
    (body,) = tower(client, 1)
    with attach(client) as extension:
        extension.adopt()
        pybullet.setGravity(0, 0, 4.0, client)
        run(client, extension, 0.5)
        assert position(client, body)[2] == pytest.approx(HEIGHT / 2 + 4.0 * 0.5**2 / 2, rel=0.1)


def test_close_returns_every_body_with_its_mass_and_inertia(client: int) -> None:
    (body,) = tower(client, 1)
    pybullet.changeDynamics(body, -1, localInertiaDiagonal=(0.01, 0.02, 0.03), physicsClientId=client)
    before = pybullet.getDynamicsInfo(body, -1, client)[:3]
    extension = attach(client)
    extension.adopt()
    assert pybullet.getDynamicsInfo(body, -1, client)[0] == 0.0
    extension.close()
    assert pybullet.getDynamicsInfo(body, -1, client)[:3] == before


def test_bodies_that_are_not_listed_are_left_alone(client: int) -> None:
    first, second = add(client, (0.0, 0.0, HEIGHT / 2)), add(client, (1.0, 0.0, HEIGHT / 2))
    with attach(client, bodies=[first]) as extension:
        extension.adopt()
        run(client, extension, 1.0)
        assert list(extension.frozen) == [first]
        extension.add([second])
        run(client, extension, 1.0)
        assert list(extension.frozen) == [first, second]
        extension.remove([first])
        assert pybullet.getDynamicsInfo(first, -1, client)[0] == pytest.approx(0.5)


def test_a_cylinder_on_its_side_rolls_down_a_slope_of_two_degrees(client: int) -> None:
    """It rests on a line. Within a second it rolls by g sin(2 deg) / 3 = 11 cm; 5 cm at least."""
    pybullet.setGravity(9.81 * np.sin(np.radians(2)), 0, -9.81, client)
    side = pybullet.getQuaternionFromEuler((np.pi / 2, 0, 0))
    body = add(client, (0.0, 0.0, 0.05), "cylinder", baseOrientation=side)
    pybullet.changeDynamics(body, -1, linearDamping=0, angularDamping=0, physicsClientId=client)
    with attach(client) as extension:
        assert not extension.adopt().frozen
        run(client, extension, 1.0)
        assert position(client, body)[0] > 0.05


def test_a_tower_of_bodies_in_maximal_coordinates_freezes_without_a_warning(
    client: int, capfd: pytest.CaptureFixture[str]
) -> None:
    """PyBullet prints a warning if it is asked for the collision shape of such a body."""
    for level in range(3):
        add(client, (0.0, 0.0, (level + 0.5) * HEIGHT), useMaximalCoordinates=True)
    with attach(client) as extension:
        assert len(extension.adopt().frozen) == 3
    captured = capfd.readouterr()
    assert "Warning" not in captured.out + captured.err
