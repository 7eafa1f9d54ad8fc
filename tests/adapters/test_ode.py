"""What is special to ODE: two libraries, a seed for a process, a pyramid of friction, sleep that nothing ends."""

import importlib.util
import math
import sys

import numpy as np
import pytest

from adapters import EngineNotInstalledError, capabilities, check_installed, engine_version, open_engine, profiles
from adapters._ode import OdeSimulation
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


@pytest.fixture
def ode() -> None:
    try:
        check_installed("ode")
    except EngineNotInstalledError as error:
        pytest.skip(str(error))


needs_ode = pytest.mark.usefixtures("ode")


def opened(profile: str = "game", sleeping: Sleeping = "off", world: World | None = None) -> OdeSimulation:
    simulation = open_engine("ode", profile, sleeping=sleeping, world=world)
    assert isinstance(simulation, OdeSimulation)
    return simulation


def topple(simulation: OdeSimulation) -> None:
    """Add a plank that topples over a frozen one."""
    frozen_column(simulation, 1)
    simulation.spawn(plank(x=0.07, z=1.5 * THICKNESS))


def fallen(simulation: OdeSimulation, frames: int = 40) -> bytes:
    """Poses of a plank that topples over a frozen one, after some frames."""
    topple(simulation)
    for _ in range(frames):
        simulation.step(simulation.info.frame_s)
    return simulation.poses()[1].tobytes()


# -- the library -------------------------------------------------------------------------------------


def test_without_a_library_the_engine_is_described_and_the_fix_is_named(monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, "adapters._ode_library", None)
    assert capabilities("ode").freeze.startswith("disabled body")
    assert set(profiles("ode")) == {"default", "game", "tuned"}
    with pytest.raises(EngineNotInstalledError, match=r"engine 'ode' cannot be loaded .*: uv sync --group ode$"):
        open_engine("ode")


@needs_ode
def test_missing_libraries_are_named(monkeypatch) -> None:
    from adapters import _ode_library

    monkeypatch.setattr(_ode_library, "_DEBIAN", "libode.so.none")
    monkeypatch.setattr(importlib.util, "find_spec", lambda _: None)
    with pytest.raises(ImportError, match=r"neither is installed; install libode\.so\.none, or the version of panda3d"):
        _ode_library._opened()


@needs_ode
def test_the_version_says_the_precision() -> None:
    from adapters._ode_library import REAL

    precision = {4: "single precision", 8: "double precision"}[REAL.itemsize]
    assert engine_version("ode").endswith(precision)


# -- the world ---------------------------------------------------------------------------------------


@needs_ode
def test_another_world_of_the_process_changes_nothing() -> None:
    """The solver orders constraints by a random number whose seed all worlds share."""
    alone = opened()
    expected = fallen(alone)
    alone.close()
    simulation, other = opened(), opened("default")
    topple(simulation)
    other.spawn(plank())
    for _ in range(40):
        other.step(other.info.frame_s)
        simulation.step(simulation.info.frame_s)
    assert simulation.poses()[1].tobytes() == expected
    simulation.close()
    other.close()


@needs_ode
@pytest.mark.parametrize("profile", profiles("ode"))
def test_reading_and_finding_contacts_changes_no_bit_of_the_motion(profile: str) -> None:
    unobserved, observed = opened(profile), opened(profile)
    topple(observed)
    for _ in range(40):
        observed.step(observed.info.frame_s)
        observed.port.contacts()
        observed.find_contacts()
    assert observed.poses()[1].tobytes() == fallen(unobserved)
    observed.close()
    unobserved.close()


@needs_ode
def test_contacts_of_many_bodies_are_read_whole() -> None:
    """More pairs and points than there is room for at first."""
    simulation = opened()
    _ = simulation.port
    for row in range(20):
        for level in range(10):
            simulation.spawn(plank(x=0.15 * (row - 10), z=(level + 0.5) * THICKNESS - 1e-4 * (level + 1)))
    simulation.step(simulation.info.frame_s)
    assert len(pairs(simulation.port.contacts())) == 200
    simulation.close()


@needs_ode
def test_friction_is_a_pyramid_that_holds_more_along_a_diagonal() -> None:
    """Along both axes at once it holds up to sqrt(2) mu."""
    for over_mu, holds in ((1.2, True), (1.6, False)):
        pull = over_mu * 0.45 * GRAVITY / math.sqrt(2)
        simulation = opened(world=World(gravity=(pull, pull, -GRAVITY)))
        body = simulation.spawn(plank())
        advance(simulation, 0.3)
        start = pose(simulation, body)[:2]
        advance(simulation, 0.3)
        slid = float(np.linalg.norm(pose(simulation, body)[:2] - start))
        assert (slid < 1e-3) == holds
        simulation.close()


# -- freezing and sleep ------------------------------------------------------------------------------


@needs_ode
def test_inertia_is_that_of_a_plank_also_after_a_freeze() -> None:
    from adapters._ode_library import Mass, lib

    x, y, z = PLANK
    expected = [MASS / 12 * (y * y + z * z), MASS / 12 * (x * x + z * z), MASS / 12 * (x * x + y * y)]
    simulation = opened()
    body = simulation.spawn(plank())
    for _ in range(2):
        mass = Mass()
        lib.dBodyGetMass(simulation._engine.handles[body], mass)
        assert mass.mass == pytest.approx(MASS)
        assert [mass.inertia[k] for k in (0, 5, 10)] == pytest.approx(expected, rel=1e-5)
        simulation.port.sleep([body])
        advance(simulation, 0.1)
        simulation.port.wake([body])
    simulation.close()


@needs_ode
@pytest.mark.parametrize(("sleeping", "threshold"), [("off", 0.01), ("native", 0.01), ("raised", 0.04)])
def test_the_engines_own_sleep_does_not_end_when_the_support_leaves(sleeping: Sleeping, threshold: float) -> None:
    simulation = opened(sleeping=sleeping)
    (support,) = frozen_column(simulation, 1)
    body = place_on(simulation, 1)
    advance(simulation, 2.0)
    before = pose(simulation, body)[2]
    knobs = simulation.info.profile.values
    assert knobs.get("AutoDisableLinearThreshold", 0.01) == threshold
    simulation.remove(support)
    advance(simulation, 0.5)
    is_asleep = sleeping != "off"
    # 0.2 mm: it rests 0.1 mm deep, which is the profile's ContactSurfaceLayer.
    assert pose(simulation, body)[2] == (before if is_asleep else pytest.approx(THICKNESS / 2, abs=2e-4))
    simulation.push(body, (0.0, 0.0, -1e-3 * MASS))
    advance(simulation, 0.5)
    # 0.5 mm: with its threshold raised it falls asleep again before it is pushed out of the ground.
    assert pose(simulation, body)[2] == pytest.approx(THICKNESS / 2, abs=5e-4)
    simulation.close()


# -- divergence --------------------------------------------------------------------------------------


@needs_ode
@pytest.mark.parametrize("speed", [math.nan, 1e15])
def test_a_state_that_is_not_finite_is_reported_as_diverged(speed: float) -> None:
    """ODE's next step would end the process."""
    simulation = opened()
    body = simulation.spawn(plank())
    _ = simulation.port
    simulation._engine.set_velocity(body, (speed, 0.0, 0.0))
    advance(simulation, 0.1)
    simulation.port.contacts()
    simulation.find_contacts()
    assert np.isnan(simulation.poses()[1]).all()
    simulation.close()
