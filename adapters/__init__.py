"""Adapters of the physics engines, and functions that open a world of an engine by the engine's name."""

from adapters.base import Simulation
from adapters.bridge.errors import PeerError
from adapters.bridge.external import EnginesFileError, register_command, register_external
from adapters.engines import ENGINES, engine_version
from adapters.profile import Capabilities, EngineInfo, Knob, Profile
from adapters.profile_files import ProfileFileError
from adapters.profile_variants import ProfileError
from adapters.registry import (
    EngineNotInstalledError,
    capabilities,
    check_installed,
    missing_knobs,
    open_engine,
    profile_named,
    profiles,
)

__all__ = [
    "ENGINES",
    "Capabilities",
    "EngineInfo",
    "EngineNotInstalledError",
    "EnginesFileError",
    "Knob",
    "PeerError",
    "Profile",
    "ProfileError",
    "ProfileFileError",
    "Simulation",
    "capabilities",
    "check_installed",
    "engine_version",
    "missing_knobs",
    "open_engine",
    "profile_named",
    "profiles",
    "register_command",
    "register_external",
]
