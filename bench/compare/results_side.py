"""Read a results folder as one side of a comparison."""

from __future__ import annotations

import tomllib
import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pyarrow as pa
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from bench.compare.side import Baseline, BaselineError, Engine, Machine, first_error
from bench.compare.strict_json import parse, read_file
from bench.compare.timing import Part, shares
from bench.execution.results import SESSIONS
from bench.machine.environment import digest
from bench.studies.tolerance import Tolerance
from reports.records.folder import ENVIRONMENT, STUDY, TRACES, TRIALS
from reports.records.frames import read_frames
from reports.records.trial import RecordWarning, TrialRecord, read_records


def read_folder(folder: Path) -> Baseline:
    """Return the side in a results folder.

    Raises:
        BaselineError: if the folder has no trials, or contains an invalid file.
        JsonError, RecordError: if a record or an environment is invalid, or a file is unreadable.
    """
    path = folder / TRIALS
    content = read_file(path)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RecordWarning)  # the trial of an incomplete line is reported as missing
        records = read_records(path)
    if not records:
        raise BaselineError(
            f"{path}: a comparison or a baseline needs at least one trial, but the file contains none; run the study "
            "first"
        )
    whole = content if content.endswith(b"\n") else content.rpartition(b"\n")[0]
    for number, line in enumerate(whole.splitlines(), start=1):
        if line.strip():
            parse(line, f"{path}:{number}")
    study = _study(folder / STUDY)
    side = Baseline(
        study=study.name,
        trial_wall_s=study.limits.trial_wall_s,
        tolerances={
            scenario.name: scenario.tolerance for scenario in study.scenario if scenario.tolerance != Tolerance()
        },
        machines=_machines(folder),
        shares=_shares(folder, records),
        trials=[record.model_copy(update={"host": None, "core": None}) for record in records],
    )
    return side.with_trace_files(_trace_files(folder, records))


def _trace_files(folder: Path, records: Sequence[TrialRecord]) -> dict[str, Path]:
    """Return the files of pose traces, by pose hash; repeats with equal poses share a file."""
    kept = {path.stem: path for path in (folder / TRACES).glob("*.parquet")}
    return {record.pose_hash: kept[record.trial] for record in records if record.pose_hash and record.trial in kept}


class _Kept(BaseModel):
    """Fields of a study file that a comparison needs; ``Study`` would require the packages of its engines."""

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
            f"{path}: not the study file of a run: {first_error(error)}; restore the file, or run the study again"
        ) from error


def _machines(folder: Path) -> dict[str, Machine]:
    """Return the machines that a folder describes, by digest; empty without environment files.

    Without an environment file, a comparison judges only the outcomes of a run.
    """
    machines = {}
    for path in sorted(folder.glob("environment*.json")):
        environment = parse(read_file(path), str(path))
        if not isinstance(environment, dict):
            raise BaselineError(
                f"{path}: not the environment file of a run (must be a JSON object, got {type(environment).__name__}); "
                "run the study again, or restore the file"
            )
        description = {key: value for key, value in environment.items() if key != SESSIONS}
        name = digest(description) if path.name == ENVIRONMENT else path.stem.removeprefix("environment-")
        try:
            machines[name] = _machine(description)
        except (KeyError, TypeError, AttributeError, ValidationError) as error:
            cause = first_error(error) if isinstance(error, ValidationError) else f"{type(error).__name__}: {error}"
            raise BaselineError(
                f"{path}: not the environment file of a run ({cause[:200]}); run the study again, or restore the file"
            ) from None
    return machines


def _shares(folder: Path, records: Sequence[TrialRecord]) -> dict[str, dict[Part, float]]:
    """Return ``Baseline.shares`` for the trials with the core that have recorded frames."""
    kept = {path.stem: path for path in (folder / "frames").glob("*.parquet")}
    by_trial = {}
    for record in records:
        path = kept.get(record.trial)
        if path is None or record.core_ms is None or record.timed_frames is None:
            continue
        try:
            by_trial[record.trial] = shares(read_frames(path), record.timed_frames)
        except (pa.ArrowInvalid, OSError, KeyError, TypeError, ValueError) as error:
            raise BaselineError(f"{path}: not the frames of a trial: {error}; run the trial again") from error
    return {trial: parts for trial, parts in by_trial.items() if parts}


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
