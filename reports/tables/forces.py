"""The table of reported contact forces: the weight that they carry, and their deviations from the laws of contact."""

from __future__ import annotations

import statistics
from collections.abc import Sequence

from reports.records.trial import TrialRecord
from reports.statistics.groups import groups_of
from reports.tables.table import NOTHING, Table

TITLE = "Force honesty"
FIGURES = (
    ("carried %", "carried_share", 100.0, "{:.2f}"),
    ("cone", "cone_excess", 1.0, "{:.4f}"),
    ("complementarity", "complementarity", 1.0, "{:.4f}"),
)
"""Columns: title, field of the record, factor from the unit of the field to the unit of the column, and format."""


def force_tables(records: Sequence[TrialRecord]) -> list[Table]:
    """Return the table of the trials with audited forces in a list, which is empty without such trials."""
    audited = [record for record in records if record.carried_share is not None]
    if not audited:
        return []
    rows = [
        (
            *(group.key.scene, group.key.engine, group.key.profile, group.key.policy),
            *(_median(group.values(field), factor, form) for _, field, factor, form in FIGURES),
        )
        for group in groups_of(audited)
    ]
    notes = (
        "While the finished stack is watched. Carried: vertical force from the ground over the weight of all bricks. "
        "Cone: by how much friction exceeds mu times the normal force at the worst contact, in mean weights of bricks. "
        "Complementarity: natural residual of the worst contact, |min(force / weight, gap / thickness)|: 0 where "
        "bodies touch exactly, else mostly the overlap.",
        "Stacks that fell before the watch are left out. PhysX and Rapier report normal forces; their friction is that "
        "which explains the bodies' momentum.",
    )
    header = ("scene", "engine", "profile", "policy", *(name for name, *_ in FIGURES))
    return [Table(TITLE, header, tuple(rows), notes, id="forces")]


def _median(values: Sequence[float], factor: float, form: str) -> str:
    return form.format(statistics.median(values) * factor) if values else NOTHING
