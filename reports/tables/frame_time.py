"""The table of frame times: of engine, core and port."""

from __future__ import annotations

import pandas as pd

from reports.tables.grouping import Measure, engine_names, median_rows, played_in_order
from reports.tables.table import NOTHING, Table

_BRIDGE = Measure("bridge", "bridge_ms", "{:.3f}")
"""Shown if an engine runs in a separate process."""
MEASURES = (
    Measure("p50", "frame_ms_p50", "{:.3f}"),
    Measure("p99", "frame_ms_p99", "{:.3f}"),
    Measure("step", "engine_ms", "{:.3f}"),
    Measure("read", "readback_ms", "{:.3f}"),
    Measure("core", "core_ms", "{:.3f}"),
    Measure("port", "port_ms", "{:.3f}"),
    _BRIDGE,
    Measure("ratio at level", "frame_ratio", "{:.2f}"),
)
_KEYS = ("scene", "engine_name", "policy", "machine")


def frame_time_table(trials: pd.DataFrame) -> Table:
    """Return the medians of the frame times of each group of trials, with a note if there are several machines."""
    several = len(trials["host"].dropna().unique()) > 1
    trials = trials.assign(engine_name=engine_names(trials), machine=trials["host"].fillna(NOTHING))
    has_bridge = bool(trials["bridge_ms"].notna().any())
    measures = [measure for measure in MEASURES if has_bridge or measure is not _BRIDGE]
    rows = median_rows(trials, _KEYS, measures)
    rows["ratio at level"] += _levels(trials)
    if not several:
        rows = rows.drop(columns="machine")
    notes = (
        *(["Measured on several machines: compare times of the same machine only."] if several else []),
        "Times in ms per frame, up to a collapse: median and 99th percentile of whole frames; means of the engine's "
        "step, of reading contacts, of the core and of freezing and unfreezing. Trials differ in height: compare "
        "heights first.",
        *(["Bridge: the transfer to an engine in a separate process, and back; in no other time."] * has_bridge),
        "Ratio: mean frame time while the level was placed, live bricks included, over the mean frame time of up to a "
        "second of the same stack all awake without the extension, reloaded where it falls. Above 1 the extension "
        "costs more than it saves.",
    )
    return Table.of("Frame time", rows.rename(columns={"engine_name": "engine"}), notes, id="frame_time")


def _levels(trials: pd.DataFrame) -> list[str]:
    """Return, for each row, the levels at which ratios were measured, such as `` at 20-25``; empty if none were."""
    played = played_in_order(trials)
    level = played["frame_ratio_level"].where(played["frame_ratio"].notna())
    ends = level.groupby([played[key] for key in _KEYS], sort=False).agg(["min", "max"])
    return [
        "" if pd.isna(low) else f" at {low}" if low == high else f" at {low}-{high}" for low, high in ends.to_numpy()
    ]
