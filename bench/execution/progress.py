"""Show the progress of a run: live bars on a terminal, else plain lines, so that a log file stays readable."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from contextlib import AbstractContextManager
from types import TracebackType

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, TaskID, TextColumn, TimeRemainingColumn
from rich.progress import Progress as Bars

from bench.studies.plan import Trial
from bench.trial.playback import Progress
from reports.records.trial import TrialRecord

_FAILED = ("diverged", "crashed", "error", "out_of_memory")
"""Statuses that count as failed."""
_UNEXPECTED = ("unsupported", *_FAILED)
"""Statuses for which the progress shows the reason when the trial ends."""


class LiveProgress(AbstractContextManager["LiveProgress"]):
    """Progress bars on a terminal: a bar per engine, and a line per running trial with its current level."""

    def __init__(self, trials: Sequence[Trial], console: Console) -> None:
        self._bars = Bars(
            TextColumn("{task.fields[label]}", justify="left"),
            BarColumn(bar_width=24),
            MofNCompleteColumn(),
            TextColumn("{task.fields[note]}"),
            TimeRemainingColumn(elapsed_when_finished=True),
            console=console,
        )
        totals = Counter(trial.engine for trial in trials)
        self._engines = {
            engine: self._bars.add_task("", label=engine, total=total, note="") for engine, total in totals.items()
        }
        self._ends = {engine: Counter[str]() for engine in totals}
        self._trials: dict[str, TaskID] = {}

    def __enter__(self) -> LiveProgress:
        self._bars.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._bars.stop()

    def started(self, trial: Trial) -> None:
        """Add a line for the trial."""
        self._trials[trial.id] = self._bars.add_task("", label=f"  {_short(trial)}", total=None, note="starts")

    def progressed(self, trial: Trial, progress: Progress) -> None:
        """Update the trial's line with its current level, number of bricks and simulated time."""
        note = f"level {progress.level} of {progress.levels}, {progress.bricks} bricks, {progress.simulated_s:.0f} s"
        self._bars.update(self._trials[trial.id], completed=progress.level, total=progress.levels, note=note)

    def finished(self, trial: Trial, record: TrialRecord) -> None:
        """Remove the trial's line, count its status in the bar of its engine, and print an unexpected status."""
        self._bars.remove_task(self._trials.pop(trial.id))
        ends = self._ends[trial.engine]
        ends[record.status] += 1
        self._bars.update(self._engines[trial.engine], advance=1, note=_counts(ends))
        if record.status in _UNEXPECTED:
            self._bars.console.print(f"{trial.id}: {record.status}: {record.message}", markup=False, highlight=False)


class PlainProgress(AbstractContextManager["PlainProgress"]):
    """Progress as plain text: one line per finished trial."""

    def __init__(self, trials: Sequence[Trial], console: Console) -> None:
        self._console = console
        self._total = len(trials)
        self._finished = 0

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Do nothing."""

    def started(self, trial: Trial) -> None:
        """Do nothing, because ``finished`` prints the trial."""

    def progressed(self, trial: Trial, progress: Progress) -> None:
        """Do nothing, because ``finished`` prints the trial."""

    def finished(self, trial: Trial, record: TrialRecord) -> None:
        """Print the trial's status, levels and wall time [s], and the message of an unexpected status."""
        self._finished += 1
        how = f"{record.status}, {record.height_levels} of {record.levels_planned} levels"
        seconds = "" if record.wall_s is None else f", {record.wall_s:.1f} s"
        why = f": {record.message}" if record.status in _UNEXPECTED else ""
        self._console.print(
            f"[{self._finished}/{self._total}] {trial.id}: {how}{seconds}{why}",
            markup=False,
            highlight=False,
            soft_wrap=True,
        )


def show_progress(trials: Sequence[Trial], console: Console) -> LiveProgress | PlainProgress:
    """Return live bars if ``console`` is a terminal, else plain lines."""
    return LiveProgress(trials, console) if console.is_terminal else PlainProgress(trials, console)


def _counts(ends: Counter[str]) -> str:
    """Return the numbers of completed, collapsed and failed trials as text, then other numbers that are not zero."""
    failed = sum(ends[status] for status in _FAILED)
    rare = [
        f"{ends[status]} {name}" for status, name in (("timeout", "timed out"), ("unsupported", "n/a")) if ends[status]
    ]
    return ", ".join([f"{ends['completed']} completed", f"{ends['collapsed']} collapsed", f"{failed} failed", *rare])


def _short(trial: Trial) -> str:
    return f"{trial.scene} {trial.policy}" + (f" seed {trial.seed}" if trial.seed else "")
