"""What is special to Jolt: Node, the memory of its objects, its slop, its ridges, and a host that must wake bodies."""

import importlib.util
import json

import numpy as np
import pytest

from adapters import EngineNotInstalledError, check_installed, engine_version, open_engine, wasm
from adapters._jolt import JoltSimulation
from adapters.bridge.errors import PeerError
from adapters.bridge.external import ExternalEntry, describe
from adapters.conformance.rig import THICKNESS, advance, frozen_column, place_on, plank, pose
from adapters.profile import Knob, Sleeping
from bench.studies.plan import Trial
from bench.studies.schema import Limits
from bench.trial.run_trial import run_trial
from scenarios.model import World


@pytest.fixture
def jolt() -> None:
    try:
        check_installed("jolt")
    except EngineNotInstalledError as error:
        pytest.skip(str(error))


needs_jolt = pytest.mark.usefixtures("jolt")


def opened(profile: str = "game", sleeping: Sleeping = "off") -> JoltSimulation:
    simulation = open_engine("jolt", profile, sleeping=sleeping)
    assert isinstance(simulation, JoltSimulation)
    return simulation


# -- installation ------------------------------------------------------------------------------------


def test_without_node_the_engine_is_described_and_its_one_command_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda _: None)
    assert engine_version("jolt") == "1.1.0"
    with pytest.raises(EngineNotInstalledError, match=r"Node is missing.*: uv run --group wasm -m adapters\.wasm$"):
        open_engine("jolt")


def test_a_package_of_another_version_is_not_used(tmp_path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(wasm, "FOLDER", tmp_path)
    monkeypatch.setattr(wasm, "node", lambda: tmp_path)
    with pytest.raises(EngineNotInstalledError, match="the npm package jolt-physics is missing"):
        check_installed("jolt")
    package = tmp_path / "node_modules" / "jolt-physics" / "package.json"
    package.parent.mkdir(parents=True)
    package.write_text('{"version": "0.9.0"}')
    with pytest.raises(EngineNotInstalledError, match=r"jolt-physics must have version 1\.1\.0, got 0\.9\.0"):
        check_installed("jolt")


@needs_jolt
def test_the_process_says_what_is_described_without_it() -> None:
    said = describe(ExternalEntry("jolt", tuple(JoltSimulation.command()), wasm.FOLDER))
    assert said == wasm.description("jolt")
    lock = json.loads((wasm.FOLDER / "package-lock.json").read_text())
    assert said.version == lock["packages"]["node_modules/jolt-physics"]["version"]


# -- settings ----------------------------------------------------------------------------------------


@needs_jolt
def test_a_setting_that_jolt_does_not_have_is_refused() -> None:
    profile = JoltSimulation.profiles["game"].with_knobs({"mSlop": Knob(1.0, "a spelling mistake")})
    with pytest.raises(PeerError, match="the engine reports an error: Jolt has no setting 'mSlop'"):
        JoltSimulation(profile, World(), "off", ())


@needs_jolt
@pytest.mark.parametrize(("profile", "sinks"), [("default", True), ("game", False)])
def test_an_overlap_below_the_slop_stays(profile: str, sinks: bool) -> None:
    """3 mm between planks of 7.8 mm: less than 20 mm, the slop as shipped."""
    simulation = opened(profile)
    body = simulation.spawn(plank(z=THICKNESS / 2 - 3e-3))
    advance(simulation, 1.0)
    assert (pose(simulation, body)[2] < THICKNESS / 2 - 2.5e-3) == sinks
    simulation.close()


# -- freezing ----------------------------------------------------------------------------------------


@needs_jolt
def test_reading_contacts_changes_no_bit_of_the_motion() -> None:
    ends = []
    for is_read in (False, True):
        simulation = opened("tuned")
        frozen_column(simulation, 1)
        simulation.spawn(plank(x=0.07, z=1.5 * THICKNESS))
        for _ in range(40):
            simulation.step(simulation.info.frame_s)
            if is_read:
                simulation.port.contacts()
        ends.append(simulation.poses()[1].tobytes())
        simulation.close()
    assert ends[0] == ends[1]


@needs_jolt
@pytest.mark.parametrize("sleeping", ["off", "native", "raised"])
def test_the_engines_own_sleep_ends_when_the_support_leaves(sleeping: Sleeping) -> None:
    simulation = opened(sleeping=sleeping)
    (support,) = frozen_column(simulation, 1)
    body = place_on(simulation, 1)
    advance(simulation, 2.0)
    before = pose(simulation, body)
    simulation.step(simulation.info.frame_s)
    if sleeping != "off":
        assert pose(simulation, body).tobytes() == before.tobytes()
    simulation.remove(support)
    advance(simulation, 0.5)
    assert pose(simulation, body)[2] == pytest.approx(THICKNESS / 2, abs=2e-4)
    simulation.close()


# -- what a trial sees -------------------------------------------------------------------------------


@needs_jolt
def test_a_flat_v_holds_where_the_normal_at_the_ridge_is_that_of_the_edges() -> None:
    """At 55 deg friction of 0.45 holds the feet, and a ridge whose normal is a face's would need 0.70."""
    trial = Trial("jolt", "game", "card_house", "v", {"storeys": 1, "theta": 55.0}, "none", 0, 0)
    record = run_trial(trial, Limits(trial_wall_s=60), "abc", lambda _: None).record
    assert (record.status, record.height_levels) == ("completed", 1)


@needs_jolt
def test_a_state_that_is_not_finite_is_reported_as_diverged() -> None:
    simulation = opened()
    body = simulation.spawn(plank())
    _ = simulation.port
    simulation._commands.append((5, body, float("nan"), 0.0, 0.0))
    simulation.step(simulation.info.frame_s)
    simulation.step(simulation.info.frame_s)
    assert np.isnan(simulation.poses()[1]).any()
    assert len(simulation.port.contacts()) == 0
    simulation.close()
