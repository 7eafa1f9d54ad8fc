"""What is special to Box3D: one length unit for a process, contacts found by a step of length 0, its own sleep."""

import numpy as np
import pytest
from robox3d._ffi import lib

from adapters import open_engine, profiles
from adapters._box3d import Box3dSimulation
from adapters.conformance.rig import (
    GRAVITY,
    MASS,
    PLANK,
    THICKNESS,
    advance,
    frozen_column,
    pairs,
    place_on,
    plank,
    pose,
)
from adapters.profile import Sleeping
from scenarios.model import World
from stability_core.port import GROUND


def opened(profile: str = "game", sleeping: Sleeping = "off", world: World | None = None) -> Box3dSimulation:
    simulation = open_engine("box3d", profile, sleeping=sleeping, world=world)
    assert isinstance(simulation, Box3dSimulation)
    return simulation


def fallen(simulation: Box3dSimulation, frames: int = 40) -> bytes:
    """Poses of a plank that topples over a frozen one, after some frames."""
    frozen_column(simulation, 1)
    simulation.spawn(plank(x=0.07, z=1.5 * THICKNESS))
    for _ in range(frames):
        simulation.step(simulation.info.frame_s)
    return simulation.poses()[1].tobytes()


# -- the length unit ---------------------------------------------------------------------------------


def test_a_world_of_another_unit_in_the_same_process_changes_nothing() -> None:
    alone = opened()
    expected = fallen(alone)
    alone.close()
    simulation, larger = opened(), open_engine("box3d", "game@scale=100")
    frozen_column(simulation, 1)
    simulation.spawn(plank(x=0.07, z=1.5 * THICKNESS))
    larger.spawn(plank())
    for _ in range(40):
        larger.step(larger.info.frame_s)
        simulation.step(simulation.info.frame_s)
    assert simulation.poses()[1].tobytes() == expected
    simulation.close()
    larger.close()


@pytest.mark.parametrize("profile", profiles("box3d"))
def test_the_engine_has_the_recorded_settings(profile: str) -> None:
    simulation = opened(profile)
    knobs = {name: knob.value for name, knob in simulation.info.profile.knobs.items()}
    assert lib.b3GetLengthUnitsPerMeter() == pytest.approx(knobs["lengthUnitsPerMeter"])
    recycled = knobs.get("contactRecycleDistance", 0.05 * float(knobs["lengthUnitsPerMeter"]))
    assert lib.b3World_GetContactRecycleDistance(simulation._engine.world) == pytest.approx(recycled)
    assert not lib.b3World_IsSleepingEnabled(simulation._engine.world)
    assert lib.b3World_GetWorkerCount(simulation._engine.world) <= 1
    simulation.close()


# -- contacts ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("profile", profiles("box3d"))
def test_reading_contacts_changes_no_bit_of_the_motion(profile: str) -> None:
    unobserved, observed = opened(profile), opened(profile)
    frozen_column(observed, 1)
    observed.spawn(plank(x=0.07, z=1.5 * THICKNESS))
    for _ in range(40):
        observed.step(observed.info.frame_s)
        observed.port.contacts()
    assert observed.poses()[1].tobytes() == fallen(unobserved)
    observed.close()
    unobserved.close()


def test_a_predicted_contact_is_no_contact_yet() -> None:
    simulation = opened(world=World(gravity=(0.0, 0.0, 0.0)))
    simulation.spawn(plank(z=THICKNESS / 2 + 0.5e-3))
    advance(simulation, 0.1)
    assert len(simulation.port.contacts()) == 0
    assert simulation._read().exists.sum() == 4
    simulation.close()


def test_contacts_keep_their_bodies_when_box3d_uses_a_shape_again() -> None:
    simulation = opened()
    first, second = simulation.spawn(plank(0.0)), simulation.spawn(plank(0.2))
    assert simulation.port.masses().body.tolist() == [first, second]
    advance(simulation, 0.1)
    shape = simulation._engine.shapes[first]
    simulation.remove(first)
    third = place_on(simulation, 0)
    assert simulation._engine.shapes[third] == shape
    advance(simulation, 0.5)
    assert pairs(simulation.port.contacts()) == {(GROUND, second), (GROUND, third)}
    simulation.close()


