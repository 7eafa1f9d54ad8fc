"""Reports of a study from its raw records: tables, figures, a page, replays, and the data frames of ``load``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from reports.records.results import Results


def load(folder: str | Path) -> Results:
    """Return the results of a results folder, or of a folder in ``docs/results``, as data frames.

    Args:
        folder: a folder with ``trials.jsonl``, ``trials.parquet`` or, from earlier versions, ``trials.csv``.
    """
    from reports.records.results import Results  # it imports pandas, which takes 0.5 s and a run does not need

    return Results(Path(folder))
