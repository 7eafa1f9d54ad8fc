"""The table of collapse levels: their distribution over the trials of each group."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from reports.records.trial import TrialRecord
from reports.statistics.groups import GroupKey, grouped
from reports.tables.table import NOTHING, Table

LEAST_TRIALS = 5
"""Fewest trials of a group for which the table shows a distribution."""


def collapse_level_tables(records: Sequence[TrialRecord]) -> list[Table]:
    """Return the table of collapse levels in a list, which is empty if no group has ``LEAST_TRIALS`` trials."""
    rows = [
        (*key, _levels(trials), *(str(count) if count else NOTHING for count in _stood_and_stopped(trials)))
        for key, trials in grouped(records, *GroupKey._fields).items()
        if len(trials) >= LEAST_TRIALS
    ]
    if not rows:
        return []
    header = ("scene", "engine", "profile", "policy", "fell at level: how many, and how", "stood", "stopped")
    note = (
        "Collapse level: the level that was complete when the collapse was first seen. Stopped: by the time limit, an "
        "error or a limit of the engine, so that the outcome is unknown."
    )
    return [Table("Collapse levels", header, tuple(rows), (note,), folds=True, id="collapse_levels")]


def _levels(trials: Sequence[TrialRecord]) -> str:
    """Return the distribution of collapse levels as text, such as ``4: 30 (19 slide, 9 sink, 2 topple)``."""
    fallen: dict[int, Counter[str]] = {}
    for trial in trials:
        if trial.collapse_level is not None:
            fallen.setdefault(trial.collapse_level, Counter())[trial.collapse_kind or "fall"] += 1
    entries = []
    for level, kinds in sorted(fallen.items()):
        how = ", ".join(f"{count} {kind}" for kind, count in kinds.most_common())
        entries.append(f"{level}: {kinds.total()} ({how})")
    return "; ".join(entries) or NOTHING


def _stood_and_stopped(trials: Sequence[TrialRecord]) -> tuple[int, int]:
    stood = sum(trial.status == "completed" for trial in trials)
    fell = sum(trial.collapse_level is not None for trial in trials)
    return stood, len(trials) - stood - fell
