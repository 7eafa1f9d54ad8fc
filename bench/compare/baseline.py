"""One side of a comparison: a results folder, or a baseline file written from one."""

from __future__ import annotations

import tomllib
import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

import pyarrow as pa
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from bench.compare.strict_json import JsonError, parse, read_file
from bench.compare.timing import PARTS, Part, shares
from bench.execution.results import SESSIONS
from bench.machine.environment import digest
from bench.studies.tolerance import Tolerance
from reports.records.atomic import write_atomic
from reports.records.folder import ENVIRONMENT, STUDY, TRIALS
from reports.records.frames import read_frames
from reports.records.trial import RecordError, RecordWarning, TrialRecord, read_records

FORMAT: Literal["stillstack-baseline-1"] = "stillstack-baseline-1"
"""Name of the file format, in the field ``format`` of each baseline file."""


class BaselineError(ValueError):
    """An unreadable or unwritable side of a comparison; the message names the file and the fix."""


class _Model(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class Engine(_Model):
    """Version and repeatability of an engine on the machine of the trials."""

    version: str
    deterministic: str
    """Scope in which the engine repeats bit for bit: "across processes", "within a process" or "no"."""
    missing_knobs: Sequence[str] = ()
    """Settings of the profiles that this version of the engine does not have, so that it ran without them."""


class Machine(_Model):
    """Properties of a machine on which the comparability of results depends, without its host name."""

    processor: str
    platform: str
    python: str
    commit: str | None = None
    modified: bool = False
    """True if the checkout had uncommitted changes."""
    sources: str | None = None
    """Digest of the suite's sources; None if unknown."""
    packages: Mapping[str, str] = {}
    engines: Mapping[str, Engine] = {}

    def runs_same_code(self, other: Machine) -> bool:
        """Return whether sources, Python and packages are known and equal on both machines; engines may differ."""
        mine, its = ((one.sources, one.python, one.packages) for one in (self, other))
        return self.sources is not None and mine == its


class Baseline(_Model):
    """Content of a run, as one side of comparisons with other runs."""

    format: Literal["stillstack-baseline-1"] = FORMAT
    study: str
    trial_wall_s: float = Field(gt=0)
    """Wall time after which the run stopped a trial [s]."""
    tolerances: Mapping[str, Tolerance] = {}
    """Tolerances of the scenarios for which the study sets them, by name of the scenario."""
    machines: Mapping[str, Machine] = {}
    """Machines, by the digest of the environment; each record contains such a digest."""
    shares: Mapping[str, Mapping[Part, Annotated[float, Field(gt=0)]]] = {}
    """Ratio of the time of each part of a frame to the time of the engine's step (see ``timing``), by trial id."""
    trials: Sequence[TrialRecord] = Field(min_length=1)

    @model_validator(mode="after")
    def _shares_are_whole(self) -> Baseline:
        for trial, parts in self.shares.items():
            if set(parts) != set(PARTS):
                raise ValueError(
                    f"shares of trial {trial!r}: must be exactly the parts {', '.join(PARTS)}, got {', '.join(parts)}"
                )
        return self

    def machine(self, record: TrialRecord) -> Machine | None:
        """Return the machine of a trial; None if it is unknown."""
        return self.machines.get(record.environment)

    def repeats_itself(self, record: TrialRecord) -> bool:
        """Return whether the trial's engine declares that it repeats bit for bit across processes."""
        machine = self.machine(record)
        engine = machine.engines.get(record.engine) if machine else None
        return engine is not None and engine.deterministic == "across processes"

    def is_limited(self, record: TrialRecord) -> bool:
        """Return whether the time limit may have determined the end of the trial.

        A stack that is falling at the time limit counts as collapsed, although its fall may not be complete.
        """
        slow = record.status == "collapsed" and record.wall_s is not None and record.wall_s >= self.trial_wall_s
        return record.status == "timeout" or slow


def read_baseline(path: Path) -> Baseline:
    """Return the side of a comparison from a results folder or a baseline file.

    Raises:
        BaselineError: if ``path`` is neither a results folder nor a baseline file, or is incomplete.
    """
    try:
        baseline = _read_folder(path) if path.is_dir() else _read_baseline_file(path)
    except (JsonError, RecordError) as error:
        raise BaselineError(str(error)) from error
    except ValidationError as error:
        raise BaselineError(
            f"{path}: not a baseline of this suite: {_first(error)}; create the file again with 'bench baseline'"
        ) from error
    seen: set[str] = set()
    for record in baseline.trials:
        if record.trial in seen:
            raise BaselineError(
                f"{path}: trial {record.trial[:200]!r} must occur once, but occurs twice; remove one of the two records"
            )
        seen.add(record.trial)
    return baseline


def of_engines(side: Baseline, engines: Sequence[str] | None) -> Baseline:
    """Return the trials of the named engines only; all trials if none is named.

    Raises:
        BaselineError: if the side has no trial of these engines.
    """
    if not engines:
        return side
    trials = [record for record in side.trials if record.engine in engines]
    if not trials:
        has = ", ".join(sorted({record.engine for record in side.trials}))
        raise BaselineError(f"a side has no trial of {', '.join(engines)}: its engines are {has}")
    return side.model_copy(update={"trials": trials})


def write_baseline(baseline: Baseline, path: Path) -> None:
    """Write a baseline into a file atomically; replace an existing file only if it is a baseline.

    Raises:
        BaselineError: if ``path`` is a folder or a file of another kind, or cannot be written.
    """
    if path.is_dir():
        raise BaselineError(f"{path} must be a file, but is a folder: name a file with -o")
    if path.exists():
        try:
            _read_baseline_file(path)
        except (JsonError, ValidationError):
            raise BaselineError(
                f"{path} must be a baseline file or a new file, but is a file of another kind: name another file with "
                "-o"
            ) from None
    try:
        write_atomic(path, (baseline.model_dump_json(indent=1) + "\n").encode())
    except OSError as error:
        raise BaselineError(f"{path} cannot be written ({error.strerror}): name another file with -o") from error


def _read_baseline_file(path: Path) -> Baseline:
    content = read_file(path)
    found = parse(content, str(path))
    if not isinstance(found, dict) or found.get("format") != FORMAT:
        raise JsonError(
            f"{path}: not a baseline ('format' is not '{FORMAT}'): create one with 'bench baseline DIR -o FILE', or "
            "name a results folder"
        )
    return Baseline.model_validate_json(content, strict=True)


def _read_folder(folder: Path) -> Baseline:
    path = folder / TRIALS
    content = read_file(path)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RecordWarning)  # the trial of an incomplete line is reported as missing
        records = read_records(path)
    if not records:
        raise BaselineError(
            f"{path}: a comparison needs at least one trial, but the folder contains none; run the study first"
        )
    whole = content if content.endswith(b"\n") else content.rpartition(b"\n")[0]
    for number, line in enumerate(whole.splitlines(), start=1):
        if line.strip():
            parse(line, f"{path}:{number}")
    study = _study(folder / STUDY)
    return Baseline(
        study=study.name,
        trial_wall_s=study.limits.trial_wall_s,
        tolerances={one.name: one.tolerance for one in study.scenario if one.tolerance != Tolerance()},
        machines=_machines(folder),
        shares=_shares(folder, records),
        trials=[record.model_copy(update={"host": None, "core": None}) for record in records],
    )


