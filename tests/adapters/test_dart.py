"""What is special to DART: wrappers that go by address, velocities kept by the adapter, rotation vectors."""

import math
from collections import Counter

import dartpy
import numpy as np
import pytest

from adapters import open_engine
from adapters._dart import DartSimulation
from adapters._dart_coordinates import coordinates_of, quaternions_of
from adapters.profile import Sleeping
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


COURSES, WIDTH = 19, 10
EDGE = 0.2


def wall(courses: int = COURSES) -> list[Brick]:
    """Courses of ten cubes in running bond, 1 cm apart, each 0.1 mm deep in the course below: 190 cubes in all."""
    pitch, height = EDGE + 0.01, EDGE - 1e-4
    places = [(x + 0.5 * (z % 2), z) for z in range(courses) for x in range(WIDTH)]
    return [Brick((EDGE,) * 3, 1.0, (x * pitch, 0.0, EDGE / 2 + z * height - 1e-4), level=z + 1) for x, z in places]


def listed(profile: str, bricks: list[Brick], expected: list[Brick]) -> Counter[tuple[int, int]]:
    """How many points DART lists of each pair, by its own limit: without a step, for the dense solver takes minutes."""
    simulation = open_engine("dart", profile, expected=expected)
    assert isinstance(simulation, DartSimulation)
    for brick in bricks:
        simulation.spawn(brick)
    found = dartpy.collision.CollisionResult()
    simulation._engine.world.checkCollision(simulation._engine.world.getConstraintSolver().getCollisionOption(), found)
    pairs = [(one.collisionObject2, one.collisionObject1) for one in found.getContacts()]
    counts = Counter((simulation._objects.body_of(a), simulation._objects.body_of(b)) for a, b in pairs)
    simulation.close()
    return counts


@pytest.mark.parametrize("profile", ["default", "game", "tuned"])
@pytest.mark.parametrize("is_expected", [True, False], ids=["expected", "unexpected"])
def test_190_cubes_in_contact_have_all_their_contacts(profile: str, is_expected: bool) -> None:
    """DART ships a limit of 1000 contacts. The lowest two courses alone stay below it: each course lists as many."""
    two = listed(profile, wall(2), [])
    whole = listed(profile, wall(), wall() if is_expected else [])
    on_ground = sum(points for pair, points in two.items() if -1 in pair)
    assert on_ground >= 4 * WIDTH
    assert whole.total() == on_ground + (COURSES - 1) * (two.total() - on_ground) > 1000


def test_a_frame_of_190_cubes_reports_all_their_contacts() -> None:
    """Four points of each pair in a step of the solver, too, to the core as to DART."""
    simulation = open_engine("dart", "game", expected=wall())
    assert isinstance(simulation, DartSimulation)
    for brick in wall():
        simulation.spawn(brick)
    port = simulation.port
    simulation.step(FRAME)
    raw, contacts = simulation._contacts(), port.contacts()
    pairs = Counter(zip(raw.body_a.tolist(), raw.body_b.tolist(), strict=True))
    assert set(pairs.values()) == {4}
    assert len(pairs) == WIDTH + (COURSES - 1) * (2 * WIDTH - 1)
    assert len(contacts) >= len(raw) == 4 * len(pairs)
    simulation.close()


def test_the_recorded_limit_is_the_one_that_dart_has() -> None:
    """So many contacts for each pair of bricks, and of a brick and the ground; never fewer than as shipped."""
    for expected, spawned, bricks in ((0, 1, 1), (190, 0, 190), (100, 101, 200)):
        simulation = open_engine("dart", "game", expected=wall()[:expected])
        assert isinstance(simulation, DartSimulation)
        for _ in range(spawned):
            simulation.spawn(plank(0.0, 1))
        recorded = simulation.info.profile.knobs["max_contacts"].value
        per_pair = int(str(recorded).removesuffix(" for each pair of bodies"))
        limit = simulation._engine.world.getConstraintSolver().getCollisionOption().maxNumContacts
        assert limit == max(1000, per_pair * bricks * (bricks + 1) // 2)
        simulation.close()


def test_a_limit_that_cannot_be_raised_is_reported(monkeypatch) -> None:
    monkeypatch.setattr("adapters._dart_limits._GETTER", "no such method")
    with pytest.raises(
        NotImplementedError, match=r"sets a limit of 145160 contacts .* limit of 1000 contacts: install"
    ):
        open_engine("dart", "game", expected=wall())


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


@pytest.mark.parametrize(("scale", "larger"), [(7.0, 7.0**3), (1.0, 1.0), (0.6, 1.0), (0.1, 6e-3)])
def test_the_solver_is_asked_for_as_many_digits_whatever_the_bricks_weigh(scale: float, larger: float) -> None:
    """Its tolerances are impulses.

    Those of a plank would cost all iterations in every step of a block of 4 kg, and exceed the weight of 12 mg.
    """
    length, width, thickness, mass = plank_of(scale)
    bricks = [Brick((length, width, thickness), factor * mass, (0.0, 0.0, thickness / 2)) for factor in (1.0, 6.0)]
    simulation = open_engine("dart", "tuned", expected=bricks)
    assert isinstance(simulation, DartSimulation)
    options = simulation._engine.world.getConstraintSolver().getMatrixFreeContactSolverOptions()
    assert options.mDeltaTolerance == pytest.approx(1e-7 * larger)
    assert options.mRelativeDeltaTolerance == pytest.approx(1e-7 * larger)
    simulation.close()


HALF = math.sqrt(0.5)


@pytest.mark.parametrize(
    "quaternion",
    [(1.0, 0.0, 0.0, 0.0), (HALF, 0.0, HALF, 0.0), (0.0, 0.6, 0.8, 0.0), (-0.5, 0.5, 0.5, 0.5), (1.0, 1e-9, 0.0, 0.0)],
)
def test_rotation_vectors_keep_the_orientation(quaternion: Quaternion) -> None:
    """There and back to rounding, up to the sign that leaves a rotation the same; half a turn and no turn included."""
    back = quaternions_of(coordinates_of((0.0, 0.0, 0.0), quaternion)[None, :3])[0]
    assert abs(back @ np.array(quaternion)) == pytest.approx(1.0, abs=1e-12)
    assert np.linalg.norm(back) == pytest.approx(1.0, abs=1e-12)
