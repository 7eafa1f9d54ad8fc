"""The table of stability metrics: height, sink, drift, creep and wakes."""

from __future__ import annotations

import pandas as pd

from reports.tables.grouping import Measure, engine_names, median_rows
from reports.tables.table import Table

LEGACY_CREEP, LEGACY_TITLE = "mean_motion_m_s", "mean motion"
"""Field and title of the mean motion, which trials from before format 3 have instead of creep."""
MEASURES = (
    Measure("height", "height_m", "{:.1f}", 1e3),
    Measure("sink", "sink_m", "{:.2f}", 1e3),
    Measure("drift", "drift_m", "{:.2f}", 1e3),
    Measure(LEGACY_TITLE, LEGACY_CREEP, "{:.4f}", 1e3),
    Measure("creep", "creep_m_s", "{:.3f}", 1e6),
    Measure("± creep", "creep_error_m_s", "{:.3f}", 1e6),
    Measure("sliding", "sliding_m_s", "{:.3f}", 1e6),
    Measure("sinking", "sinking_m_s", "{:.3f}", 1e6),
    Measure("wakes", "wakes", "{:.0f}"),
    Measure("refroze", "refreezes", "{:.0f}"),
    Measure("live s", "longest_live_s", "{:.1f}"),
)
"""All columns of the table."""


PRESENT_CREEP = ("creep_m_s", "creep_error_m_s", "sliding_m_s", "sinking_m_s")
"""Fields of the creep, which records contain since format 3."""
CREEP_NOTE = (
    "Creep [µm/s]: slope of a centre's position over the last half of the watch, of the brick that is fastest for its "
    "thickness, ± half of its 95 % interval; then the fastest horizontal and the fastest vertical creep of any brick."
)
LEGACY_NOTE = (
    "Of trials from before format 3 “creep” (beside the other: “mean motion”) [mm/s] is the fastest mean motion of a "
    "brick over the whole watch, in which a stack still settles. It did not count."
)


def stability_table(trials: pd.DataFrame) -> Table:
    """Return the table of the median stability metrics of each group of trials.

    Args:
        trials: all trials of a study, as ``reports.records.results.trials_frame`` returns them.
    """
    has_present = trials["creep_m_s"].notna().any()
    has_legacy = trials[LEGACY_CREEP].notna().any()
    left_out = set() if has_legacy else {LEGACY_CREEP}
    left_out |= set() if has_present or not has_legacy else set(PRESENT_CREEP)
    measures = [measure for measure in MEASURES if measure.field not in left_out]
    rows = median_rows(trials.assign(engine_name=engine_names(trials)), ("scene", "engine_name", "policy"), measures)
    notes = (
        "Of the highest level when last seen intact: height of its top, sink below its ideal height and the farthest "
        "sideways drift of any brick, in mm.",
        *([CREEP_NOTE] if has_present else []),
        *([LEGACY_NOTE] if has_legacy else []),
        "Wakes and refreezes by the core; the longest simulated time that a brick stayed live.",
    )
    titles = {"engine_name": "engine"} | ({} if has_present else {LEGACY_TITLE: "creep"})
    return Table.of("Stability metrics", rows.rename(columns=titles), notes, id="stability")
