"""Engines outside this repository: engines behind the bridge (from a file of engines) and classes in other packages.

A file of engines (``engines.toml``) has a table for each engine::

    [NAME]
    command = ["program", "argument"]     # the suite starts the program in the folder of this file
    profiles = "NAME.toml"                # settings, in the layout of adapters/profile_files.py; default: one profile
    timeout_s = 60                        # time limit [s] for the answer to each message; default: 60

A package offers an adapter, a subclass of ``adapters.base.Simulation``, as an entry point of ``ENTRY_POINTS``.
"""

from __future__ import annotations

import importlib.metadata
import os
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

from adapters.bridge.description import Description, described
from adapters.bridge.messages import PROTOCOL, Kind, json_body, json_content
from adapters.bridge.peer import SILENCE_S, Peer
from adapters.bridge.simulation import BridgeSimulation
from adapters.engines import ENGINES, Entry
from adapters.profile import AS_SHIPPED, Profile
from adapters.profile_files import EngineSettings, load_settings
from scenarios.lookup import one_of

ENTRY_POINTS = "stillstack.engines"
"""Group of the entry points with which packages offer their engines."""
FILE_VARIABLE = "STILLSTACK_ENGINES"
"""Environment variable that names a file of engines."""
DEFAULT_FILE = Path("engines.toml")
"""File of engines in the working directory. The suite reads an existing file if ``FILE_VARIABLE`` is not set."""

_KEYS = ("command", "profiles", "timeout_s")
_BUILT_IN = frozenset(ENGINES)


class EnginesFileError(ValueError):
    """Error for an invalid file of engines; the message names the file, the entry and the fix."""


@dataclass(frozen=True, slots=True)
class ExternalEntry:
    """Entry of an engine behind the bridge."""

    name: str
    """Name of the engine in this suite."""
    command: tuple[str, ...]
    folder: Path
    """Working directory of the engine's process."""
    profiles: Path | None = None
    """File of the engine's profiles; None for one profile without knobs."""
    timeout_s: float = SILENCE_S
    source: str = "--bridge"
    """File and table of the entry, for error messages."""
    is_optional: bool = False

    @property
    def module(self) -> str:
        """Return the name of the module that a process imports before it runs trials of the engine."""
        return BridgeSimulation.__module__

    @property
    def remedy(self) -> str:
        """Return the fix for an engine that does not load, as text for an error message."""
        return f"check that its command runs: {list(self.command)}, from {self.source}"

    def version(self) -> str:
        """Return the version that the engine reports; the first call in a process starts the engine.

        Raises:
            PeerError: if the engine does not start, or its hello message is not valid.
        """
        return _describe(self).version

    def load(self) -> type[BridgeSimulation]:
        """Return the class of the engine.

        Raises:
            PeerError: if the engine does not start, or its hello message is not valid.
            ProfileFileError: if the engine's profile file is invalid.
        """
        return _class_of(self)


def register_command(command: Sequence[str], profiles: Path | None) -> str:
    """Add the engine that a command starts to ``ENGINES``, under the name in its hello message; return the name.

    Raises:
        EnginesFileError: if the suite itself has an engine of that name.
        PeerError: if the engine does not start, or its hello message is not valid.
    """
    entry = ExternalEntry("", tuple(command), Path.cwd(), profiles.absolute() if profiles else None)
    name = describe(entry).engine
    _register(name, replace(entry, name=name), "--bridge")
    return name


def register_external() -> None:
    """Add the engines of the entry points and of the file to ``ENGINES``, without starting or importing them.

    If external engines have the same name, the latest entry replaces the earlier entries.

    Raises:
        EnginesFileError: if the file is missing or invalid, or the suite itself has an engine of the same name. A
            missing ``DEFAULT_FILE`` is no error.
    """
    for point in importlib.metadata.entry_points(group=ENTRY_POINTS):
        package = point.dist.name if point.dist else point.module
        _register(point.name, Entry(point.module, point.attr, package), f"the package '{package}'")
    named = os.environ.get(FILE_VARIABLE)
    path = Path(named) if named else DEFAULT_FILE
    if named or path.exists():
        for name, entry in read_engines(path).items():
            _register(name, entry, str(path))


