"""The table of known faults of engines: public threads, and the rows that they may explain."""

from __future__ import annotations

from collections.abc import Sequence

from reports.records.trial import TrialRecord
from reports.statistics.groups import groups_of
from reports.statistics.known_faults import KnownFault, faults_of
from reports.tables.table import Table
from reports.tables.wording import some


def known_fault_tables(records: Sequence[TrialRecord]) -> list[Table]:
    """Return the table of known faults in a list, which is empty if no trial shows a known fault."""
    shown: dict[tuple[str, str], tuple[KnownFault, list[str]]] = {}
    for group in groups_of(records):
        for fault in faults_of(group):
            _, rows = shown.setdefault((fault.engine, fault.thread), (fault, []))
            rows.append(" ".join((group.key.scene, group.key.profile, group.key.policy)))
    if not shown:
        return []
    cells = tuple(
        (fault.engine, fault.thread, fault.sentence, f"{len(rows)}: {some(rows)}") for fault, rows in shown.values()
    )
    notes = (
        "A public thread about the engine may explain these rows. A flag neither proves the cause nor excuses: the "
        "rows count as without it.",
        "Threads: " + ", ".join(f"{fault.thread} ({fault.url})" for fault, _ in shown.values()) + ".",
    )
    header = ("engine", "thread", "what it says", "rows that show it")
    return [Table("Known faults of engines", header, cells, notes, folds=True, id="known_faults")]
