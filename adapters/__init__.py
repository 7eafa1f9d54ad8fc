"""Thin adapters over real physics engines. An engine's package is imported in its own file only."""

from adapters.base import Capabilities, EngineInfo, Knob, Profile, Simulation
from adapters.registry import ENGINES, EngineNotInstalledError, capabilities, open_engine, profile_named, profiles
from adapters.variations import ProfileError

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
    "open_engine",
    "profile_named",
    "profiles",
]
