"""The table of stability metrics: height, sink, drift, creep and wakes."""

from __future__ import annotations

from collections.abc import Sequence

from reports.records.trial import TrialRecord
from reports.tables.grouping import engine_names, measured, median_text
from reports.tables.table import Table


def stability_table(records: Sequence[TrialRecord]) -> Table:
    """List the medians of the stability metrics of each group of trials."""
    rows, name = [], engine_names(records)
    for (scene, engine, profile, policy), trials in measured(records):
        rows.append(
            (
                scene,
                name(engine, profile),
                policy,
                median_text(trials, "height_m", "{:.1f}", 1e3),
                median_text(trials, "sink_m", "{:.2f}", 1e3),
                median_text(trials, "drift_m", "{:.2f}", 1e3),
                median_text(trials, "creep_m_s", "{:.4f}", 1e3),
                median_text(trials, "wakes", "{:.0f}"),
                median_text(trials, "refreezes", "{:.0f}"),
                median_text(trials, "longest_live_s", "{:.1f}"),
            )
        )
    header = ("scene", "engine", "policy", "height", "sink", "drift", "creep", "wakes", "refroze", "live s")
    notes = (
        "Of the highest level when last seen intact: height of its top, sink below its ideal height and the farthest "
        "sideways drift of any brick, in mm; creep in mm/s while the finished stack is watched.",
        "Wakes and refreezes by the core; the longest simulated time that one brick stayed live.",
    )
    return Table("How still it stood", header, tuple(rows), notes)
