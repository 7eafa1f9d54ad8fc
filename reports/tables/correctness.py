"""The table of correctness: right outcomes of scenes that must stand and of those that must fall."""

from __future__ import annotations

from collections.abc import Sequence

from reports.records.trial import TrialRecord
from reports.statistics.groups import judged_trials
from reports.tables.grouping import engine_names, grouped, policies_of
from reports.tables.table import NOTHING, Table


def correctness_table(records: Sequence[TrialRecord]) -> Table:
    """Count the right outcomes of each engine and policy, apart for scenes that must stand and that must fall."""
    policies, name = policies_of(records), engine_names(records)
    rows = []
    for (engine, profile), trials in grouped(records, lambda r: (r.engine, r.profile)):
        cells = []
        for policy in policies:
            judged = judged_trials([r for r in trials if r.policy == policy])
            cells += [_share([r for r in judged if r.expectation.outcome == side]) for side in ("stand", "fall")]
        rows.append((name(engine, profile), *cells))
    header = ("engine", *(f"{policy}: {side}" for policy in policies for side in ("stand", "fall")))
    note = "Right outcomes of those scenes that must stand, and of those that must fall: only both together count."
    return Table("Right by theory", header, tuple(rows), (note,))


def _share(judged: Sequence[TrialRecord]) -> str:
    return f"{sum(r.verdict == 'right' for r in judged)}/{len(judged)}" if judged else NOTHING
