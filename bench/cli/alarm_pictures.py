"""Pictures of the stacks in the alarms of a comparison, for the comment on a pull request."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from pathlib import Path

from bench.cli.console import note, relative
from bench.cli.replay import side_by_side
from bench.compare.findings import Comparison, Finding, Gate, plain, without_repeat
from reports.records.folder import ResultsFolder
from reports.records.recording import RecordingError
from reports.records.trial import TrialRecord
from reports.replays.errors import ExportError
from reports.replays.pictures import write_still

MOST_PICTURES = 4
"""Greatest number of pictures of a comparison, because a picture takes seconds, and a comment must stay short."""
_PIXELS = (960, 540)
"""Width and height of a picture."""


def draw_alarms(comparison: Comparison, gates: Collection[Gate], head: Path, to: Path) -> list[tuple[str, Path]]:
    """Draw the end of each trial of the head with a worse outcome, beside the same stack without a policy.

    The picture omits the stack without a policy if the folder has no recording of this stack. The function skips a
    trial that it cannot draw, for example without a recording, and prints the reason.

    Args:
        comparison: the comparison.
        gates: gates whose alarms count; without ``outcome`` the function draws no pictures.
        head: results folder of the head.
        to: folder of the pictures, created if necessary. The files have numbers as names, because an id of a trial may
            contain any character.

    Returns:
        Id of the trial and file of each picture: at most ``MOST_PICTURES`` pictures, and one picture for all repeats of
        a trial.
    """
    if "outcome" not in gates:
        return []
    records = ResultsFolder(head).records
    drawn: list[tuple[str, Path]] = []
    for record in _worse(comparison.alarms(["outcome"]), records):
        if len(drawn) == MOST_PICTURES:
            break
        to.mkdir(parents=True, exist_ok=True)
        file = to / f"{len(drawn) + 1}.png"
        try:
            write_still(file, side_by_side(head, records, record.trial, None), _PIXELS)
        except (ExportError, RecordingError) as error:
            note(f"no picture of {plain(record.trial)}: {plain(str(error))}")
            continue
        note(f"the picture of {plain(record.trial)} is {relative(file)}")
        drawn.append((record.trial, file))
    return drawn


def _worse(alarms: Collection[Finding], records: Collection[TrialRecord]) -> Iterator[TrialRecord]:
    """Yield the first recorded repeat of each trial in ``alarms``."""
    names = {without_repeat(alarm.trial) for alarm in alarms}
    for record in records:
        if (name := without_repeat(record.trial)) in names:
            names.remove(name)
            yield record
