"""What is special to a planar engine, and to Chipmunk's memory of what it once touched."""

import math

import numpy as np
import pytest
from pymunk import batch

from adapters import open_engine
from adapters._pymunk import PymunkSimulation
from scenarios.model import Brick, Quaternion, Vector, World
from stability_core.ports.pymunk_contacts import lift_contacts

LENGTH, DEPTH, THICKNESS = 0.117, 0.0234, 0.0078
FRAME = 1 / 60
WEIGHTLESS = World(gravity=(0.0, 0.0, 0.0))


def about_y(degrees: float) -> Quaternion:
    half = math.radians(degrees) / 2
    return (math.cos(half), 0.0, math.sin(half), 0.0)


def plank(x: float, z: float, degrees: float = 0.0, depth: float = DEPTH) -> Brick:
    return Brick((LENGTH, depth, THICKNESS), 0.0119, (x, 0.0, z), about_y(degrees))


def run(simulation: PymunkSimulation, frames: int) -> None:
    for _ in range(frames):
        simulation.step(FRAME)


def opened(profile: str = "game", **options: object) -> PymunkSimulation:
    simulation = open_engine("pymunk", profile, **options)  # type: ignore[arg-type]
    assert isinstance(simulation, PymunkSimulation)
    return simulation


def engine_pairs(simulation: PymunkSimulation) -> int:
    """How many pairs Chipmunk lists, frozen ones too."""
    buffer = batch.Buffer()
    batch.get_space_arbiters(simulation._engine.space, batch.ArbiterFields.CONTACT_COUNT, buffer)
    return len(np.frombuffer(buffer.int_buf(), np.int64))


# -- the plane ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("position", "quaternion", "fix"),
    [
        ((0.0, 0.001, 0.1), about_y(0), "the brick's centre must lie at y = 0"),
        ((0.0, 0.0, 0.1), (math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)), "a brick may turn about the y axis only"),
        ((0.0, 0.0, 0.1), (math.sqrt(0.5), math.sqrt(0.5), 0.0, 0.0), "a brick may turn about the y axis only"),
    ],
)
def test_what_leaves_the_plane_is_refused_with_the_fix(position: Vector, quaternion: Quaternion, fix: str) -> None:
    simulation = opened()
    with pytest.raises(ValueError, match=fix):
        simulation.spawn(Brick((LENGTH, DEPTH, THICKNESS), 0.0119, position, quaternion))
    body = simulation.spawn(plank(0, 0.1))
    with pytest.raises(ValueError, match=fix):
        simulation.move(body, position, quaternion)
    with pytest.raises(ValueError, match="impulse must lie in the x-z plane"):
        simulation.push(body, (0.0, 0.001, 0.0))
    with pytest.raises(ValueError, match="gravity must lie in the x-z plane"):
        opened(world=World(gravity=(0.0, 1.0, -9.81)))


def test_a_refused_brick_does_not_shift_the_others() -> None:
    simulation = opened()
    port = simulation.port
    with pytest.raises(ValueError, match="planar"):
        simulation.spawn(Brick((LENGTH, DEPTH, THICKNESS), 0.0119, (0.0, 1.0, 0.1)))
    body = simulation.spawn(plank(0.3, THICKNESS / 2 + 0.0005))
    run(simulation, 40)
    contacts = port.contacts()
    assert set(contacts.body_a) | set(contacts.body_b) == {-1, body}
    np.testing.assert_array_equal(np.abs(contacts.point[:, 1]), DEPTH / 2)
    assert np.ptp(contacts.point[:, 0]) == pytest.approx(LENGTH, abs=1e-6)  # bricks are distinguished by place


def test_a_turn_about_y_lowers_the_end_at_plus_x() -> None:
    """Right-handed about +y, +z turns towards +x, so +x turns down; resting contacts show which end is low."""
    simulation = opened()
    port = simulation.port
    body = simulation.spawn(plank(0, 0.04, 30))
    np.testing.assert_allclose(simulation.poses()[2][0], about_y(30), atol=1e-15)
    while not len(contacts := port.contacts()):
        simulation.step(FRAME)
    assert (contacts.point[:, 0] > 0.04).all()
    run(simulation, 1)  # the contact at +x throws that end up: the brick turns back, against +y
    assert simulation.velocities()[1][body, 1] < 0


def test_a_contact_spans_the_depth_that_both_bricks_share() -> None:
    simulation = opened()
    port = simulation.port
    wide = simulation.spawn(plank(0, THICKNESS / 2, depth=0.1))
    narrow = simulation.spawn(plank(0, 1.5 * THICKNESS, depth=0.02))
    run(simulation, 5)
    contacts = port.contacts()
    shared = np.isin(contacts.body_a, (wide, narrow)) & np.isin(contacts.body_b, (wide, narrow))
    np.testing.assert_array_equal(np.unique(contacts.point[shared, 1]), (-0.01, 0.01))
    np.testing.assert_array_equal(np.unique(contacts.point[~shared, 1]), (-0.05, 0.05))


def test_contacts_come_in_the_order_of_ids() -> None:
    """Chipmunk lists them by memory address: the core's sums would differ from run to run."""
    simulation = opened()
    assert simulation.port is not None  # observed
    for level in range(5):
        for column in range(4):
            simulation.spawn(plank(column * (LENGTH + 0.002), THICKNESS * (level + 0.5)))
    run(simulation, 3)
    contacts = simulation._contacts()
    pairs = list(zip(contacts.body_a, contacts.body_b, strict=True))
    assert len(set(pairs)) == 20
    assert pairs == sorted(pairs)


