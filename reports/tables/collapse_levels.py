"""At which level stacks fell over many seeds: the distribution, not only its middle."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from reports.records.trial import TrialRecord
from reports.statistics.groups import GroupKey, grouped
from reports.tables.table import NOTHING, Table

LEAST_TRIALS = 5
"""Fewer trials of a group are no distribution."""


def collapse_level_tables(records: Sequence[TrialRecord]) -> list[Table]:
    """The table of collapse levels, if any scene was built often enough under some policy."""
    rows = [
        (*key, _levels(trials), *(str(count) if count else NOTHING for count in _stood_and_stopped(trials)))
        for key, trials in grouped(records, *GroupKey._fields).items()
        if len(trials) >= LEAST_TRIALS
    ]
    if not rows:
        return []
    header = ("scene", "engine", "profile", "policy", "fell at level: how many, and how", "stood", "stopped")
    note = (
        "The level that was complete when the collapse was first seen. Stopped: by the time limit, an error or a limit "
        "of the engine; nothing is known of how they would have ended."
    )
    return [Table("At which level they fell", header, tuple(rows), (note,), folds=True, id="collapse_levels")]


def _levels(trials: Sequence[TrialRecord]) -> str:
    """Such as "4: 30 (19 slide, 9 sink, 2 topple)"."""
    fallen: dict[int, Counter[str]] = {}
    for trial in trials:
        if trial.collapse_level is not None:
            fallen.setdefault(trial.collapse_level, Counter())[trial.collapse_kind or "fall"] += 1
    told = []
    for level, kinds in sorted(fallen.items()):
        how = ", ".join(f"{count} {kind}" for kind, count in kinds.most_common())
        told.append(f"{level}: {kinds.total()} ({how})")
    return "; ".join(told) or NOTHING


def _stood_and_stopped(trials: Sequence[TrialRecord]) -> tuple[int, int]:
    stood = sum(trial.status == "completed" for trial in trials)
    fell = sum(trial.collapse_level is not None for trial in trials)
    return stood, len(trials) - stood - fell
