"""The table of frame times: what engine, core and port cost."""

from __future__ import annotations

from collections.abc import Sequence

from reports.records.trial import TrialRecord
from reports.tables.grouping import engine_names, measured, median_text
from reports.tables.table import NOTHING, Table


def frame_time_table(records: Sequence[TrialRecord]) -> Table:
    """List the medians of the frame times of each group of trials."""
    rows, name = [], engine_names(records)
    several = len({record.host for record in records if record.host is not None}) > 1
    for (scene, engine, profile, policy, host), trials in measured(records, lambda r: (r.host or NOTHING,)):
        rows.append(
            (
                scene,
                name(engine, profile),
                policy,
                *([host] if several else []),
                median_text(trials, "frame_ms_p50", "{:.3f}"),
                median_text(trials, "frame_ms_p99", "{:.3f}"),
                median_text(trials, "engine_ms", "{:.3f}"),
                median_text(trials, "readback_ms", "{:.3f}"),
                median_text(trials, "core_ms", "{:.3f}"),
                median_text(trials, "port_ms", "{:.3f}"),
                _ratio(trials),
            )
        )
    columns = ("p50", "p99", "step", "read", "core", "port", "ratio at level")
    header = ("scene", "engine", "policy", *(["machine"] if several else []), *columns)
    notes = (
        *(["Taken on several machines: compare times of the same machine only."] if several else []),
        "Times in ms a frame, up to a collapse: median and 99th percentile of whole frames; means of the engine's "
        "step, of reading contacts, of the core and of freezing and waking. Trials differ in height: compare heights "
        "first.",
        "Ratio: mean frame time while the level was laid, live bricks included, over that of up to a second of the "
        "same stack all awake without the extension, put up anew where it falls. Above 1 the extension costs more than "
        "it saves.",
    )
    return Table("What it cost", header, tuple(rows), notes)


def _ratio(trials: Sequence[TrialRecord]) -> str:
    levels = sorted(
        {r.frame_ratio_level for r in trials if r.frame_ratio_level is not None and r.frame_ratio is not None}
    )
    value = median_text(trials, "frame_ratio", "{:.2f}")
    return f"{value} at {'-'.join(map(str, [levels[0], levels[-1]][: len(levels)]))}" if levels else value
