"""The results folder of a run, with the same file names for every run.

An interrupted run continues in its folder. After any interruption, even a power cut, a trial with a record on disk also
has its other files. The continued run repeats each trial without a record.
"""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from filelock import FileLock, Timeout

from adapters import EngineNotInstalledError
from bench.machine.environment import digest, session
from bench.studies.plan import waiting_trials
from bench.studies.schema import Study, StudyError, load_study
from bench.studies.toml_text import to_toml
from bench.trial.run_trial import Outcome
from reports.records.atomic import write_atomic
from reports.records.folder import ENVIRONMENT, FRAMES, RECORDINGS, REPORT, STUDY, TRACES, TRIALS
from reports.records.frames import write_frames
from reports.records.pose_trace import write_pose_trace
from reports.records.recording import write_recording
from reports.records.trial import RecordWriter, Status, TrialRecord, read_records

SESSIONS = "sessions"
"""Key of the list of sessions in the environment file: the state of the machine at each start of the run."""
_LOCK = ".lock"
_PARTS = (STUDY, ENVIRONMENT, TRIALS, FRAMES, RECORDINGS, TRACES, REPORT)
"""Names of the files and folders of a run, except the lock and the files of further environments."""
_NAMES = {"lock_sha256": "uv.lock", "modified": "uncommitted changes", "core": "stability_core"}
"""Plain names for keys of the environment, for messages."""


class ResultsError(ValueError):
    """Error for a folder that cannot take results; the message names the fix."""


def check_folder(folder: Path) -> None:
    """Check that this process can write into a folder, or can create the folder.

    Raises:
        ResultsError: if this process cannot create the folder, or cannot write into the folder.
    """
    nearest = next(parent for parent in (folder, *folder.absolute().parents) if parent.exists())
    if not nearest.is_dir():
        raise ResultsError(f"{folder}: {nearest} must be a folder, but is a file: choose another folder with --out")
    if not os.access(nearest, os.W_OK | os.X_OK):
        raise ResultsError(f"{folder}: {nearest} must be writable, but is not: choose another folder with --out")


def changes(folder: Path, study: Study, environment: Mapping[str, Any]) -> list[str]:
    """Return the names of the properties that differ between this run and the earlier run in ``folder``.

    The list is empty if the folder has no trials. It contains "study" if the earlier study is not readable.

    Raises:
        EngineNotInstalledError: if the package of an engine of the earlier study is missing.
    """
    if not (folder / TRIALS).exists():
        return []
    different = []
    try:
        if not load_study(str(folder / STUDY)).has_same_plan(study):
            different.append("study")
    except StudyError:
        different.append("study")
    before = _kept_environment(folder)
    return different + [_NAMES.get(key, key) for key in environment if before.get(key) != environment[key]]


def missing_trials(folder: Path, records: Sequence[TrialRecord]) -> list[str]:
    """Return the ids of planned trials without a record; empty if the study in the folder does not load.

    A report is possible even if the study does not load, for example because an engine's package is missing.
    """
    try:
        study = load_study(str(folder / STUDY))
    except (StudyError, EngineNotInstalledError):
        return []
    return [trial.id for trial in waiting_trials(study, {record.trial: record.status for record in records})]


