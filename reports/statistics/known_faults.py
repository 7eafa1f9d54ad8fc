"""Known faults of engines: public threads that may explain a row of a report.

A known fault flags a group of trials if the first repeat of a seed of the group meets both conditions:

- The engine, the version, the policy and the scene match the fault.
- The trial shows a symptom of the fault.

A flag does not prove the cause. A row with a flag counts like a row without a flag.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Literal, TypeAlias

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from reports.records.trial import TrialRecord
from reports.statistics.groups import Group

FILE = Path(__file__).with_suffix(".toml")

Symptom: TypeAlias = Literal["false_stand", "false_collapse", "creeps", "sinks", "undecided"]
"""Symptom of a trial: its verdict, or ``sinks`` for a stack that sank."""


class KnownFaultsError(ValueError):
    """An invalid entry of a file of known faults; the message names the file, the entry and the fix."""


class KnownFault(BaseModel):
    """A public thread about an engine, with the conditions under which the thread flags a trial."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    engine: str
    """Name of the engine."""
    thread: str = Field(pattern=r"^[\w.-]+/[\w.-]+#\d+$")
    """Repository and number, such as ``bulletphysics/bullet3#3049``."""
    kind: Literal["issue", "pull"]
    """Kind of the thread, which decides the form of its address."""
    symptoms: tuple[Symptom, ...] = Field(min_length=1)
    """Symptoms of the fault, at least one."""
    sentence: str
    """Statement of the thread, in one sentence."""
    first: str = ""
    """First version for which the thread reports the fault; empty if every earlier version may have it."""
    last: str = ""
    """Last version for which the thread reports the fault; empty if every later version may have it."""
    policies: tuple[str, ...] = ()
    """Policies with which the fault shows; empty for all policies."""
    scenes: tuple[Mapping[str, str | float], ...] = ()
    """Scenes in which the fault shows, each with its ``scenario`` and parameters: the least value of a number, or the
    value of a text. Empty for all scenes."""

    @model_validator(mode="after")
    def _check(self) -> KnownFault:
        for name, version in (("first", self.first), ("last", self.last)):
            if version and not _numbers(version):
                raise ValueError(
                    f"'{name}': a version must begin with a number, got {version!r}; write a version such as 3.10.0"
                )
        for number, scene in enumerate(self.scenes, start=1):
            if "scenario" not in scene:
                raise ValueError(
                    f"'scenes', entry {number}: a scene needs its scenario, got {dict(scene)}; write, for example, "
                    '{ scenario = "heavy_top", ratio = 10.0 }'
                )
        return self

    @property
    def name(self) -> str:
        """Short name for a flag, such as ``bullet3#3049``."""
        return self.thread.partition("/")[2]

    @property
    def url(self) -> str:
        """Address of the thread."""
        repository, _, number = self.thread.partition("#")
        return f"https://github.com/{repository}/{'pull' if self.kind == 'pull' else 'issues'}/{number}"

    def shows_in(self, trial: TrialRecord) -> bool:
        """Return whether a trial shows the fault."""
        return (
            trial.engine == self.engine
            and _symptom(trial) in self.symptoms
            and _within(trial.engine_version, self.first, self.last)
            and (not self.policies or trial.policy in self.policies)
            and (not self.scenes or any(_is_scene(trial, scene) for scene in self.scenes))
        )


@cache
def known_faults(file: Path = FILE) -> tuple[KnownFault, ...]:
    """Return the known faults of a file, in the order of the file.

    Raises:
        KnownFaultsError: if an entry is not valid.
        OSError: if the file is unreadable.
        tomllib.TOMLDecodeError: if the file is not TOML.
    """
    entries = tomllib.loads(file.read_text(encoding="utf-8")).get("fault", [])
    return tuple(_fault(file, number, entry) for number, entry in enumerate(entries, start=1))


def faults_of(group: Group) -> tuple[KnownFault, ...]:
    """Return the known faults that the first repeat of a seed of the group shows."""
    return tuple(fault for fault in known_faults() if any(fault.shows_in(trial) for trial in group.draws))


def _fault(file: Path, number: int, entry: object) -> KnownFault:
    try:
        return KnownFault.model_validate(entry)
    except ValidationError as error:
        problem = error.errors()[0]
        place = "".join(f"field '{'.'.join(map(str, problem['loc']))}': " for _ in problem["loc"][:1])
        words = problem["msg"].removeprefix("Value error, ")
        if problem["type"] not in ("missing", "value_error"):
            words += f", got {problem['input']!r:.80}"
        raise KnownFaultsError(f"{file}: fault {number}: {place}{words}; correct this entry") from error


def _symptom(trial: TrialRecord) -> str:
    return "sinks" if trial.collapse_kind == "sink" else trial.verdict


def _is_scene(trial: TrialRecord, scene: Mapping[str, str | float]) -> bool:
    parameters = {"scenario": trial.scenario, **trial.parameters}
    return all(name in parameters and _fits(parameters[name], wanted) for name, wanted in scene.items())


def _fits(value: str | float, wanted: str | float) -> bool:
    if isinstance(value, str) or isinstance(wanted, str):
        return value == wanted
    return value >= wanted


def _within(version: str, first: str, last: str) -> bool:
    numbers = _numbers(version)
    return (not first or numbers >= _numbers(first)) and (not last or numbers <= _numbers(last))


def _numbers(version: str) -> tuple[int, ...]:
    """Return the leading numbers of a version, such as (3, 10, 0) of ``3.10.0``; empty without such numbers."""
    found = re.match(r"\d+(\.\d+)*", version)
    return tuple(map(int, found[0].split("."))) if found else ()
