"""Profiles by name, unchanged or varied: ``game``, ``game@scale=10``, ``tuned@substeps=8,forces=0``.

Besides the variations in ``_VARIATIONS``, a name can vary each knob that a profile sets or the adapter knows:
``game@contactERP=0.2``.

The variation is a part of the name, so that studies, trials and records contain the variation.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace

from adapters.base import Simulation
from adapters.profile import Knob, KnobValue, Profile
from scenarios.lookup import look_up, unknown_name

_MARK = "@"
_MOST_HZ = 10_000.0


class ProfileError(ValueError):
    """Error for an invalid variation of a profile; the message names the fix."""


def base_name(profile: str) -> str:
    """Return the name of a profile without its variation."""
    return profile.partition(_MARK)[0]


def varied_name(profile: str, changes: Mapping[str, float | int]) -> str:
    """Return the name of a profile varied by ``changes``, with six significant digits of each value.

    Return the profile's own name if ``changes`` is empty.
    """
    suffix = ",".join(f"{what}={value:g}" for what, value in changes.items())
    return f"{profile}{_MARK}{suffix}" if suffix else profile


def profile_of(simulation: type[Simulation], name: str) -> Profile:
    """Return the profile ``name`` of an engine, varied if the name states a variation.

    Raises:
        UnknownNameError: if the engine has no profile of this name, or a variation is unknown.
        ProfileError: if the value of a variation is invalid, or the engine lacks the knob of ``iterations``.
    """
    base, mark, changes = name.partition(_MARK)
    profile = look_up(f"profile of engine {simulation.engine}", base, simulation.profiles)
    if not mark:
        return profile
    for change in changes.split(","):
        what, _, value = change.partition("=")
        if what not in _VARIATIONS and _has_knob(simulation, what):
            profile = _with_knob(simulation, profile, what, value)
            continue
        if what not in _VARIATIONS:
            names = (*_VARIATIONS, *_knobs_of(simulation))
            raise unknown_name(f"variation of a profile of engine '{simulation.engine}'", what, names)
        vary = _VARIATIONS[what]
        try:
            profile = vary(simulation, profile, float(value))
        except ProfileError as error:
            raise ProfileError(f"profile '{name}': {error}") from error
        except ValueError as error:
            raise ProfileError(
                f"profile '{name}': {what} must be {_MUST_BE[what]}, got '{value}'; correct the value"
            ) from error
    return replace(profile, name=name, description=f"{profile.description}; varied: {changes}")


def _has_knob(simulation: type[Simulation], name: str) -> bool:
    return simulation.knows_knob(name) or any(name in profile.knobs for profile in simulation.profiles.values())


def _knobs_of(simulation: type[Simulation]) -> list[str]:
    """Return the sorted names of the knobs that the engine's profiles set, without the variations of other meaning."""
    knobs = {name for profile in simulation.profiles.values() for name in profile.knobs}
    return sorted(knobs - _VARIATIONS.keys())


def _with_scale(_: type[Simulation], profile: Profile, scale: float) -> Profile:
    if not (math.isfinite(scale) and scale > 0):
        raise ValueError
    return replace(profile.with_lengths_times(scale / profile.scale), scale=scale)


def _with_substeps(_: type[Simulation], profile: Profile, substeps: float) -> Profile:
    return replace(profile, substeps=_whole(substeps))


def _with_iterations(simulation: type[Simulation], profile: Profile, iterations: float) -> Profile:
    if not simulation.iterations:
        raise ProfileError(
            f"variation 'iterations' needs a knob for the number of iterations, but the engine {simulation.engine} has "
            "no knob of this kind: vary 'substeps' instead"
        )
    knob = Knob(_whole(iterations), "varied, to measure its effect and its cost")
    return profile.with_knobs({simulation.iterations: knob})


def _with_forces(_: type[Simulation], profile: Profile, forces: float) -> Profile:
    if forces not in (0.0, 1.0):
        raise ValueError
    return replace(profile, forces=bool(forces))


def _with_hz(_: type[Simulation], profile: Profile, hz: float) -> Profile:
    if not 1.0 <= hz <= _MOST_HZ:
        raise ValueError
    return replace(profile, frame_s=1 / hz)


def _with_offset(_: type[Simulation], profile: Profile, offset: float) -> Profile:
    if not math.isfinite(offset):
        raise ValueError
    return replace(profile, offset=offset)


def _with_knob(simulation: type[Simulation], profile: Profile, knob: str, text: str) -> Profile:
    """Return the profile with one knob of the engine set to the value in a varied name.

    Raises:
        ProfileError: if the value does not convert to the type of the knob's value in the engine's profiles.
    """
    everywhere = [*(one.knobs for one in simulation.profiles.values()), *simulation.sleep_knobs.values()]
    known = profile.knobs.get(knob) or next((knobs[knob] for knobs in everywhere if knob in knobs), None)
    value = _value(text)
    if known is not None and isinstance(known.value, float) and type(value) is int:
        value = float(value)
    if known is not None and type(known.value) is int and isinstance(value, float) and value.is_integer():
        value = int(value)
    if known is not None and type(value) is not type(known.value):
        kind = {bool: "true or false", int: "a whole number", float: "a number", str: "a text"}[type(known.value)]
        raise ProfileError(
            f"profile '{profile.name}' of engine '{simulation.engine}': knob '{knob}' must be {kind}, such as "
            f"{known.value!r}, got '{text}'; give {kind}"
        )
    follows_world = known is not None and known.follows_world
    if follows_world and isinstance(value, float):
        value *= profile.scale
    return profile.with_knobs({knob: Knob(value, "varied, to measure its effect", follows_world)})


def _value(text: str) -> KnobValue:
    """Convert the text of a knob's value to an int, a float or a bool; return other text unchanged."""
    for read in (int, float):
        try:
            return read(text)
        except ValueError:
            continue
    return {"true": True, "false": False}.get(text.lower(), text)


def _whole(value: float) -> int:
    if not (value >= 1 and value.is_integer()):
        raise ValueError
    return int(value)


_VARIATIONS: Mapping[str, Callable[[type[Simulation], Profile, float], Profile]] = {
    "scale": _with_scale,
    "substeps": _with_substeps,
    "iterations": _with_iterations,
    "forces": _with_forces,
    "hz": _with_hz,
    "offset": _with_offset,
}
_MUST_BE = {
    "scale": "a positive, finite number",
    "substeps": "a whole number from 1",
    "iterations": "a whole number from 1",
    "forces": "0 (contacts without forces) or 1",
    "hz": f"frames a second, from 1 to {_MOST_HZ:g}",
    "offset": "a finite number, in metres",
}
