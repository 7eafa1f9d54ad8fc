"""Replays of single trials of a results folder, beside the same stack under the other policies."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from reports.records.atomic import write_atomic
from reports.records.folder import ResultsFolder
from reports.records.trial import TrialRecord
from reports.replays.gltf import to_glb
from reports.replays.replay import Replayed
from reports.replays.stacks import read_stack, stack_of, write_stack_replay
from scenarios.lookup import look_up


def replay_trial(folder: Path, records: Sequence[TrialRecord], trial: str) -> Path:
    """Write the replay of a trial, side by side with the same stack under the other policies; returns the page.

    Raises:
        UnknownNameError: if there is no such trial.
        RecordingError: if it was not recorded, or its recording is torn.
    """
    wanted = look_up("trial", trial, {record.trial: record for record in records})
    shown = Replayed(wanted, ResultsFolder(folder).recording(wanted.trial))
    others = [record for record in records if stack_of(record) == stack_of(wanted) and record.trial != wanted.trial]
    return write_stack_replay(folder, [shown, *read_stack(folder, others)])


def export_gltf(folder: Path, records: Sequence[TrialRecord], trial: str, to: Path) -> None:
    """Write a trial's recording as an animated glTF file; errors as ``replay_trial``."""
    wanted = look_up("trial", trial, {record.trial: record for record in records})
    write_atomic(to, to_glb(ResultsFolder(folder).recording(wanted.trial)))
