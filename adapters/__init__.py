"""Thin adapters over real physics engines. An engine's package is imported in its own file only."""

from adapters.base import Capabilities, EngineInfo, Knob, Profile, Simulation
from adapters.registry import ENGINES, EngineNotInstalledError, capabilities, open_engine, profiles

__all__ = [
    "ENGINES",
    "Capabilities",
    "EngineInfo",
    "EngineNotInstalledError",
    "Knob",
    "Profile",
    "Simulation",
    "capabilities",
    "open_engine",
    "profiles",
]
