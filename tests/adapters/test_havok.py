"""What is special to Havok: hulls instead of rounded boxes, a larger world, sleep that cannot be tuned."""

import numpy as np
import pytest

from adapters import EngineNotInstalledError, check_installed, open_engine, profile_named, profiles, wasm
from adapters._havok import HavokSimulation
from adapters.base import Simulation
from adapters.bridge.errors import PeerError
from adapters.bridge.external import ExternalEntry, describe
from adapters.conformance import CHECKS
from adapters.conformance.rig import LENGTH, THICKNESS, WIDTH, advance, frozen_column, place_on, plank, pose
from adapters.profile import Knob, Profile, Sleeping
from adapters.profile_variants import profile_of
from adapters.scaled import scaled
from bench.studies.plan import Trial
from bench.studies.schema import Limits
from bench.trial.run_trial import run_trial
from scenarios.model import World


@pytest.fixture
def havok() -> None:
    try:
        check_installed("havok")
    except EngineNotInstalledError as error:
        pytest.skip(str(error))


needs_havok = pytest.mark.usefixtures("havok")


@needs_havok
def test_the_process_says_what_is_described_without_it() -> None:
    said = describe(ExternalEntry("havok", tuple(HavokSimulation.command()), wasm.FOLDER))
    assert said == wasm.description("havok")


@needs_havok
def test_a_setting_that_havok_does_not_have_is_refused() -> None:
    profile = HavokSimulation.profiles["game"].with_knobs({"iterations": Knob(50, "Havok has no such number")})
    with pytest.raises(PeerError, match="the engine reports an error: Havok has no setting 'iterations'"):
        HavokSimulation(profile, World(), "off", ())


def test_a_profile_of_a_larger_world_is_scaled_to_the_size_that_is_asked_for() -> None:
    assert profiles("havok")["game"].scale == 10.0
    assert profile_of(HavokSimulation, "game@scale=100").scale == 100.0
    assert profile_named("bullet", "game@scale=10").scale == 10.0


@needs_havok
@pytest.mark.parametrize(("shape", "inside"), [("hull", 0.1e-3), ("box", 1.5e-3)])
def test_contact_points_lie_inside_the_edges_as_far_as_the_shape_is_rounded(shape: str, inside: float) -> None:
    """A box by half its thickness, at most by 15 mm, which are 1.5 mm in a world ten times larger."""
    profile = HavokSimulation.profiles["game"].with_knobs({"shape": Knob(shape, "to see how it is rounded")})
    simulation = open_with(profile)
    _ = simulation.port
    simulation.spawn(plank(z=THICKNESS / 2 - 0.2e-3))
    simulation.step(simulation.info.frame_s)
    point = simulation._contacts().point
    assert np.abs(point[:, 0]).max() == pytest.approx(LENGTH / 2 - inside, abs=0.1e-3)
    assert np.abs(point[:, 1]).max() == pytest.approx(WIDTH / 2 - inside, abs=0.1e-3)
    simulation.close()


@needs_havok
def test_a_pusher_is_seen_that_an_early_substep_has_stopped() -> None:
    """With 16 substeps the last one has a cube at rest, and Havok lists no contact of it."""
    check = next(check for check in CHECKS if check.name == "shows_pushes_against_a_frozen_brick")
    check.run("havok", "tuned")


def open_with(profile: Profile) -> Simulation:
    return scaled(HavokSimulation)(profile, World(), "off", ())


@needs_havok
@pytest.mark.parametrize("sleeping", ["off", "native"])
def test_the_engines_own_sleep_ends_when_the_support_leaves(sleeping: Sleeping) -> None:
    simulation = open_engine("havok", "game", sleeping=sleeping)
    (support,) = frozen_column(simulation, 1)
    body = place_on(simulation, 1)
    advance(simulation, 2.0)
    simulation.remove(support)
    advance(simulation, 0.5)
    assert pose(simulation, body)[2] == pytest.approx(THICKNESS / 2, abs=2e-4)
    simulation.close()


@needs_havok
def test_its_threshold_of_sleeping_cannot_be_raised() -> None:
    trial = Trial("havok", "game", "plank_tower", "plank_tower-1", {"levels": 1}, "raised", 0, 0)
    record = run_trial(trial, Limits(trial_wall_s=60), "abc", lambda _: None).record
    assert record.status == "unsupported"
    assert "API cannot set the threshold" in record.message


@needs_havok
def test_events_of_many_points_are_read_one_by_one() -> None:
    """They share one place in memory: read all at once each would be the last."""
    simulation = open_engine("havok", "game")
    _ = simulation.port
    for i in range(5):
        simulation.spawn(plank(x=0.2 * i, z=THICKNESS / 2 - 0.2e-3))
    simulation.step(simulation.info.frame_s)
    contacts = simulation.port.contacts()
    for i in range(5):
        mine = contacts.point[(contacts.body_a == i) | (contacts.body_b == i)]
        assert len(np.unique(np.round(mine, 4), axis=0)) >= 4
        assert np.abs(mine[:, 0] - 0.2 * i).max() == pytest.approx(LENGTH / 2, abs=0.3e-3)
    simulation.close()
