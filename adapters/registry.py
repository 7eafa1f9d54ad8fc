"""Functions that open a world of an engine by the engine's name, and look up its profiles and capabilities."""

from __future__ import annotations

import importlib.metadata
from collections.abc import Mapping, Sequence

from adapters.base import Simulation
from adapters.bridge.errors import PeerError
from adapters.engines import ENGINES
from adapters.profile import Capabilities, Profile, Sleeping
from adapters.profile_variants import profile_of
from adapters.scaled import scaled
from scenarios.lookup import look_up
from scenarios.model import Brick, World


class EngineNotInstalledError(ImportError):
    """Error for an engine that does not load or cannot open a world; the message gives the reason and the fix."""


def _load(name: str) -> type[Simulation]:
    entry = look_up("engine", name, ENGINES)
    try:
        simulation: type[Simulation] = entry.load()
    except (ImportError, PeerError) as error:
        raise _not_installed(name, error) from error
    return simulation


def _not_installed(name: str, error: Exception) -> EngineNotInstalledError:
    """Return the error for an engine that does not load; the message names the release of an installed package."""
    package = getattr(ENGINES[name], "package", "")
    try:
        release = f"{package} {importlib.metadata.version(package)}" if package else ""
    except importlib.metadata.PackageNotFoundError:
        release = ""
    if not release:
        return EngineNotInstalledError(f"engine '{name}' cannot be loaded ({error}): {ENGINES[name].remedy}")
    return EngineNotInstalledError(
        f"engine '{name}' cannot be loaded with {release} ({error}): install a missing package, or another release of "
        f"{package}"
    )


def _installed(name: str) -> type[Simulation]:
    """Return the class of an engine, after a check that the engine opens worlds."""
    simulation = _load(name)
    try:
        simulation.check_installed()
    except ImportError as error:
        raise _not_installed(name, error) from error
    return simulation


def check_installed(name: str) -> None:
    """Raise ``EngineNotInstalledError`` unless the engine can open a world on this machine.

    Raises:
        UnknownNameError: if no engine has this name.
        EngineNotInstalledError: if the engine does not load or cannot open a world.
    """
    _installed(name)


def capabilities(name: str) -> Capabilities:
    """Return the capabilities of engine ``name``.

    Raises:
        UnknownNameError: if no engine has this name.
        EngineNotInstalledError: if the adapter does not load.
    """
    return _load(name).capabilities


def profiles(name: str) -> Mapping[str, Profile]:
    """Return the profiles of engine ``name``, by their names.

    Raises:
        UnknownNameError: if no engine has this name.
        EngineNotInstalledError: if the adapter does not load.
    """
    return _load(name).profiles


def missing_knobs(name: str) -> list[str]:
    """Return the sorted knobs that the profiles omit, because the installed release of engine ``name`` lacks them.

    Raises:
        UnknownNameError: if no engine has this name.
        EngineNotInstalledError: if the adapter does not load.
    """
    return sorted(_load(name).missing_knobs)


def profile_named(engine: str, name: str) -> Profile:
    """Return the profile ``name`` of an engine, varied if its name states a variation (``adapters.profile_variants``).

    Raises:
        UnknownNameError: if no engine, no profile of the engine or no variation has the name.
        ProfileError: if the value of a variation is invalid.
        EngineNotInstalledError: if the adapter does not load.
    """
    return profile_of(_load(engine), name)


def open_engine(
    name: str,
    profile: str = "default",
    *,
    world: World | None = None,
    sleeping: Sleeping = "off",
    expected: Sequence[Brick] = (),
) -> Simulation:
    """Open a world of engine ``name`` with the ground and the fixed bodies only.

    Args:
        name: name of the engine.
        profile: name of the profile, varied if the name states a variation.
        world: friction, restitution, gravity and fixed bodies; None for ``World()``.
        sleeping: mode of the engine's own sleeping.
        expected: the bricks that the host plans to spawn.

    Raises:
        UnknownNameError: if no engine, no profile of the engine or no variation has the name.
        ProfileError: if the value of a variation is invalid.
        EngineNotInstalledError: if the engine does not load or cannot open a world.
        ValueError: see ``Simulation``.
        NotImplementedError: see ``Simulation``.
    """
    simulation = _installed(name)
    chosen = profile_of(simulation, profile)
    if chosen.scale != 1.0 or chosen.offset != 0.0:
        simulation = scaled(simulation)
    return simulation(chosen, world or World(), sleeping, expected)
