"""The results folder: names of its files, and access to its content."""

from __future__ import annotations

import csv
import json
import tomllib
from collections.abc import Iterator, Mapping
from functools import cached_property
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from reports.records.creep import with_creep
from reports.records.flat import from_flat
from reports.records.recording import Recording, RecordingError, read_recording
from reports.records.trial import RecordError, TrialRecord, read_records

TRIALS = "trials.jsonl"
"""File of the records of a run."""
PARQUET = "trials.parquet"
"""File of the trials of a published folder."""
PUBLISHED_TRIALS = (PARQUET, "trials.csv")
"""Names of the file of trials in a published folder: the name in this version, then the name in earlier versions."""
STUDY = "study.toml"
"""File of the resolved study."""
ENVIRONMENT = "environment.json"
"""File of the environment of the run."""
FRAMES = "frames"
"""Folder of the tables of frames."""
RECORDINGS = "recordings"
"""Folder of the recordings."""
TRACES = "traces"
"""Folder of the pose traces."""
REPORT = "report"
"""Folder of the report."""


class ResultsFolder:
    """A folder with the results of a run, or with the published part of these results."""

    def __init__(self, path: Path) -> None:
        """Keep the path of the folder, without reading its files."""
        self.path = path

    @property
    def report(self) -> Path:
        """Folder of the report."""
        return self.path / REPORT

    @property
    def trials_file(self) -> Path:
        """Path of the file of trials: the first existing of ``TRIALS`` and ``PUBLISHED_TRIALS``, else ``TRIALS``."""
        names = (TRIALS, *PUBLISHED_TRIALS)
        return next((self.path / name for name in names if (self.path / name).exists()), self.path / TRIALS)

    @property
    def study_file(self) -> Path:
        """Path of the resolved study."""
        return self.path / STUDY

    def frames_file(self, trial: str) -> Path:
        """Return the path of the table of frames of a trial."""
        return self.path / FRAMES / f"{trial}.parquet"

    def recording_file(self, trial: str) -> Path:
        """Return the path of the recorded poses of a trial."""
        return self.path / RECORDINGS / f"{trial}.parquet"

    def trace_file(self, trial: str) -> Path:
        """Return the path of the pose trace of a trial."""
        return self.path / TRACES / f"{trial}.parquet"

    @cached_property
    def records(self) -> list[TrialRecord]:
        """Records of all trials, in the order of the file.

        Records of ``TRIALS`` from before format 3 receive the creep that their recordings prove.

        Raises:
            RecordError: if the file of trials is missing or unreadable, or contains a row that is not a record.

        Warns:
            RecordWarning: if the last line of ``TRIALS`` is incomplete; the reader skips this line.
        """
        file = self.trials_file
        if file.name == TRIALS:
            return [self._with_creep(record) for record in read_records(file)]
        try:
            rows = list(published_rows(file))
        except (ValueError, pa.ArrowException) as error:
            raise RecordError(
                f"{file}: not a table of trials ({error}); restore the file, or publish the study again"
            ) from error
        return [_record(row, f"{file}: row {number}") for number, row in enumerate(rows, start=1)]

    def _with_creep(self, record: TrialRecord) -> TrialRecord:
        """Return a record with the creep that its recording proves; see ``creep.with_creep``.

        A record without a readable recording stays unchanged.
        """
        if record.mean_motion_m_s is None or not self.recording_file(record.trial).exists():
            return record
        try:
            return with_creep(record, self.recording(record.trial))
        except RecordingError:  # an incomplete recording proves nothing
            return record

    def recording(self, trial: str) -> Recording:
        """Return the recorded poses of a trial.

        Raises:
            RecordingError: if the file is missing, incomplete, or not a recording.
        """
        return read_recording(self.recording_file(trial))

    @cached_property
    def environment(self) -> Mapping[str, Any]:
        """Machine, versions, settings and sessions of the run; empty if the folder has no readable environment."""
        try:
            kept = json.loads((self.path / ENVIRONMENT).read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return {}
        return kept if isinstance(kept, dict) else {}

    @property
    def engines(self) -> Mapping[str, Any]:
        """Descriptions of the engines in the environment, by name; empty if the environment contains none."""
        engines: Mapping[str, Any] = self.environment.get("engines", {})
        return engines

    @property
    def reference_engines(self) -> frozenset[str]:
        """Names of the reference engines, which are not products and have no place in a ranking."""
        return frozenset(
            name for name, engine in self.engines.items() if engine.get("capabilities", {}).get("reference", False)
        )

    @cached_property
    def study(self) -> Mapping[str, Any]:
        """Content of the resolved study; empty if the folder has no readable study."""
        try:
            return tomllib.loads(self.study_file.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return {}


def _record(row: Mapping[str, Any], place: str) -> TrialRecord:
    try:
        return from_flat(row)
    except ValueError as error:
        raise RecordError(f"{place}: {error}") from error


def published_rows(file: Path) -> Iterator[Mapping[str, Any]]:
    """Yield the rows of a published table of trials, without conversion to records.

    Args:
        file: a Parquet file (suffix ``.parquet``), or a CSV file (any other suffix).
    """
    if file.suffix == ".parquet":
        with pq.ParquetFile(file) as table:
            yield from table.read().to_pylist()
        return
    with file.open(encoding="utf-8", newline="") as lines:
        yield from csv.DictReader(lines)


def replay_name(trial: TrialRecord) -> str:
    """Return the file name, without suffix, of the replay of a trial.

    Trials that differ only in policy or repeat have the same name, because one replay shows a stack under all policies.
    """
    return f"{trial.scene}.{trial.engine}.{trial.profile}.s{trial.seed}"


def still_of(folder: Path, trial: TrialRecord) -> Path:
    """Return the path of a trial's still in a folder of stills; the file need not exist."""
    return folder / f"{trial.trial}.png"
