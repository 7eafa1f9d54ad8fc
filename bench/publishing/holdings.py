"""The content of a published folder, and its differences from a run of the same publication today."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from bench.machine.environment import described_profiles
from bench.publishing.catalogue import Publication
from bench.studies.plan import plan_trials
from reports.records.folder import ResultsFolder, published_rows

_MOST_NAMES = 7
"""Greatest number of names that the text lists; for more names, the text gives only their number."""
_SETTINGS = ("substeps", "frame_s")
"""Settings of a profile besides its knobs."""


def holdings(folder: Path) -> str:
    """Return engines, profiles and policies of a published folder, and the numbers of seeds, repeats and trials.

    The text is one line, and states the number of repeats only if it is above 1.
    """
    rows = list(published_rows(ResultsFolder(folder).trials_file))
    lists = (_listed(rows, "engine"), _listed(rows, "profile"), _listed(rows, "policy", "policies"))
    seeds = _counted(len({int(row["seed"]) for row in rows}), "seed")
    repeats = len({int(row["repeat"]) for row in rows})
    return "; ".join([*lists, seeds, *([f"{repeats} repeats"] if repeats > 1 else []), f"{len(rows):,} trials"])


def differences(folder: Path, publication: Publication) -> str:
    """Return in one line how a run today differs from a published folder; empty without a difference.

    The text states the number of planned trials that the folder lacks, and the profiles of the folder whose settings
    differ from the environment file. It does not state trials of the folder that a run today would leave out.

    Raises:
        EngineNotInstalledError: if the package of an engine is missing.
    """
    results = ResultsFolder(folder)
    rows = list(published_rows(results.trials_file))
    held, planned = {row["trial"] for row in rows}, {trial.id for trial in plan_trials(publication.resolved())}
    lacking = len(planned - held)
    parts = [f"{_counted(lacking, 'more trial')}"] if lacking else []
    used = dict.fromkeys((row["engine"], row["profile"].partition("@")[0]) for row in rows)
    changed = [f"{engine} `{name}`" for engine, name in used if _has_changed(results.engines, engine, name)]
    if changed:
        parts.append(f"other settings: {', '.join(changed)}")
    return "; ".join(parts)


def _listed(rows: Iterable[Mapping[str, Any]], column: str, plural: str = "") -> str:
    names = list(dict.fromkeys(row[column] for row in rows))
    return f"{len(names)} {plural or column + 's'}" if len(names) > _MOST_NAMES else ", ".join(names)


def _counted(count: int, noun: str) -> str:
    return f"{count:,} {noun}" + ("" if count == 1 else "s")


def _has_changed(engines: Mapping[str, Any], engine: str, profile: str) -> bool:
    """Return whether the present settings of a profile differ from the settings in the environment file.

    The result is True for a profile that does not exist any more, and False for a profile that the file lacks.
    """
    then = engines.get(engine, {}).get("profiles", {}).get(profile)
    now = described_profiles(engine).get(profile)
    return then is not None and (now is None or _settings(then) != _settings(now))


def _settings(profile: Mapping[str, Any]) -> dict[str, Any]:
    fixed = {name: profile[name] for name in _SETTINGS}
    return fixed | {name: knob["value"] for name, knob in profile["knobs"].items()}
