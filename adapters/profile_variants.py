"""Profiles by name, as they are or varied: ``game``, ``game@scale=10``, ``tuned@substeps=8,forces=0``.

The name alone says how a profile varies, so that it goes wherever a profile's name goes: studies, trials and records.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace

from adapters.base import Simulation
from adapters.profile import Knob, Profile
from scenarios.lookup import look_up

_MARK = "@"


class ProfileError(ValueError):
    """A variation that makes no sense; the message names the fix."""


def base_name(profile: str) -> str:
    """Name of the profile that a varied one was made from."""
    return profile.partition(_MARK)[0]


def varied_name(profile: str, changes: Mapping[str, float | int]) -> str:
    """Name of a profile with these changes."""
    suffix = ",".join(f"{what}={value:g}" for what, value in changes.items())
    return f"{profile}{_MARK}{suffix}" if suffix else profile


def profile_of(simulation: type[Simulation], name: str) -> Profile:
    """The profile of an engine that goes by ``name``, varied as the name says.

    Raises:
        UnknownNameError: if the engine has no such profile, or a variation is unknown.
        ProfileError: if the value of a variation is not what it must be.
    """
    base, mark, changes = name.partition(_MARK)
    profile = look_up(f"profile of engine {simulation.engine}", base, simulation.profiles)
    if not mark:
        return profile
    for change in changes.split(","):
        what, _, value = change.partition("=")
        vary = look_up("variation of a profile", what, _VARIATIONS)
        try:
            profile = vary(simulation, profile, float(value))
        except ValueError as error:
            raise ProfileError(f"profile '{name}': {what} must be {_MUST_BE[what]}, got '{value}'") from error
    return replace(profile, name=name, description=f"{profile.description}; varied: {changes}")


def _with_scale(_: type[Simulation], profile: Profile, scale: float) -> Profile:
    if not (math.isfinite(scale) and scale > 0):
        raise ValueError
    return replace(profile.with_lengths_times(scale), scale=scale)


def _with_substeps(_: type[Simulation], profile: Profile, substeps: float) -> Profile:
    return replace(profile, substeps=_whole(substeps))


def _with_iterations(simulation: type[Simulation], profile: Profile, iterations: float) -> Profile:
    knob = Knob(_whole(iterations), "varied, to see what it brings and what it costs")
    return profile.with_knobs({simulation.iterations: knob})


def _with_forces(_: type[Simulation], profile: Profile, forces: float) -> Profile:
    if forces not in (0.0, 1.0):
        raise ValueError
    return replace(profile, forces=bool(forces))


def _whole(value: float) -> int:
    if not (value >= 1 and value.is_integer()):
        raise ValueError
    return int(value)


_VARIATIONS: Mapping[str, Callable[[type[Simulation], Profile, float], Profile]] = {
    "scale": _with_scale,
    "substeps": _with_substeps,
    "iterations": _with_iterations,
    "forces": _with_forces,
}
_MUST_BE = {
    "scale": "a positive number",
    "substeps": "a whole number from 1",
    "iterations": "a whole number from 1",
    "forces": "0 (contacts without forces) or 1",
}
