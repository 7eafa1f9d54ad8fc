"""What is special to Rapier: single precision, contacts kept from earlier steps, its own sleep, its quarantine."""

import numpy as np
import pytest

from adapters import open_engine
from adapters._rapier import RapierSimulation
from adapters.conformance.rig import MASS, PLANK, THICKNESS, advance, frozen_column, pairs, place_on, plank, pose
from adapters.profile import Sleeping
from scenarios.model import Brick, World
from stability_core.port import GROUND
from stability_core.ports.rapier_calls import local_points
from tests.scenarios.played import played


def opened(profile: str = "game", sleeping: Sleeping = "off", world: World | None = None) -> RapierSimulation:
    simulation = open_engine("rapier", profile, sleeping=sleeping, world=world)
    assert isinstance(simulation, RapierSimulation)
    return simulation


# -- freezing ----------------------------------------------------------------------------------------


def test_no_rotation_creeps_while_frozen() -> None:
    """Scaled to unit length over and over, one quaternion in fifty or so would change in its last bit."""
    simulation = opened(world=World(gravity=(0.0, 0.0, 0.0)))
    hand = np.random.default_rng(0)
    for number in range(400):
        w, x, y, z = hand.normal(size=4)
        length = float(np.linalg.norm((w, x, y, z)))
        turned = (w / length, x / length, y / length, z / length)
        body = simulation.spawn(Brick(PLANK, MASS, (0.0, 0.0, 1.0 + 0.3 * number), turned))
        simulation._views[body].angvel = tuple(hand.normal(size=3))  # type: ignore[assignment]
    advance(simulation, 0.2)
    simulation.port.sleep(range(400))
    before = simulation.poses()
    for _ in range(20):
        advance(simulation, 1 / 60)
        for now, then in zip(simulation.poses(), before, strict=True):
            np.testing.assert_array_equal(now, then)
    simulation.close()


def test_frozen_bodies_are_not_visited_once_nothing_is_live() -> None:
    """They are then fixed copies: Rapier keeps a body whose type is changed among its active ones."""
    simulation = opened()
    bodies = frozen_column(simulation, 3)
    before = simulation.poses()
    advance(simulation, 0.5)
    assert not simulation._engine.world.active_bodies()
    assert not list(simulation._engine.world.narrow_phase.contact_pairs())
    for now, then in zip(simulation.poses(), before, strict=True):
        np.testing.assert_array_equal(now, then)
    top = place_on(simulation, 3)
    advance(simulation, 0.5)
    assert len(simulation._engine.world.active_bodies()) == 1
    assert pairs(simulation.port.contacts()) == {(bodies[-1], top)}
    simulation.close()


def test_a_fixed_copy_that_is_unfrozen_finds_its_contacts_again() -> None:
    simulation = opened()
    frozen_column(simulation, 3)
    bodies = list(simulation.bricks)
    advance(simulation, 0.1)
    before = simulation.poses()[1]
    simulation.port.wake(bodies)
    advance(simulation, 1.0)
    assert pairs(simulation.port.contacts()) == {(GROUND, bodies[0]), (bodies[0], bodies[1]), (bodies[1], bodies[2])}
    np.testing.assert_allclose(simulation.poses()[1], before, atol=1e-3)
    simulation.port.sleep(bodies)
    advance(simulation, 0.1)
    simulation.remove(bodies[0])
    simulation.move(bodies[2], (0.2, 0.0, 0.1), (1.0, 0.0, 0.0, 0.0))
    simulation.port.wake(bodies[1:])
    advance(simulation, 1.0)
    assert pose(simulation, bodies[1])[2] == pytest.approx(THICKNESS / 2, abs=1e-3)
    assert pose(simulation, bodies[2])[2] == pytest.approx(THICKNESS / 2, abs=1e-3)
    simulation.close()


def test_a_live_body_keeps_its_contacts_while_what_carries_it_freezes() -> None:
    """A copy made meanwhile would take the impulses from them that the solver starts from."""
    simulation = opened()
    (support,) = frozen_column(simulation, 1)
    body = place_on(simulation, 1)
    handle = simulation._engine.handles[support]
    simulation.port.wake([support])
    simulation.port.sleep([support])
    advance(simulation, 0.5)
    assert simulation._engine.handles[support] == handle
    assert pairs(simulation.port.contacts()) == {(support, body)}
    simulation.close()