class Results:
    """Results folder that receives the outcomes of a run one by one, with a lock against a second run in the folder."""

    def __init__(
        self,
        folder: Path,
        study: Study,
        environment: Mapping[str, Any],
        *,
        fresh: bool = False,
        accept_changes: bool = False,
    ) -> None:
        """Create the folder, or continue with the trials in the folder.

        Args:
            folder: the results folder.
            study: the study to run.
            environment: the environment that all trials share.
            fresh: True to replace the trials of an earlier run.
            accept_changes: True to continue although study, commit or machine differ; each record names its
                environment.

        Raises:
            ResultsError: if this process cannot write into the folder; if another run uses the folder; or, without
                ``accept_changes``, if the trials in the folder belong to another study or environment.
            EngineNotInstalledError: if the package of an engine of the study in the folder is missing.
            RecordError: if a complete line of the records is not a record.
        """
        check_folder(folder)
        folder.mkdir(parents=True, exist_ok=True)
        self.folder = folder
        self._lock = FileLock(folder / _LOCK)  # the system releases it when the process ends
        try:
            self._lock.acquire(blocking=False)
        except Timeout:
            raise ResultsError(
                f"another run uses {folder}: wait for the end of that run, or choose another folder with --out"
            ) from None
        try:
            if fresh:
                _clear(folder)
            different = changes(folder, study, environment)
            if different and not accept_changes:
                raise ResultsError(_refusal(folder, different))
            self._open(study, environment, bool(different))
        except BaseException:
            self._lock.release()
            raise

    def _open(self, study: Study, environment: Mapping[str, Any], different: bool) -> None:
        folder, self._environment = self.folder, digest(environment)
        if different:
            _put_aside(folder)
        sessions = _kept_environment(folder).get(SESSIONS, []) if (folder / TRIALS).exists() else []
        content = {**environment, SESSIONS: [*sessions, session()]}
        write_atomic(folder / STUDY, to_toml(study).encode())
        write_atomic(folder / ENVIRONMENT, (json.dumps(content, indent=2) + "\n").encode())
        self._frames = folder / FRAMES
        self._frames.mkdir(exist_ok=True)
        self._recordings = folder / RECORDINGS
        self._recordings.mkdir(exist_ok=True)
        self._traces = folder / TRACES
        self._traces.mkdir(exist_ok=True)
        self._writer = RecordWriter(folder / TRIALS)
        self.torn = self._writer.torn
        """True if an interruption left the last line of the records incomplete; the run repeats the trial of this
        line."""
        self.statuses: dict[str, Status] = {record.trial: record.status for record in read_records(folder / TRIALS)}
        """Status of each recorded trial, by the id of the trial."""

    @property
    def finished(self) -> set[str]:
        """Ids of the recorded trials."""
        return set(self.statuses)

    def know(self, environment: Mapping[str, Any]) -> None:
        """Write the environment of another machine to a file with its digest in the name, if there is no such file."""
        file = self.folder / f"environment-{digest(environment)}.json"
        if digest(environment) != self._environment and not file.exists():
            write_atomic(file, (json.dumps(environment, indent=2) + "\n").encode())

    def keep(self, outcome: Outcome) -> None:
        """Write the files of a trial, then its record, so that a trial with a record has complete files."""
        if outcome.frames:
            write_frames(self._frames / f"{outcome.record.trial}.parquet", outcome.frames)
        if outcome.recording is not None:
            write_recording(self._recordings / f"{outcome.record.trial}.parquet", outcome.recording)
        if outcome.trace is not None:
            write_pose_trace(self._traces / f"{outcome.record.trial}.parquet", outcome.trace)
        self._writer.append(outcome.record)
        self.statuses[outcome.record.trial] = outcome.record.status

    def close(self) -> None:
        """Close the file of records and release the lock of the folder."""
        self._writer.close()
        self._lock.release()


def _clear(folder: Path) -> None:
    """Remove the files of an earlier run, the records first, so that no record remains without its files."""
    for name in (TRIALS, *_PARTS):
        part = folder / name
        if part.is_dir():
            shutil.rmtree(part)
        else:
            part.unlink(missing_ok=True)
    for environment in folder.glob("environment-*.json"):
        environment.unlink()


def _kept_environment(folder: Path) -> dict[str, Any]:
    try:
        kept = json.loads((folder / ENVIRONMENT).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return kept if isinstance(kept, dict) else {}


def _put_aside(folder: Path) -> None:
    """Put the digest that the earlier trials record into the name of their environment file, if it is readable."""
    kept = _kept_environment(folder)
    if kept:
        name = digest({key: value for key, value in kept.items() if key != SESSIONS})
        (folder / ENVIRONMENT).replace(folder / f"environment-{name}.json")


def _refusal(folder: Path, different: Sequence[str]) -> str:
    return (
        f"{folder} holds trials of another run; changed since: {', '.join(different)}; choose another folder with "
        "--out, replace the trials with --fresh, or continue nevertheless with --accept-changes"
    )
