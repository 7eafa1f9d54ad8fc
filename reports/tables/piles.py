"""The table of poured piles: time to rest, height, angle of repose, sink, creep and frame time by policy."""

from __future__ import annotations

import statistics
from collections.abc import Sequence

from reports.records.trial import CENSORED, TrialRecord
from reports.statistics.groups import groups_of
from reports.tables.table import NOTHING, Table

FIGURES = (
    ("rest s", "rest_s", "{:.1f}", 1.0),
    ("height", "height_m", "{:.1f}", 1e3),
    ("repose", "repose_deg", "{:.1f}", 1.0),
    ("sink", "sink_m", "{:.3f}", 1e3),
    ("creep", "creep_m_s", "{:.3f}", 1e6),
    ("awake", "live_mean", "{:.1f}", 1.0),
    ("last", "live_last", "{:.0f}", 1.0),
    ("p50", "frame_ms_p50", "{:.2f}", 1.0),
    ("p99", "frame_ms_p99", "{:.2f}", 1.0),
)
"""Columns: title, field of the record, format, and factor from the unit of the field to the unit of the column."""


def pile_tables(records: Sequence[TrialRecord]) -> list[Table]:
    """Return the table of all piles with an angle of repose in a list, which is empty without these piles."""
    poured = [record for record in records if record.repose_deg is not None]
    if not poured:
        return []
    rows = []
    for group in groups_of(poured):
        key, trials = group.key, group.trials
        engine = key.engine if len({record.profile for record in poured}) == 1 else f"{key.engine} {key.profile}"
        cut_off = any(trial.status in CENSORED for trial in trials)
        bricks = statistics.median(trial.height_levels for trial in trials)
        entries = [_median(group.values(field), form, scale) for _, field, form, scale in FIGURES]
        if entries[0] == NOTHING:
            entries[0] = "moves"
        rows.append((key.scene, engine, key.policy, f"{'≥' if cut_off else ''}{bricks:g}", *entries))
    notes = (
        "Bricks poured (≥: stopped by the time limit); seconds from the last brick until none is faster than 10 mm/s "
        "(“moves”: some did to the end); height of the top [mm]; angle of repose [deg], of the cone with the same "
        "median height and radius.",
        "While it is watched: sink of the bricks' mean height [mm], and creep over its last half [µm/s], of the brick "
        "that is fastest for its thickness.",
        "Bricks awake, as the mean of all frames and in the last frame; unknown without an extension. Times in "
        "ms per frame.",
    )
    header = ("scene", "engine", "policy", "bricks", *(name for name, *_ in FIGURES))
    return [Table("Piles at rest", header, tuple(rows), notes, id="piles")]


def _median(values: Sequence[float], form: str, scale: float) -> str:
    return form.format(statistics.median(values) * scale) if values else NOTHING