class _Kept(BaseModel):
    """Fields of a study file that a comparison needs; ``Study`` would require that its engines are installed."""

    model_config = ConfigDict(extra="ignore", allow_inf_nan=False)


class _KeptLimits(_Kept):
    trial_wall_s: float = Field(gt=0)


class _KeptScenario(_Kept):
    name: str
    tolerance: Tolerance = Tolerance()


class _KeptStudy(_Kept):
    name: str
    limits: _KeptLimits
    scenario: list[_KeptScenario]


def _study(path: Path) -> _KeptStudy:
    try:
        return _KeptStudy.model_validate(tomllib.loads(read_file(path).decode("utf-8")))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, RecursionError) as error:
        raise BaselineError(f"{path}: not valid TOML: {error}; restore the file, or run the study again") from error
    except ValidationError as error:
        raise BaselineError(
            f"{path}: not the study file of a run: {_first(error)}; restore the file, or run the study again"
        ) from error


def _machines(folder: Path) -> dict[str, Machine]:
    """Return the machines that a folder describes, by digest; empty without environment files.

    Without an environment file, a comparison judges only the outcomes of a run.
    """
    machines = {}
    for path in sorted(folder.glob("environment*.json")):
        environment = parse(read_file(path), str(path))
        if not isinstance(environment, dict):
            raise BaselineError(f"{path}: not the environment file of a run; run the study again, or restore the file")
        description = {key: value for key, value in environment.items() if key != SESSIONS}
        name = digest(description) if path.name == ENVIRONMENT else path.stem.removeprefix("environment-")
        try:
            machines[name] = _machine(description)
        except (KeyError, TypeError, AttributeError, ValidationError):
            raise BaselineError(
                f"{path}: not the environment file of a run; run the study again, or restore the file"
            ) from None
    return machines


def _shares(folder: Path, records: Sequence[TrialRecord]) -> dict[str, dict[Part, float]]:
    """Return ``Baseline.shares`` for the trials with recorded frames."""
    kept = {path.stem: path for path in (folder / "frames").glob("*.parquet")}
    found = {}
    for record in records:
        path = kept.get(record.trial)
        if path is None or record.core_ms is None or record.timed_frames is None:
            continue
        try:
            found[record.trial] = shares(read_frames(path), record.timed_frames)
        except (pa.ArrowInvalid, OSError, KeyError, TypeError, ValueError) as error:
            raise BaselineError(f"{path}: not the frames of a trial: {error}; run the trial again") from error
    return {trial: parts for trial, parts in found.items() if parts}


def _machine(environment: Mapping[str, Any]) -> Machine:
    kept = {name: environment[name] for name in Machine.model_fields if name != "engines"}
    engines = {
        name: Engine(
            version=engine["version"],
            deterministic=engine["capabilities"]["deterministic"],
            missing_knobs=engine.get("missing_knobs", ()),
        )
        for name, engine in environment["engines"].items()
    }
    return Machine(**kept, engines=engines)


def _first(error: ValidationError) -> str:
    """Return the first error without the text of the file, because that text is untrusted."""
    first = error.errors(include_url=False, include_input=False)[0]
    field = ".".join(map(str, first["loc"]))[:200]
    return f"field '{field}': {first['msg']}" if field else str(first["msg"])
