"""The table of stability metrics: height, sink, drift, creep and wakes."""

from __future__ import annotations

import pandas as pd

from reports.tables.grouping import Measure, engine_names, median_rows
from reports.tables.table import Table

MEASURES = (
    Measure("height", "height_m", "{:.1f}", 1e3),
    Measure("sink", "sink_m", "{:.2f}", 1e3),
    Measure("drift", "drift_m", "{:.2f}", 1e3),
    Measure("creep", "creep_m_s", "{:.4f}", 1e3),
    Measure("wakes", "wakes", "{:.0f}"),
    Measure("refroze", "refreezes", "{:.0f}"),
    Measure("live s", "longest_live_s", "{:.1f}"),
)


def stability_table(trials: pd.DataFrame) -> Table:
    """List the medians of the stability metrics of each group of trials."""
    rows = median_rows(trials.assign(engine_name=engine_names(trials)), ("scene", "engine_name", "policy"), MEASURES)
    notes = (
        "Of the highest level when last seen intact: height of its top, sink below its ideal height and the farthest "
        "sideways drift of any brick, in mm; creep in mm/s while the finished stack is watched.",
        "Wakes and refreezes by the core; the longest simulated time that one brick stayed live.",
    )
    return Table.of("How still it stood", rows.rename(columns={"engine_name": "engine"}), notes, id="stability")
