"""Replays and stills of the stacks of a results folder.

In this module, a stack is the list of the trials of one scene, engine, profile, seed and repeat under all policies.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from reports.records.folder import ResultsFolder, replay_name, still_of
from reports.records.recording import RecordingError
from reports.records.trial import TrialRecord
from reports.replays.margins import margins_beside
from reports.replays.replay import Replayed, write_replay
from reports.replays.stills import StillsError, write_stills
from reports.statistics.groups import ordered_policies

MOST_STILLS = 120
"""Greatest number of stills that a report draws without a request. The limit exceeds the number of stills of the study
``paper``, because these stills take only about 30 s."""


def first_stacks(folder: Path, records: Sequence[TrialRecord]) -> list[list[TrialRecord]]:
    """Return the stack with the first recorded seed and repeat, for each scene, engine and profile."""
    stacks: dict[tuple[object, ...], list[TrialRecord]] = {}
    for record in sorted(records, key=lambda record: (record.seed, record.repeat)):
        if ResultsFolder(folder).recording_file(record.trial).exists():
            stacks.setdefault(stack_of(record), []).append(record)
    return list({stack[:3]: those for stack, those in reversed(stacks.items())}.values())


def read_stack(folder: Path, records: Sequence[TrialRecord]) -> list[Replayed]:
    """Return the trials with complete recordings, in the order of ``records``, with their recordings."""
    found = []
    for record in records:
        try:
            found.append(Replayed(record, ResultsFolder(folder).recording(record.trial)))
        except RecordingError:
            continue
    return found


def write_replays(folder: Path, stacks: Sequence[Sequence[TrialRecord]]) -> None:
    """Write the replays of stacks into the report of a results folder; skip stacks without a complete recording."""
    for those in stacks:
        trials = read_stack(folder, those)
        if trials:
            write_stack_replay(folder, trials)


def write_stack_replay(folder: Path, trials: Sequence[Replayed], *, with_margins: bool = False) -> Path:
    """Write the replay of one stack into the report, and return the path of the replay.

    Policies are in their usual order.

    Args:
        folder: a results folder.
        trials: the trials of the stack.
        with_margins: True to add the margins of the bricks, which takes seconds to minutes.

    Raises:
        ExportError: if ``with_margins`` is True and ``margins_beside`` fails.
    """
    policies = ordered_policies(trial.record.policy for trial in trials)
    trials = sorted(trials, key=lambda trial: policies.index(trial.record.policy))
    margins = margins_beside({trial.record.trial: trial.recording for trial in trials}) if with_margins else None
    return write_replay(folder / "report" / "replays", replay_name(trials[0].record), trials, margins)


def draw_stills(folder: Path, stacks: Sequence[Sequence[TrialRecord]], *, however_many: bool) -> str:
    """Draw the stills of stacks into the report of a results folder.

    A stack keeps its stills if all of them exist and are at least as new as the records.

    Args:
        folder: a results folder.
        stacks: the stacks to draw.
        however_many: False to draw no stills if more than ``MOST_STILLS`` stills are missing or too old.

    Returns:
        Message with the reason if the function could not draw the stills; else empty.
    """
    stills, changed = folder / "report" / "stills", ResultsFolder(folder).trials_file.stat().st_mtime
    waiting = [those for those in stacks if any(_is_older(still_of(stills, one), changed) for one in those)]
    count = sum(map(len, waiting))
    if count > MOST_STILLS and not however_many:
        return f"{count} stills were not drawn, because they take minutes: uv run -m bench report {folder} --stills"
    try:
        write_stills(stills, (read_stack(folder, those) for those in waiting))
    except StillsError as error:
        return str(error)
    return ""


def _is_older(path: Path, time: float) -> bool:
    return not path.exists() or path.stat().st_mtime < time


def stack_of(record: TrialRecord) -> tuple[object, ...]:
    """Return the properties that all trials of a stack share: scene, engine, profile, seed and repeat."""
    return record.scene, record.engine, record.profile, record.seed, record.repeat
