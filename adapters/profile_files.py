"""Profiles of an engine from ``adapters/profiles/NAME.toml``: settings, their reasons, and their authors.

A file has up to three tables::

    [shared.SET]             # knobs that several profiles have in common
    KNOB = { value = 0.85, reason = "why the value differs from the shipped value, with a measurement" }

    [profiles.NAME]          # default, game, tuned, or another name
    description = "in a few words"
    substeps = 4             # engine steps per frame
    frame_s = 0.02           # length of a frame [s]; 1/60 by default
    scale = 10               # ratio of lengths in the engine's world to lengths in the scene; 1 by default
    tuned_by = "who, on which scenes"
    shared = ["SET"]
    knobs.KNOB = { value = 60, reason = "...", follows_world = true }

    [sleeping.off]           # more knobs for a mode of the engine's own sleeping: off, native or raised
    KNOB = { value = false, reason = "..." }
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, get_args

from adapters.profile import AS_SHIPPED, Knob, Profile, Sleeping
from scenarios.lookup import one_of

FOLDER = Path(__file__).with_name("profiles")

_TABLES = ("shared", "profiles", "sleeping")
_PROFILE_KEYS = ("description", "substeps", "frame_s", "scale", "tuned_by", "shared", "knobs")
_KNOB_KEYS = ("value", "reason", "follows_world")

Knobs = Mapping[str, Knob]


class ProfileFileError(ValueError):
    """Error for a missing or invalid profile file; the message names the file, the place in the file, and the fix."""


@dataclass(frozen=True, slots=True)
class EngineSettings:
    """The profiles of one engine, the knobs of its sleeping modes, and the check of knob names."""

    profiles: Mapping[str, Profile]
    sleep_knobs: Mapping[str, Knobs]
    knows: Callable[[str], bool] = lambda _: True
    """Function that returns whether a knob of this name exists."""
    missing: frozenset[str] = frozenset()
    """Knobs of the file that the installed release of the engine does not have. No profile contains them."""


def load_settings(
    engine: str,
    knows: Callable[[str], bool] = lambda _: True,
    folder: Path = FOLDER,
    *,
    missing: Iterable[str] = (),
) -> EngineSettings:
    """Read and check the profile file of an engine.

    Args:
        engine: name of the engine.
        knows: function that returns whether a knob of this name exists. By default every name is valid.
        folder: folder of the files.
        missing: knobs that the installed release of the engine lacks, although another release has them. The function
            leaves these knobs out of the profiles.

    Raises:
        ProfileFileError: if the file is missing, is not valid TOML, or has an invalid entry.
    """
    path = folder / f"{engine}.toml"
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError as error:
        raise ProfileFileError(
            f"{path}: this file does not exist; create the file with a table [profiles.default] "
            "(adapters/profile_files.py shows the layout)"
        ) from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ProfileFileError(f"{path}: not valid TOML: {error}; correct the file at this place") from error
    try:
        settings = replace(_settings(content), knows=knows)
        _check_known(settings, knows)
    except ProfileFileError as error:
        raise ProfileFileError(f"{path}: {error}") from error
    return _without(settings, frozenset(missing))


def _without(settings: EngineSettings, missing: frozenset[str]) -> EngineSettings:
    """Return the settings without the missing knobs; record the missing knobs that the file sets."""

    def kept(knobs: Knobs) -> dict[str, Knob]:
        return {name: knob for name, knob in knobs.items() if name not in missing}

    named = {name for profile in settings.profiles.values() for name in profile.knobs}
    named |= {name for knobs in settings.sleep_knobs.values() for name in knobs}
    return replace(
        settings,
        profiles={name: replace(one, knobs=kept(one.knobs)) for name, one in settings.profiles.items()},
        sleep_knobs={mode: kept(knobs) for mode, knobs in settings.sleep_knobs.items()},
        missing=missing & named,
    )


def _check_known(settings: EngineSettings, knows: Callable[[str], bool]) -> None:
    profiles = {f"profiles.{name}": profile.knobs for name, profile in settings.profiles.items()}
    sleeping = {f"sleeping.{mode}": knobs for mode, knobs in settings.sleep_knobs.items()}
    for where, knobs in (profiles | sleeping).items():
        for name in knobs:
            if not knows(name):
                raise ProfileFileError(
                    f"{where}: the engine has no knob '{name}'; correct the spelling of the knob, or delete the knob, "
                    "in this table or in a shared table"
                )


def _settings(content: Mapping[str, Any]) -> EngineSettings:
    _check_keys("the file", content, _TABLES)
    shared = {name: _knobs(f"shared.{name}", knobs) for name, knobs in _table("shared", content).items()}
    tables = _table("profiles", content)
    if "default" not in tables:
        raise ProfileFileError(
            "the table [profiles.default] is missing; add this table, with the settings that the engine's package ships"
        )
    profiles = {name: _profile(name, table, shared) for name, table in tables.items()}
    unused = set(shared) - {name for table in tables.values() for name in table.get("shared", ())}
    if unused:
        raise ProfileFileError(
            f"no profile uses the table [shared.{min(unused)}]; add '{min(unused)}' to 'shared' of a profile, or "
            "delete the table"
        )
    sleeping = _table("sleeping", content)
    _check_keys("sleeping", sleeping, get_args(Sleeping))
    return EngineSettings(profiles, {mode: _knobs(f"sleeping.{mode}", knobs) for mode, knobs in sleeping.items()})


def _profile(name: str, table: Any, shared: Mapping[str, Knobs]) -> Profile:
    where = f"profiles.{name}"
    _check_table(where, table)
    _check_keys(where, table, _PROFILE_KEYS)
    knobs: dict[str, Knob] = {}
    sets = table.get("shared", [])
    wrong = [one for one in sets if not (isinstance(one, str) and one in shared)] if isinstance(sets, list) else [sets]
    if wrong:
        fix = (
            f"use {one_of(shared)}, in quotes and brackets"
            if shared
            else "add a table [shared.NAME], or delete the key"
        )
        raise ProfileFileError(
            f"{where}.shared must be a list of names of tables [shared.NAME], got {wrong[0]!r}; {fix}"
        )
    for chosen in sets:
        knobs |= shared[chosen]
    own = _knobs(f"{where}.knobs", table.get("knobs", {}))
    tuned_by = table.get("tuned_by", AS_SHIPPED)
    if name != "default" and not (isinstance(tuned_by, str) and tuned_by != AS_SHIPPED):
        raise ProfileFileError(
            f"{where}.tuned_by must be a text other than {AS_SHIPPED!r}, got {table.get('tuned_by')!r}; state who "
            "tuned the profile, on which scenes"
        )
    return Profile(
        name,
        _text(where, table, "description"),
        _substeps(where, table),
        _frame_s(where, table),
        {**knobs, **own},
        tuned_by,
        _scale(where, table),
    )


def _substeps(where: str, table: Mapping[str, Any]) -> int:
    substeps = table.get("substeps")
    if type(substeps) is not int or substeps < 1:
        raise ProfileFileError(
            f"{where}.substeps must be a whole number of steps per frame, at least 1, got {substeps!r}; write, for "
            "example, substeps = 4"
        )
    return substeps


def _frame_s(where: str, table: Mapping[str, Any]) -> float:
    frame_s = table.get("frame_s", 1 / 60)
    if type(frame_s) is not float or not 0.0 < frame_s < 1.0:
        raise ProfileFileError(
            f"{where}.frame_s must be a time in seconds, between 0 and 1, got {frame_s!r}; write, for example, "
            "frame_s = 0.02"
        )
    return frame_s


def _scale(where: str, table: Mapping[str, Any]) -> float:
    scale = table.get("scale", 1.0)
    if type(scale) not in (int, float) or not 0.0 < scale < math.inf:
        raise ProfileFileError(
            f"{where}.scale must be a positive, finite number, got {scale!r}; write, for example, scale = 10"
        )
    return float(scale)


def _knobs(where: str, knobs: Any) -> dict[str, Knob]:
    _check_table(where, knobs)
    return {name: _knob(f"{where}.{name}", knob) for name, knob in knobs.items()}


def _knob(where: str, knob: Any) -> Knob:
    _check_table(where, knob)
    _check_keys(where, knob, _KNOB_KEYS)
    if "value" not in knob:
        raise ProfileFileError(f"{where}: the key 'value' is missing; write {{ value = ..., reason = '...' }}")
    value, follows_world = knob["value"], knob.get("follows_world", False)
    if not isinstance(value, (bool, int, float, str)):
        raise ProfileFileError(
            f"{where}.value must be a number, a text, true or false, got {value!r}; write, for example, value = 0.4"
        )
    if type(follows_world) is not bool:
        raise ProfileFileError(
            f"{where}.follows_world must be true or false, got {follows_world!r}; write follows_world = true, or "
            "delete follows_world"
        )
    if follows_world and type(value) not in (int, float):
        raise ProfileFileError(
            f"{where}.follows_world needs a 'value' that is a length, got {value!r}: delete follows_world"
        )
    return Knob(value, _text(where, knob, "reason"), follows_world)


def _text(where: str, table: Mapping[str, Any], key: str) -> str:
    why = "why the value differs from the shipped value" if key == "reason" else "what is special, in a few words"
    if key not in table:
        raise ProfileFileError(f"{where}: the key '{key}' is missing; add this key, and state {why}")
    text = table[key]
    if not (isinstance(text, str) and text.strip()):
        raise ProfileFileError(f"{where}.{key} must be a text that is not empty, got {text!r}: state {why}")
    return text


def _table(name: str, content: Mapping[str, Any]) -> Mapping[str, Any]:
    table = content.get(name, {})
    _check_table(name, table)
    return dict(table)


def _check_table(where: str, table: Any) -> None:
    if not isinstance(table, dict):
        raise ProfileFileError(
            f"{where} must be a table, got {table!r}; write a table [{where}], or an inline table {{ KEY = ... }}"
        )


def _check_keys(where: str, table: Mapping[str, Any], known: tuple[str, ...]) -> None:
    for key in table:
        if key not in known:
            raise ProfileFileError(f"{where}: unknown key '{key}'; use {one_of(known)}")