def test_contacts_of_many_bodies_are_read_whole() -> None:
    """More than there is room for at first, and each once."""
    simulation = opened()
    for row in range(20):
        for level in range(10):
            simulation.spawn(plank(x=0.15 * (row - 10), z=(level + 0.5) * THICKNESS))
    advance(simulation, 0.1)
    contacts = simulation.port.contacts()
    assert len(pairs(contacts)) == 200
    assert len(contacts) == 800
    simulation.close()


def test_forces_are_kept_where_box3d_drops_its_impulses() -> None:
    """Between planks that lie flush the points' features change in most steps."""
    simulation = opened()
    _ = simulation.port
    for level in range(3):
        simulation.spawn(plank(z=(level + 0.5) * THICKNESS))
    advance(simulation, 0.5)
    has_dropped = False
    for _ in range(20):
        simulation.step(simulation.info.frame_s)
        force = simulation.port.contacts().force
        assert force is not None
        assert np.abs(force[:, 2]).sum() == pytest.approx(6 * MASS * GRAVITY, rel=0.01)
        assert (np.abs(force[:, 2]) > 0.2 * MASS * GRAVITY).all()
        has_dropped |= bool((simulation._read().pressure == 0.0).any())
    assert has_dropped
    simulation.close()


# -- freezing ----------------------------------------------------------------------------------------


def test_inertia_is_that_of_a_plank_also_after_a_freeze() -> None:
    x, y, z = PLANK
    expected = [MASS / 12 * (y * y + z * z), MASS / 12 * (x * x + z * z), MASS / 12 * (x * x + y * y)]
    simulation = opened()
    body = simulation.spawn(plank())
    for _ in range(2):
        data = lib.b3Body_GetMassData(simulation._engine.handles[body])
        assert data.mass == pytest.approx(MASS)
        assert [data.inertia.cx.x, data.inertia.cy.y, data.inertia.cz.z] == pytest.approx(expected, rel=1e-5)
        simulation.port.sleep([body])
        advance(simulation, 0.1)
        simulation.port.wake([body])
    simulation.close()


@pytest.mark.parametrize(("sleeping", "threshold"), [("off", 0.005), ("native", 0.005), ("raised", 0.02)])
def test_the_engines_own_sleep_ends_when_the_support_leaves(sleeping: Sleeping, threshold: float) -> None:
    simulation = opened(sleeping=sleeping)
    (support,) = frozen_column(simulation, 1)
    body = place_on(simulation, 1)
    advance(simulation, 2.0)
    handle = simulation._engine.handles[body]
    assert lib.b3Body_GetSleepThreshold(handle) == pytest.approx(threshold)
    assert lib.b3Body_IsAwake(handle) == (sleeping == "off")
    simulation.remove(support)
    advance(simulation, 0.5)
    assert pose(simulation, body)[2] == pytest.approx(THICKNESS / 2, abs=1e-4)
    simulation.close()


# -- divergence --------------------------------------------------------------------------------------


def test_a_state_that_is_not_finite_is_reported_as_diverged() -> None:
    """Box3D's next step, and its next search for contacts, would never end."""
    simulation = opened()
    body = simulation.spawn(plank())
    _ = simulation.port
    lib.b3Body_SetLinearVelocity(simulation._engine.handles[body], (float("nan"), 0.0, 0.0))
    advance(simulation, 0.1)
    simulation.port.contacts()
    assert np.isnan(simulation.poses()[1]).all()
    simulation.close()
    another = opened()
    body = place_on(another, 0)
    advance(another, 0.5)
    assert pose(another, body)[2] == pytest.approx(THICKNESS / 2, abs=1e-4)
    another.close()
