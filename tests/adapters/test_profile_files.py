"""Every engine's file of profiles loads and gives its reasons; a mistake in a file is named with its place and fix."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from adapters import ENGINES, profiles
from adapters.profile_files import FOLDER, ProfileFileError, load_settings

GOOD = """
[shared.stiff]
erp = { value = 0.4, reason = "seats in a second" }
[profiles.default]
description = "as shipped"
substeps = 4
[profiles.game]
description = "cheap"
substeps = 1
frame_s = 0.02
tuned_by = "us, on a tower"
shared = ["stiff"]
knobs.margin = { value = 1e-3, reason = "the shipped one exceeds a plank", follows_world = true }
[sleeping.off]
sleep = { value = false, reason = "its own sleeping is off" }
"""


def load(folder: Path, text: str, **options):
    (folder / "some.toml").write_text(text, encoding="utf-8")
    return load_settings("some", folder=folder, **options)


@pytest.mark.parametrize("engine", ENGINES)
def test_an_engines_profiles_load_and_give_their_reasons(engine: str) -> None:
    settings = load_settings(engine)
    assert {"default", "game", "tuned"} <= set(settings.profiles)
    assert settings.profiles == profiles(engine), "what is in the file is what runs"
    every = [*(profile.knobs for profile in settings.profiles.values()), *settings.sleep_knobs.values()]
    assert all(knob.reason.strip() for knobs in every for knob in knobs.values())
    for name, profile in settings.profiles.items():
        assert profile.name == name
        assert profile.description
        assert (profile.tuned_by == "as shipped") == (name == "default")


def test_every_file_is_an_engines() -> None:
    assert {path.stem for path in FOLDER.iterdir()} == set(ENGINES)


def test_a_file_is_read_with_its_shared_knobs(tmp_path) -> None:
    settings = load(tmp_path, GOOD)
    default, game = settings.profiles["default"], settings.profiles["game"]
    assert (default.substeps, default.frame_s, default.tuned_by, dict(default.knobs)) == (4, 1 / 60, "as shipped", {})
    assert (game.substeps, game.frame_s, game.tuned_by) == (1, 0.02, "us, on a tower")
    assert {name: (knob.value, knob.follows_world) for name, knob in game.knobs.items()} == {
        "erp": (0.4, False),
        "margin": (1e-3, True),
    }
    assert settings.sleep_knobs["off"]["sleep"].value is False


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            ('value = 0.4, reason = "seats in a second"', "value = 0.4"),
            "shared.stiff.erp: the key 'reason' is missing; add this key, and state why",
        ),
        (
            ('reason = "seats in a second"', 'reason = " "'),
            "shared.stiff.erp.reason must be a text that is not empty, got ' ': state why",
        ),
        (
            ('description = "cheap"', "description = 5"),
            "profiles.game.description must be a text that is not empty, got 5: state what is special",
        ),
        (("value = 0.4, ", ""), "shared.stiff.erp: the key 'value' is missing; write { value = ..., reason = '...' }"),
        (("value = 0.4", "value = [0.4]"), "shared.stiff.erp.value must be a number, a text, true or false, got [0.4]"),
        (('{ value = 0.4, reason = "seats in a second" }', "0.4"), "shared.stiff.erp must be a table, got 0.4"),
        (
            ("value = 0.4", "valeu = 0.4"),
            "shared.stiff.erp: unknown key 'valeu'; use one of value, reason or follows_world",
        ),
        (("follows_world = true", "follows_world = 1"), "knobs.margin.follows_world must be true or false, got 1"),
        (("value = 1e-3", "value = 'thin'"), "knobs.margin.follows_world needs a 'value' that is a length, got 'thin'"),
        (
            ("substeps = 4", ""),
            "profiles.default.substeps must be a whole number of steps per frame, at least 1, got None",
        ),
        (("substeps = 4", "substeps = 0"), "profiles.default.substeps must be a whole number of steps per frame"),
        (("substeps = 4", "substeps = true"), "profiles.default.substeps must be a whole number of steps per frame"),
        (("substeps = 4", "steps = 4"), "profiles.default: unknown key 'steps'; use one of description, substeps,"),
        (("frame_s = 0.02", "frame_s = 20.0"), "profiles.game.frame_s must be a time in seconds, between 0 and 1"),
        (
            ('description = "cheap"', ""),
            "profiles.game: the key 'description' is missing; add this key, and state what is special",
        ),
        (
            ('tuned_by = "us, on a tower"', ""),
            "profiles.game.tuned_by must be a text other than 'as shipped', got None; state who",
        ),
        (
            ('shared = ["stiff"]', 'shared = ["soft"]'),
            "profiles.game.shared must be a list of names of tables [shared.NAME], got 'soft'; use stiff, in quotes",
        ),
        (
            ('shared = ["stiff"]', "shared = 5"),
            "profiles.game.shared must be a list of names of tables [shared.NAME], got 5; use stiff, in quotes",
        ),
        (
            ('shared = ["stiff"]', ""),
            "no profile uses the table [shared.stiff]; add 'stiff' to 'shared' of a profile, or delete the table",
        ),
        (
            ("[profiles.default]", "[profiles.shipped]\ntuned_by = 'us'"),
            "the table [profiles.default] is missing; add this table",
        ),
        (("[sleeping.off]", "[sleeping.never]"), "sleeping: unknown key 'never'; use one of off, native or raised"),
        (("[sleeping.off]", "[asleep.off]"), "the file: unknown key 'asleep'; use one of shared, profiles or sleeping"),
        (("[profiles.default]", "[profiles.default"), "not valid TOML: "),
    ],
)
def test_a_mistake_is_named_with_its_place_and_fix(tmp_path, change: tuple[str, str], message: str) -> None:
    assert change[0] in GOOD
    with pytest.raises(ProfileFileError, match=re.escape(message)) as error:
        load(tmp_path, GOOD.replace(*change, 1))
    assert str(error.value).startswith(f"{tmp_path / 'some.toml'}: "), "the file is named first, once"
    assert str(error.value).count("some.toml") == 1


def test_a_misspelt_knob_is_named_where_the_engine_would_ignore_it(tmp_path) -> None:
    with pytest.raises(
        ProfileFileError, match=r"profiles\.game: the engine has no knob 'margin'; correct the spelling"
    ):
        load(tmp_path, GOOD, knows={"erp", "sleep"}.__contains__)
    with pytest.raises(ProfileFileError, match=r"sleeping\.off: the engine has no knob 'sleep'"):
        load(tmp_path, GOOD, knows={"erp", "margin"}.__contains__)


def test_the_message_for_an_engine_without_a_file_asks_for_one(tmp_path) -> None:
    with pytest.raises(
        ProfileFileError,
        match=r"none\.toml: this file does not exist; create the file with a table \[profiles\.default\]",
    ):
        load_settings("none", folder=tmp_path)
