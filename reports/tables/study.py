"""The tables of every study: outcomes, correctness, frame time and stability metrics.

With several seeds, an entry of the table of outcomes gives the median and the range of the levels. The levels of a
trial that its time limit stopped are only lower bounds ("≥"), and the trial counts as neither right nor wrong.
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
    """Return the tables of a study, without correctness if all verdicts are ``none``."""
    trials = trials_frame(records)
    is_judged = (trials["verdict"] != "none").any()
    return [
        outcomes_table(records),
        *([correctness_table(trials)] if is_judged else []),
        frame_time_table(trials),
        stability_table(trials),
    ]
