"""Adapters of other releases: settings that a release lacks are left out and named, and the locked ones lack none."""

import importlib.util
import math

import mujoco
import numpy as np
import pytest

from adapters import EngineNotInstalledError, missing_knobs, open_engine
from adapters.conformance.rig import plank
from adapters.engines import Entry
from adapters.profile_files import load_settings
from stability_core.ports import mujoco_release


@pytest.mark.parametrize(("engine", "package"), [("mujoco", "mujoco"), ("dart", "dartpy")])
def test_the_locked_release_has_every_setting(engine, package) -> None:
    if importlib.util.find_spec(package) is None:
        pytest.skip(f"{package} is not installed")
    assert missing_knobs(engine) == []


def test_a_missing_setting_is_in_no_profile_and_is_named() -> None:
    whole = load_settings("mujoco")
    settings = load_settings("mujoco", missing=("flag.speculative", "sleep", "never_was"))
    assert settings.missing == {"flag.speculative", "sleep"}
    assert "flag.speculative" in whole.profiles["game"].knobs
    assert all("flag.speculative" not in profile.knobs for profile in settings.profiles.values())
    assert all("sleep" not in knobs for knobs in settings.sleep_knobs.values())


@pytest.mark.parametrize(
    ("sums", "beyond", "expected"),
    [
        (True, True, {"gap": 1e-4}),
        (True, False, {"gap": 1e-4, "margin": 1e-4}),  # listed below margin, with force below margin - gap = 0
        (False, False, {"gap": 2e-4, "margin": 2e-4}),  # of two gaps the larger counts
    ],
)
def test_two_bodies_list_contacts_at_the_same_distance_in_every_release(monkeypatch, sums, beyond, expected) -> None:
    monkeypatch.setattr(mujoco_release, "_SUMS_GAPS", sums)
    monkeypatch.setattr(mujoco_release, "_LISTS_BEYOND_MARGIN", beyond)
    assert mujoco_release.detection_attributes(1e-4) == expected


def test_a_silent_reset_of_an_early_release_is_seen_as_a_divergence() -> None:
    model = mujoco.MjModel.from_xml_string(
        "<mujoco><worldbody><body><freejoint/><geom size='1'/></body></worldbody></mujoco>"
    )
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data)
    assert not mujoco_release.has_reset(data)
    data.qvel[2] = math.nan
    mujoco.mj_step(model, data)
    assert math.isfinite(data.qvel[2])  # as shipped, MuJoCo has put the world back
    assert mujoco_release.has_reset(data)


def test_poses_after_a_silent_reset_are_not_finite(monkeypatch) -> None:
    monkeypatch.setattr("adapters._mujoco.HAS_AUTORESET", False)
    monkeypatch.setattr("adapters._mujoco.has_reset", lambda _: True)
    simulation = open_engine("mujoco", "game", expected=[plank()])
    try:
        simulation.spawn(plank())
        simulation.step(simulation.info.frame_s)
        assert not np.isfinite(simulation.poses()[1]).any()
    finally:
        simulation.close()


def test_a_release_that_the_adapter_cannot_use_is_named(monkeypatch) -> None:
    def load(self):
        raise ImportError("cannot import name 'batch' from 'pymunk'")

    monkeypatch.setattr(Entry, "load", load)
    with pytest.raises(
        EngineNotInstalledError,
        match=r"'pymunk' cannot be loaded with pymunk [\d.]+ \(cannot .*\): install .* another release",
    ):
        open_engine("pymunk")
