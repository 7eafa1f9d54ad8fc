"""Build a history from measured versions: series, steps, links to changelogs and explanations."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from pathlib import Path

from pydantic import ValidationError

from bench.history.figures import as_series
from bench.history.measure import Measured
from reports.records.history import Explanation, History, HistoryError, Point, Series, Step
from reports.statistics.steps import find_steps

CHANGELOGS = {
    "bullet": "https://github.com/bulletphysics/bullet3/releases",
    "dart": "https://github.com/dartsim/dart/blob/release-6.20/CHANGELOG.md",
    "mujoco": "https://mujoco.readthedocs.io/en/stable/changelog.html",
    "physx": "https://github.com/haosulab/SAPIEN/releases/tag/{version}",
    "pymunk": "https://github.com/viblo/pymunk/blob/{version}/CHANGELOG.rst",
    "rapier": "https://github.com/dimforge/rapier/blob/master/CHANGELOG.md",
}
"""Address of the changelog, by engine; ``{version}`` stands for the release."""


def build_history(
    measured: Sequence[Measured],
    *,
    subject: str,
    package: str,
    study: str,
    commit: str,
    explanations: Sequence[Explanation] = (),
) -> History:
    """Return the history of measured versions, in their order."""
    series = as_series([one.figures for one in measured])
    link = CHANGELOGS.get(subject, "")
    points = [
        Point(
            version=one.version,
            link=link.format(version=one.version),
            message=one.message,
            notes=list(one.notes),
        )
        for one in measured
    ]
    processors = sorted({one.processor for one in measured if one.processor})
    history = History(
        subject=subject,
        package=package,
        study=study,
        commit=commit,
        processor=" and ".join(processors),
        points=points,
        series=series,
    )
    return history.model_copy(update={"steps": steps_of(history, explanations)})


def steps_of(history: History, explanations: Sequence[Explanation] = ()) -> list[Step]:
    """Return the steps of all figures in the order of the versions, each with its explanation, if any."""
    versions = [point.version for point in history.points]
    steps = [step for series in history.series for step in _of_series(series, versions, explanations)]
    return sorted(steps, key=lambda step: versions.index(step.version))


def read_explanations(path: Path) -> list[Explanation]:
    """Return the quoted lines of changelogs in the tables ``[[explanation]]`` of a TOML file.

    Raises:
        HistoryError: if the file is unreadable, or a table is invalid.
    """
    try:
        tables = tomllib.loads(path.read_text(encoding="utf-8")).get("explanation", [])
    except (OSError, tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise HistoryError(
            f"{path}: cannot read this file as TOML ({error}); name a readable file, or correct the file"
        ) from error
    if not isinstance(tables, list):
        raise HistoryError(f"{path}: 'explanation' must be tables, got {tables!r:.80}: write [[explanation]] tables")
    return [_explanation(table, f"{path}: [[explanation]] {number}") for number, table in enumerate(tables, start=1)]


def _explanation(table: object, place: str) -> Explanation:
    try:
        return Explanation.model_validate(table)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        field = "".join(f" field '{part}':" for part in first["loc"][:1])
        got = "" if first["type"] == "missing" else f", got {first['input']!r:.80}"
        raise HistoryError(f"{place}:{field} {first['msg']}{got}; correct the table") from error


def _of_series(series: Series, versions: Sequence[str], explanations: Sequence[Explanation]) -> list[Step]:
    """Return the steps of one figure, each with the lower medians of the two adjacent segments."""
    known = [index for index, value in enumerate(series.values) if value is not None]
    starts = find_steps(series.values, series.kind)
    bounds = [0, *starts, len(series.values)]
    steps = []
    for number, start in enumerate(starts, start=1):
        before = _middle(series.values[bounds[number - 1] : start])
        after = _middle(series.values[start : bounds[number + 1]])
        steps.append(
            Step(
                series=series.name,
                version=versions[start],
                previous=versions[known[known.index(start) - 1]],
                before=before,
                after=after,
                explanation=_explained(series.name, versions[start], explanations),
            )
        )
    return steps


def _middle(values: Sequence[float | None]) -> float:
    """Return the lower median of the known values."""
    known = sorted(value for value in values if value is not None)
    return known[(len(known) - 1) // 2]


def _explained(series: str, version: str, explanations: Sequence[Explanation]) -> Explanation | None:
    fitting = [one for one in explanations if one.version == version and (not one.series or series in one.series)]
    return next(iter(sorted(fitting, key=lambda one: not one.series)), None)
