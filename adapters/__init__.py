"""Thin adapters over real physics engines. An engine's package is imported in its own file only."""

from adapters.base import Simulation
from adapters.engines import ENGINES, engine_version
from adapters.profile import Capabilities, EngineInfo, Knob, Profile
from adapters.profile_variants import ProfileError
from adapters.registry import EngineNotInstalledError, capabilities, open_engine, profile_named, profiles

__all__ = [
    "ENGINES",
    "Capabilities",
    "EngineInfo",
    "EngineNotInstalledError",
    "Knob",
    "Profile",
    "ProfileError",
    "Simulation",
    "capabilities",
    "engine_version",
    "open_engine",
    "profile_named",
    "profiles",
]
