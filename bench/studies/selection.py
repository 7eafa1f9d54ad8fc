"""Selections, with which the command line narrows or changes a study."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from adapters import ENGINES, EngineNotInstalledError, check_installed
from bench.studies.policies import BENCH_POLICIES
from bench.studies.schema import Study, check_study
from scenarios.formats.read import SUFFIXES
from scenarios.lookup import look_up
from scenarios.registry import SCENARIOS

_HOUR_S = 3600.0
_USUAL_WATCH_S = 5.0
"""Default time for which a scene is watched [s]."""
OWN = (".toml", *SUFFIXES)
"""Suffixes of the names of files with a user's own scene."""


@dataclass(frozen=True, slots=True)
class Selection:
    """Choices of the command line; an empty field or None keeps the study's value."""

    engines: Sequence[str] = ()
    scenarios: Sequence[str] = ()
    policies: Sequence[str] = ()
    profiles: Sequence[str] = ()
    seeds: int | None = None
    hours: float | None = None
    """Simulated time for which every trial is watched [h]; a longer watch increases the limit on wall time by the
    same factor."""


def is_file(name: str) -> bool:
    """Return whether a selected scenario is the name of a file, by its suffix."""
    return name.lower().endswith(OWN)


def selected(study: Study, selection: Selection) -> Study:
    """Apply a selection to a study; a selected scenario keeps its parameters from the study, if any.

    Selected profiles replace the sweeps of the study too.

    Raises:
        UnknownNameError: if a selected name does not exist.
        StudyError: if the result is not a valid study, for example because an engine does not have a profile.
        EngineNotInstalledError: if the package of a selected engine is missing.
    """
    for engine in selection.engines:
        look_up("engine", engine, ENGINES)
    for scenario in selection.scenarios:
        if not is_file(scenario):
            look_up("scenario", scenario, SCENARIOS)
    for policy in selection.policies:
        look_up("policy", policy, BENCH_POLICIES)
    content: dict[str, Any] = study.model_dump()
    named = {
        "engines": list(selection.engines),
        "policies": list(selection.policies),
        "profiles": list(selection.profiles),
        "seeds": selection.seeds,
        "scenario": [
            chosen
            for name in selection.scenarios
            for chosen in [one for one in content["scenario"] if one["name"] == name] or [_plain(name)]
        ],
    }
    if selection.profiles:
        content["sweep"] = []
    if selection.hours is not None:
        content |= _watched_for(study, _HOUR_S * selection.hours)
    return check_study(content | {field: value for field, value in named.items() if value}, f"study '{study.name}'")


def installed_part(study: Study) -> tuple[Study, list[str]]:
    """Return a study of the suite without the missing optional engines, and the reason for each missing engine.

    An engine is optional if it is in a dependency group that ``uv sync`` does not install by default.

    Raises:
        EngineNotInstalledError: if a required engine is missing, or all engines are missing.
        StudyError: if the study admits no trial without the missing engines.
    """
    missing: dict[str, EngineNotInstalledError] = {}
    for engine in study.engines:
        try:
            check_installed(engine)
        except EngineNotInstalledError as error:
            if not ENGINES[engine].is_optional:
                raise
            missing[engine] = error
    if not missing:
        return study, []
    engines = [engine for engine in study.engines if engine not in missing]
    if not engines:
        raise next(iter(missing.values()))
    content = study.model_dump() | {"engines": engines}
    return check_study(content, f"study '{study.name}'"), [str(error) for error in missing.values()]


def default_part(study: Study) -> Study:
    """Return a study of the suite without its optional engines; raise ``StudyError`` if no trial remains."""
    content = study.model_dump() | {"engines": [name for name in study.engines if not ENGINES[name].is_optional]}
    return check_study(content, f"study '{study.name}' without optional engines")


def _watched_for(study: Study, watch_s: float) -> dict[str, Any]:
    """Return two changed fields of a study: a watch of ``watch_s`` [s], and limits with a longer wall time."""
    longer = max(1.0, watch_s / (study.watch_s or _USUAL_WATCH_S))
    limits = study.limits.model_dump()
    return {"watch_s": watch_s, "limits": limits | {"trial_wall_s": limits["trial_wall_s"] * longer}}


def _plain(name: str) -> dict[str, Any]:
    """Return the fields of a selected scenario that is not in the study: a scenario with defaults, or a file."""
    return {"name": "own_scene", "parameters": {"file": name}} if is_file(name) else {"name": name}
