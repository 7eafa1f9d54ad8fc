"""The report of a results folder."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from reports.records.folder import write_csv
from reports.records.trial import TrialRecord
from reports.tables.table import Table, to_markdown


def write_report(folder: Path, records: Sequence[TrialRecord], tables: Iterable[Table]) -> None:
    """Write ``report/tables.md`` and ``report/trials.csv`` into a results folder."""
    report = folder / "report"
    report.mkdir(exist_ok=True)
    (report / "tables.md").write_text(to_markdown(tables), encoding="utf-8")
    write_csv(report / "trials.csv", records)
