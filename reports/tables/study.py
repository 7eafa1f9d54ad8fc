"""The four tables of every study.

With several seeds a table's entry tells the median and the range. A trial that was stopped by its time limit is
censored: its figures are marked "≥" and stand in no mean.
"""

from __future__ import annotations

from collections.abc import Sequence

from reports.records.results import trials_frame
from reports.records.trial import TrialRecord
from reports.tables.correctness import correctness_table
from reports.tables.frame_time import frame_time_table
from reports.tables.outcomes import outcomes_table
from reports.tables.stability import stability_table
from reports.tables.table import Table


def study_tables(records: Sequence[TrialRecord]) -> list[Table]:
    """All tables of a study: what stood and fell, whether that was right, what it cost, and how still it stood.

    Where theory knows no answer nothing is right or wrong, and that table is left out.
    """
    trials = trials_frame(records)
    is_judged = (trials["verdict"] != "none").any()
    return [
        outcomes_table(records),
        *([correctness_table(trials)] if is_judged else []),
        frame_time_table(trials),
        stability_table(trials),
    ]