def read_engines(path: Path) -> Mapping[str, ExternalEntry]:
    """Return the engines in a file of engines, by name.

    Raises:
        EnginesFileError: if the file is missing or invalid.
    """
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise EnginesFileError(
            f"{path}: cannot read this file ({error}); set {FILE_VARIABLE} to the path of a file of engines"
        ) from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise EnginesFileError(f"{path}: not valid TOML: {error}; correct the file at this place") from error
    return {name: _entry(path, name, table) for name, table in content.items()}


def describe(entry: ExternalEntry) -> Description:
    """Start an engine, return the description in its hello message, and end its process.

    Raises:
        PeerError: if the engine does not start, or its hello message is not valid.
    """
    peer = Peer(entry.command, entry.folder, entry.timeout_s)
    try:
        return described(json_content(peer.ask(Kind.HELLO, json_body({"protocol": PROTOCOL}))))
    finally:
        peer.close()


_describe = cache(describe)


@cache
def _class_of(entry: ExternalEntry) -> type[BridgeSimulation]:
    said = _describe(entry)
    settings = _settings(entry.profiles)

    class External(BridgeSimulation):
        engine = entry.name
        capabilities = said.capabilities
        profiles = settings.profiles
        sleep_knobs = settings.sleep_knobs
        iterations = said.iterations
        folder = entry.folder
        timeout_s = entry.timeout_s
        contacts_at = said.contacts_at
        solver_noise = said.solver_noise

        @classmethod
        def command(cls) -> Sequence[str]:
            return entry.command

    return External


def _settings(path: Path | None) -> EngineSettings:
    if path is not None:
        return load_settings(path.stem, folder=path.parent)
    return EngineSettings({"default": Profile("default", AS_SHIPPED, 1)}, {})


def _register(name: str, entry: Entry | ExternalEntry, source: str) -> None:
    if name in _BUILT_IN:
        raise EnginesFileError(
            f"{source}: the name '{name}' must be new, but the suite already has an engine of this name: give your "
            "engine another name"
        )
    ENGINES[name] = entry


def _entry(path: Path, name: str, table: Any) -> ExternalEntry:
    where = f"{path}: [{name}]"
    if not isinstance(table, dict):
        raise EnginesFileError(
            f"{path}: the entry '{name}' must be a table, got {table!r}: write [{name}], and below this line a "
            "'command'"
        )
    for key in table:
        if key not in _KEYS:
            raise EnginesFileError(f"{where}: unknown key '{key}'; use {one_of(_KEYS)}")
    command, profiles, timeout_s = table.get("command"), table.get("profiles"), table.get("timeout_s", SILENCE_S)
    if not (isinstance(command, list) and command and all(isinstance(word, str) for word in command)):
        raise EnginesFileError(
            f"{where}: 'command' must be a list of texts, at least the program, such as ['program', 'argument'], got "
            f"{command!r}: correct the list"
        )
    if profiles is not None and not isinstance(profiles, str):
        raise EnginesFileError(
            f"{where}: 'profiles' must be the name of a file, got {profiles!r}: write a name in quotes, such as "
            "'NAME.toml'"
        )
    if type(timeout_s) not in (int, float) or not 0.0 < timeout_s < float("inf"):
        raise EnginesFileError(
            f"{where}: 'timeout_s' must be a finite time in seconds, more than 0, got {timeout_s!r}; write, for "
            "example, timeout_s = 60"
        )
    folder = path.parent.absolute()
    return ExternalEntry(name, tuple(command), folder, folder / profiles if profiles else None, float(timeout_s), where)
