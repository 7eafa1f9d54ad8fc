"""Replays and stills of a results folder: of one trial beside its other policies, and of all that a report shows."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from bench.results import RECORDINGS, TRIALS
from reports.records.atomic import write_atomic
from reports.records.folder import replay_name, still_of
from reports.records.recording import RecordingError, read_recording
from reports.records.trial import TrialRecord
from reports.replays.gltf import to_glb
from reports.replays.replay import Replayed, write_replay
from reports.replays.stills import StillsError, write_stills
from reports.statistics.groups import ordered_policies
from stability_core.lookup import look_up

MOST_STILLS = 120
"""More than these are drawn only if asked for: a run of the paper's stacks has fewer and waits some 30 s for them."""


def replay_trial(folder: Path, records: Sequence[TrialRecord], trial: str) -> Path:
    """Write the replay of a trial, side by side with the same stack under the other policies; returns the page.

    Raises:
        UnknownNameError: if there is no such trial.
        RecordingError: if it was not recorded, or its recording is torn.
    """
    wanted = look_up("trial", trial, {record.trial: record for record in records})
    shown = Replayed(wanted, read_recording(_recording(folder, wanted)))
    others = [record for record in records if _stack(record) == _stack(wanted) and record.trial != wanted.trial]
    return _write(folder, [shown, *read_stack(folder, others)])


def export_gltf(folder: Path, records: Sequence[TrialRecord], trial: str, to: Path) -> None:
    """Write a trial's recording as an animated glTF file; errors as ``replay_trial``."""
    wanted = look_up("trial", trial, {record.trial: record for record in records})
    write_atomic(to, to_glb(read_recording(_recording(folder, wanted))))


def first_stacks(folder: Path, records: Sequence[TrialRecord]) -> list[list[TrialRecord]]:
    """The first recorded seed of each scene, engine and profile, under all policies."""
    stacks: dict[tuple[object, ...], list[TrialRecord]] = {}
    for record in sorted(records, key=lambda record: (record.seed, record.repeat)):
        if _recording(folder, record).exists():
            stacks.setdefault(_stack(record), []).append(record)
    return list({stack[:3]: those for stack, those in reversed(stacks.items())}.values())


def write_replays(folder: Path, stacks: Sequence[Sequence[TrialRecord]]) -> None:
    """Write the replay of each stack beside the report."""
    for those in stacks:
        trials = read_stack(folder, those)
        if trials:
            _write(folder, trials)


def draw_stills(folder: Path, stacks: Sequence[Sequence[TrialRecord]], *, however_many: bool) -> str:
    """Draw how each trial ended, beside the report; returns why some were not drawn, empty if all are there.

    Stills that are newer than the records are left as they are.

    Args:
        folder: a results folder.
        stacks: whose trials are drawn.
        however_many: False to draw none if they are more than ``MOST_STILLS``.
    """
    stills, changed = folder / "report" / "stills", (folder / TRIALS).stat().st_mtime
    waiting = [those for those in stacks if any(_is_older(still_of(stills, one), changed) for one in those)]
    count = sum(map(len, waiting))
    if count > MOST_STILLS and not however_many:
        return f"{count} stills would take minutes and were not drawn: uv run -m bench report {folder} --stills"
    try:
        write_stills(stills, (read_stack(folder, those) for those in waiting))
    except StillsError as error:
        return str(error)
    return ""


def _is_older(path: Path, time: float) -> bool:
    return not path.exists() or path.stat().st_mtime < time


def _stack(record: TrialRecord) -> tuple[object, ...]:
    """What trials share that differ by policy alone."""
    return record.scene, record.engine, record.profile, record.seed, record.repeat


def _recording(folder: Path, record: TrialRecord) -> Path:
    return folder / RECORDINGS / f"{record.trial}.parquet"


def read_stack(folder: Path, records: Sequence[TrialRecord]) -> list[Replayed]:
    """The trials whose recording is there and whole."""
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
    return write_replay(folder / "report" / "replays", replay_name(trials[0].record), trials)