def test_swapped_pairs_are_turned_round_and_pairs_without_a_normal_left_out() -> None:
    """Bodies 0 and 1 close in at 3 units/s along z; Chipmunk lists the pair as (1, 0), and once more as nothing."""
    engine_ids, ids = np.array([10, 20, 30]), np.array([1, -1, 0])
    arbiters = np.array([[10, 30, 1], [20, 30, 1]])
    point = [0.0, 4.0, 0.0, 5.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    numbers = np.array([[0.0, -1.0, *point], [-0.0, 0.0, *point]])
    state, before = np.zeros((3, 6)), np.zeros((1, 3, 3))
    before[0, 1] = (0.0, -3.0, 0.0)
    pairs, points, normals, separations, velocities = lift_contacts(
        engine_ids, ids, arbiters, numbers, np.array([True, False, False]), 1, state, before, np.full(3, 0.02), 1000.0
    )
    np.testing.assert_array_equal(pairs, [(0, 1)] * 2)
    np.testing.assert_allclose(points, [(0, -0.01, 0.0045), (0, 0.01, 0.0045)])
    np.testing.assert_array_equal(normals, [(0, 0, 1)] * 2)
    np.testing.assert_allclose(separations, -0.001)
    np.testing.assert_allclose(velocities, [(0, 0, -0.003)] * 2)


# -- what a frozen body leaves behind ------------------------------------------------------------------


def test_frozen_pairs_are_not_read_again() -> None:
    """Chipmunk would list them for ever, with points in memory that other contacts have taken over."""
    simulation = opened()
    seated = THICKNESS - 5e-5  # overlapping by the slop: nothing falls
    bodies = [simulation.spawn(plank(0, seated * (level + 0.5))) for level in range(10)]
    run(simulation, 5)
    assert engine_pairs(simulation) == 10
    simulation.port.sleep(bodies)
    run(simulation, 1)
    assert engine_pairs(simulation) == 0
    simulation.port.wake(bodies[-1:])
    run(simulation, 1)
    assert engine_pairs(simulation) == 1


def test_a_brick_woken_after_its_support_left_stays_where_it_was() -> None:
    """Frozen in a deep overlap, it must not keep the push that was to cure it. No gravity: nothing else moves it."""
    simulation = opened(world=WEIGHTLESS)
    below = simulation.spawn(plank(0, 0.1))
    above = simulation.spawn(plank(0, 0.1 + THICKNESS - 0.002))
    run(simulation, 2)
    simulation.port.sleep([above])
    simulation.remove(below)
    before = simulation.poses()[1][0]
    simulation.port.wake([above])
    run(simulation, 10)
    np.testing.assert_array_equal(simulation.poses()[1][0], before)


def test_freezing_waking_and_removing_in_any_order_keeps_frozen_bricks_in_place() -> None:
    """Changes of type rebuild Chipmunk's lists; a stale one would move a brick, or end the process."""
    simulation = opened()
    port = simulation.port
    rng = np.random.default_rng(7)
    for level in range(12):
        for column in range(3):
            simulation.spawn(plank(column * (LENGTH + 0.002) + 0.03 * (level % 2), THICKNESS * (level + 0.5)))
    for _ in range(150):
        bodies = simulation.poses()[0]
        chosen = rng.choice(bodies, size=3, replace=False).tolist()
        [port.sleep, port.wake][rng.integers(2)](chosen)
        if rng.random() < 0.1:
            simulation.remove(chosen[0])
        frozen = np.isin(simulation.poses()[0], list(simulation.frozen))
        before = simulation.poses()[1][frozen]
        run(simulation, 1)
        contacts = port.contacts()
        live = port.masses().body
        assert (np.isin(contacts.body_a, live) | np.isin(contacts.body_b, live)).all()
        np.testing.assert_array_equal(simulation.poses()[1][frozen], before)
    assert np.isfinite(simulation.poses()[1]).all()


# -- settings ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("profile", PymunkSimulation.profiles)
def test_the_engine_has_the_recorded_settings(profile: str) -> None:
    simulation = opened(profile)
    for setting, knob in simulation.info.profile.knobs.items():
        assert getattr(simulation._engine.space, setting) == pytest.approx(knob.value)
    assert simulation._engine.space.damping == 1
    assert simulation._engine.space.sleep_time_threshold == math.inf
    assert simulation.info.unit_scale == 1000


@pytest.mark.parametrize("sleeping", ["native", "raised"])
def test_the_engines_own_sleep_ends_when_the_support_leaves(sleeping: str) -> None:
    simulation = opened(sleeping=sleeping)
    below, above = simulation.spawn(plank(0, THICKNESS / 2)), simulation.spawn(plank(0, 1.5 * THICKNESS))
    run(simulation, 60)
    assert simulation._engine.bodies[above].is_sleeping
    simulation.remove(below)
    run(simulation, 30)
    assert simulation.poses()[1][0, 2] == pytest.approx(THICKNESS / 2, abs=2e-4)


def test_a_brick_that_the_engine_put_to_sleep_can_be_frozen() -> None:
    simulation = opened(sleeping="native")
    bodies = [simulation.spawn(plank(0, THICKNESS * (level + 0.5))) for level in range(3)]
    run(simulation, 60)
    simulation.port.sleep(bodies[:1])
    before = simulation.poses()[1][0]
    run(simulation, 60)
    np.testing.assert_array_equal(simulation.poses()[1][0], before)
    simulation.port.wake(bodies[:1])
    run(simulation, 60)
    assert simulation.poses()[1][2, 2] == pytest.approx(2.5 * THICKNESS, abs=3e-4)
