"""Adapters of other releases: settings that a release lacks are left out and named, and the locked ones lack none."""

import importlib.util

import pytest

from adapters import missing_knobs
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
