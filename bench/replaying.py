"""Replays of a results folder: of one trial beside its other policies, and of all that a report links to."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from bench.results import RECORDINGS
from reports.cells import ordered_policies
from reports.gltf import to_glb
from reports.recording import RecordingError, read_recording
from reports.records import TrialRecord
from reports.replay import Replayed, write_replay
from reports.writing import write_whole
from stability_core.lookup import look_up


def replay_trial(folder: Path, records: Sequence[TrialRecord], trial: str) -> Path:
    """Write the replay of a trial, side by side with the same stack under the other policies; returns the page.

    Raises:
        UnknownNameError: if there is no such trial.
        RecordingError: if it was not recorded, or its recording is torn.
    """
    wanted = look_up("trial", trial, {record.trial: record for record in records})
    shown = Replayed(wanted, read_recording(_recording(folder, wanted)))
    others = [record for record in records if _stack(record) == _stack(wanted) and record.trial != wanted.trial]
    return _write(folder, [shown, *_readable(folder, others)])


def export_gltf(folder: Path, records: Sequence[TrialRecord], trial: str, to: Path) -> None:
    """Write a trial's recording as an animated glTF file; errors as ``replay_trial``."""
    wanted = look_up("trial", trial, {record.trial: record for record in records})
    write_whole(to, to_glb(read_recording(_recording(folder, wanted))))


def write_replays(folder: Path, records: Sequence[TrialRecord]) -> None:
    """Write the replay of the first recorded seed of each scene, engine and profile, beside the report."""
    stacks: dict[tuple[object, ...], list[TrialRecord]] = {}
    for record in sorted(records, key=lambda record: (record.seed, record.repeat)):
        if _recording(folder, record).exists():
            stacks.setdefault(_stack(record), []).append(record)
    first = {stack[:3]: those for stack, those in reversed(stacks.items())}
    for those in first.values():
        trials = _readable(folder, those)
        if trials:
            _write(folder, trials)


def _stack(record: TrialRecord) -> tuple[object, ...]:
    """What trials share that differ by policy alone."""
    return record.scene, record.engine, record.profile, record.seed, record.repeat


def _recording(folder: Path, record: TrialRecord) -> Path:
    return folder / RECORDINGS / f"{record.trial}.parquet"


def _readable(folder: Path, records: Sequence[TrialRecord]) -> list[Replayed]:
    """Those whose recording is there and whole."""
    found = []
    for record in records:
        try:
            found.append(Replayed(record, read_recording(_recording(folder, record))))
        except RecordingError:
            continue
    return found


def _write(folder: Path, trials: Sequence[Replayed]) -> Path:
    policies = ordered_policies(trial.record.policy for trial in trials)
    trials = sorted(trials, key=lambda trial: policies.index(trial.record.policy))
    first = trials[0].record
    name = f"{first.scene}.{first.engine}.{first.profile}.s{first.seed}"
    return write_replay(folder / "report" / "replays", name, trials)
