"""What is special to DART: wrappers that go by address, velocities kept by the adapter, rotation vectors."""

import math

import numpy as np
import pytest

from adapters import open_engine
from adapters._dart import DartSimulation, _coordinates, _Motion, _quaternions
from adapters.base import Sleeping
from scenarios.model import Brick, Quaternion
from scenarios.planks import plank_of

PLANK = (0.117, 0.0234, 0.0078)
FRAME = 1 / 60


def plank(x: float, level: int) -> Brick:
    return Brick(PLANK, 0.0119, (x, 0.0, (level - 0.5) * PLANK[2]))


def test_contacts_name_the_right_bodies_however_often_bricks_come_and_go() -> None:
    """DART makes a new collision object where a removed one lay; it must not inherit the old one's id."""
    simulation = open_engine("dart", "game")
    port = simulation.port
    for _ in range(30):
        pair = {simulation.spawn(plank(0.0, level)) for level in (1, 2)}
        simulation.step(FRAME)
        contacts = port.contacts()
        assert set(contacts.body_a.tolist()) | set(contacts.body_b.tolist()) == {-1, *pair}
        for body in pair:
            simulation.remove(body)
    simulation.close()


def test_contacts_of_the_latest_step_outlive_the_removal_of_another_brick() -> None:
    """Removing a brick clears DART's list of contacts; those of the bricks that stay must still be reported."""
    simulation = open_engine("dart", "game")
    port = simulation.port
    stays, goes = simulation.spawn(plank(0.0, 1)), simulation.spawn(plank(0.3, 1))
    simulation.step(FRAME)
    simulation.remove(goes)
    assert len(simulation._contacts()) == 4, "as DART listed them"
    contacts = port.contacts()
    assert set(contacts.body_a.tolist()) | set(contacts.body_b.tolist()) == {-1, stays}
    simulation.close()


@pytest.mark.parametrize("sleeping", ["native", "raised"])
def test_the_engines_own_sleeping_stops_a_pile_at_rest(sleeping: Sleeping) -> None:
    """After 2 s at rest, well beyond DART's half second, nothing moves by a single bit; a push still wakes it."""
    simulation = open_engine("dart", "default", sleeping=sleeping)
    for level in (1, 2):
        simulation.spawn(plank(0.0, level))
    for _ in range(120):
        simulation.step(FRAME)
    asleep = simulation.poses()[1]
    for _ in range(10):
        simulation.step(FRAME)
    np.testing.assert_array_equal(simulation.poses()[1], asleep)
    simulation.push(1, (0.01, 0.0, 0.0))
    simulation.step(FRAME)
    assert simulation.poses()[1][1, 0] > 5e-3
    simulation.close()


@pytest.mark.parametrize(("scale", "larger"), [(7.0, 7.0**3), (1.0, 1.0), (0.5, 1.0)])
def test_the_solver_is_asked_for_as_many_digits_whatever_the_bricks_weigh(scale: float, larger: float) -> None:
    """Its tolerances are impulses: those of a plank would cost all iterations in every step of a block of 4 kg."""
    length, width, thickness, mass = plank_of(scale)
    bricks = [Brick((length, width, thickness), factor * mass, (0.0, 0.0, thickness / 2)) for factor in (1.0, 6.0)]
    simulation = open_engine("dart", "tuned", expected=bricks)
    assert isinstance(simulation, DartSimulation)
    options = simulation._world.getConstraintSolver().getMatrixFreeContactSolverOptions()
    assert options.mDeltaTolerance == pytest.approx(1e-7 * larger)
    assert options.mRelativeDeltaTolerance == pytest.approx(1e-7 * larger)
    simulation.close()


def test_fastest_approach_is_that_of_the_substep_in_which_the_bodies_closed_in_fastest() -> None:
    """A body that falls at 1, then 2, then 0.5 m/s on the ground came down at 2 m/s, whichever way the pair is named;
    its spin of 3 rad/s about y moves a point 0.1 m out along x by 0.3 m/s, downward."""
    rates = np.zeros((3, 1, 6))
    rates[:, 0, 5] = [-1.0, -2.0, -0.5]
    rates[:, 0, 1] = 3.0
    motion = _Motion((7,), np.array([[0.0, 0.0, 0.1]]), rates)
    body, ground = np.array([7]), np.array([-1])
    point, up = np.array([[0.1, 0.0, 0.1]]), np.array([[0.0, 0.0, 1.0]])
    np.testing.assert_allclose(motion.fastest_approach(ground, body, point, up), [[0.0, 0.0, -2.3]], atol=1e-12)
    np.testing.assert_allclose(motion.fastest_approach(body, ground, point, -up), [[0.0, 0.0, 2.3]], atol=1e-12)


HALF = math.sqrt(0.5)


@pytest.mark.parametrize(
    "quaternion",
    [(1.0, 0.0, 0.0, 0.0), (HALF, 0.0, HALF, 0.0), (0.0, 0.6, 0.8, 0.0), (-0.5, 0.5, 0.5, 0.5), (1.0, 1e-9, 0.0, 0.0)],
)
def test_rotation_vectors_keep_the_orientation(quaternion: Quaternion) -> None:
    """There and back to rounding, up to the sign that leaves a rotation the same; half a turn and no turn included."""
    back = _quaternions(_coordinates((0.0, 0.0, 0.0), quaternion)[None, :3])[0]
    assert abs(back @ np.array(quaternion)) == pytest.approx(1.0, abs=1e-12)
    assert np.linalg.norm(back) == pytest.approx(1.0, abs=1e-12)
