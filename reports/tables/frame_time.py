"""The table of frame times: whole frames, and their parts in engine, core and port."""

from __future__ import annotations

import pandas as pd

from reports.statistics.intervals import LEAST_RATIOS, paired_ratio
from reports.tables.grouping import Measure, engine_names, median_rows, played_in_order
from reports.tables.table import NOTHING, Table
from reports.tables.wording import ratio_text

_BRIDGE = Measure("bridge", "bridge_ms", "{:.3f}")
"""Column for engines that run in a separate process."""
_ONE_LIVE = Measure("one live", "frame_ratio_one_live", "{:.2g}")
"""Column for trials that measured the engine's step with one live brick."""
MEASURES = (
    Measure("p50", "frame_ms_p50", "{:.3f}"),
    Measure("p99", "frame_ms_p99", "{:.3f}"),
    Measure("step", "engine_ms", "{:.3f}"),
    Measure("read", "readback_ms", "{:.3f}"),
    Measure("core", "core_ms", "{:.3f}"),
    Measure("port", "port_ms", "{:.3f}"),
    _BRIDGE,
    _ONE_LIVE,
)
_KEYS = ("scene", "engine_name", "policy", "machine")


def frame_time_table(trials: pd.DataFrame) -> Table:
    """Return the table of the median frame times of each group of trials, with a row for each machine of a group.

    Args:
        trials: all trials of a study, as ``reports.records.results.trials_frame`` returns them.
    """
    several = len(trials["host"].dropna().unique()) > 1
    trials = trials.assign(engine_name=engine_names(trials), machine=trials["host"].fillna(NOTHING))
    is_shown = {measure: bool(trials[measure.field].notna().any()) for measure in (_BRIDGE, _ONE_LIVE)}
    measures = [measure for measure in MEASURES if is_shown.get(measure, True)]
    rows = median_rows(trials, _KEYS, measures)
    rows.insert(rows.shape[1] - is_shown[_ONE_LIVE], "ratio at level", _ratios(trials))
    if not several:
        rows = rows.drop(columns="machine")
    notes = (
        *(["Measured on several machines: compare times of the same machine only."] if several else []),
        "Times in ms per frame, up to a collapse: median and 99th percentile of whole frames; means of the engine's "
        "step, of reading contacts, of the core and of freezing and unfreezing. Trials differ in height: compare "
        "heights first.",
        *(["Bridge: the transfer to an engine in a separate process, and back; in no other time."] * is_shown[_BRIDGE]),
        "Ratio: mean frame time while the level was placed, live bricks included, over the mean frame time of up to a "
        "second of the same stack all awake without the extension, reloaded where it falls. Above 1 the extension "
        "costs more than it saves. Each trial is a pair of times: the median of at least "
        f"{LEAST_RATIOS} pairs and its 95 % interval from order statistics. Of five pairs the interval is their range, "
        "which encloses the median with 93.75 %. Fewer pairs give a dash.",
        *(
            [
                "One live: median ratio of the engine's step with one live brick on the frozen stack to the same frame "
                "time without the extension. This is the engine's own share in a frame that has a live brick; a frame "
                "without a live brick may take less."
            ]
            * is_shown[_ONE_LIVE]
        ),
    )
    return Table.of("Frame time", rows.rename(columns={"engine_name": "engine"}), notes, id="frame_time")


def _ratios(trials: pd.DataFrame) -> list[str]:
    """Return the frame ratio of each row with interval and levels, such as ``0.07 [0.06, 0.09] at 20-25``."""
    played = played_in_order(trials)
    groups = played.groupby(list(_KEYS), sort=False, dropna=False)
    return [_ratio(group.loc[group["frame_ratio"].notna()]) for _, group in groups]


def _ratio(measured: pd.DataFrame) -> str:
    estimate = paired_ratio(measured["frame_ratio"].tolist())
    if estimate is None:
        return NOTHING
    low, high = measured["frame_ratio_level"].min(), measured["frame_ratio_level"].max()
    return f"{ratio_text(estimate)} at {low}" + ("" if low == high else f"-{high}")