def test_inertia_is_that_of_a_plank_also_after_a_freeze() -> None:
    x, y, z = PLANK
    expected = [MASS / 12 * (y * y + z * z), MASS / 12 * (x * x + z * z), MASS / 12 * (x * x + y * y)]
    simulation = opened()
    body = simulation.spawn(plank())
    for _ in range(2):
        inertia = simulation._views[body].mass_properties.principal_inertia.to_tuple()
        assert inertia == pytest.approx(expected, rel=1e-5)
        simulation.port.sleep([body])
        advance(simulation, 0.1)
        simulation.port.wake([body])
    simulation.close()


# -- contacts ----------------------------------------------------------------------------------------


def test_separations_are_those_of_the_present_poses() -> None:
    """Rapier keeps the distance at which it first found a contact: here the half millimetre of its drop."""
    simulation = opened()
    body = place_on(simulation, 0)
    advance(simulation, 1.0)
    listed = [
        point.dist
        for pair in simulation._engine.world.narrow_phase.contact_pairs()
        for manifold in pair.manifolds
        for point in manifold.points
    ]
    assert min(listed) > 0.1e-3
    depth = THICKNESS / 2 - pose(simulation, body)[2]
    np.testing.assert_allclose(simulation.port.contacts().separation, -depth, atol=1e-7)
    simulation.close()


def test_a_predicted_contact_is_no_contact_yet() -> None:
    simulation = opened(world=World(gravity=(0.0, 0.0, 0.0)))
    simulation.spawn(plank(z=THICKNESS / 2 + 0.5e-3))
    advance(simulation, 0.1)
    assert len(local_points(simulation._live_pairs(simulation._engine.world.narrow_phase))[0]) > 0
    assert len(simulation.port.contacts()) == 0
    simulation.close()


def test_contacts_keep_their_bodies_when_rapier_uses_a_place_again() -> None:
    simulation = opened()
    first, second = simulation.spawn(plank(0.0)), simulation.spawn(plank(0.2))
    assert simulation.port.masses().body.tolist() == [first, second]
    advance(simulation, 0.1)
    simulation.remove(first)
    third = place_on(simulation, 0)
    assert pairs(simulation.port.contacts()) == {(GROUND, second)}
    advance(simulation, 0.5)
    assert pairs(simulation.port.contacts()) == {(GROUND, second), (GROUND, third)}
    simulation.close()


def test_only_the_pairs_of_live_bricks_are_read() -> None:
    simulation = opened()
    frozen_column(simulation, 25, xs=(0.0, 0.2, 0.4, 0.6))
    place_on(simulation, 25)
    advance(simulation, 0.5)
    assert (
        sum(
            1
            for _, _, pair in simulation._live_pairs(simulation._engine.world.narrow_phase)
            if any(one.points for one in pair.manifolds)
        )
        == 1
    )
    simulation.close()


# -- settings ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("profile", RapierSimulation.profiles)
def test_the_engine_has_the_recorded_settings(profile: str) -> None:
    simulation = opened(profile)
    assert simulation._engine.world.num_threads == 1
    for name, knob in simulation.info.profile.knobs.items():
        if name not in ("num_threads", "body.can_sleep"):
            value = simulation._engine.world.integration_parameters
            for part in name.split("."):
                value = getattr(value, part)
            assert value == pytest.approx(knob.value)
    simulation.close()


@pytest.mark.parametrize(
    ("sleeping", "thresholds"), [("off", (-1.0, -1.0)), ("native", (0.05, 0.5)), ("raised", (0.2, 2.0))]
)
def test_the_engines_own_sleep_ends_when_the_support_leaves(
    sleeping: Sleeping, thresholds: tuple[float, float]
) -> None:
    simulation = opened(sleeping=sleeping)
    (support,) = frozen_column(simulation, 1)
    body = place_on(simulation, 1)
    advance(simulation, 2.0)
    view = simulation._views[body]
    assert (view.activation.linear_threshold, view.activation.angular_threshold) == pytest.approx(thresholds)
    assert view.is_sleeping == (sleeping != "off")
    simulation.remove(support)
    advance(simulation, 0.5)
    assert pose(simulation, body)[2] == pytest.approx(THICKNESS / 2, abs=1e-4)
    simulation.close()


def test_a_state_that_rapier_put_back_is_reported_as_diverged() -> None:
    simulation = opened()
    body = simulation.spawn(plank())
    simulation._views[body].linvel = (float("inf"), 0.0, 0.0)  # type: ignore[assignment]
    advance(simulation, 0.1)
    assert np.isnan(simulation.poses()[1]).all()
    simulation.close()


def test_pieces_that_touch_in_a_point_have_no_contact_without_a_normal() -> None:
    """The centring of an arch is a compound of pieces; Parry gives some of its contacts a normal of length 0."""
    record = played("rapier", "tuned", "voussoir_arch", {"voussoirs": 7}, "equilibrium")
    assert record.status == "completed", record.message
