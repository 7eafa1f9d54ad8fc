"""Wall times of earlier trials, read from results folders and published folders, as the basis of estimates."""

from __future__ import annotations

import json
import math
import statistics
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import pyarrow as pa
import pyarrow.parquet as pq

from reports.records.folder import PARQUET, TRIALS, ResultsFolder

COLUMNS = (
    *("trial", "engine", "profile", "scene", "policy"),
    *("levels_planned", "simulated_s", "wall_s", "calibration_ms", "status"),
)
"""Columns of a published table that an estimate needs."""


class PastTrial(NamedTuple):
    """Earlier trial, reduced to the fields that an estimate needs."""

    trial: str
    """Id of the trial."""
    engine: str
    profile: str
    scene: str
    policy: str
    level_s: float
    """Work of the trial: number of planned levels multiplied by simulated time [s]; 0 if unknown."""
    wall_s: float
    """Wall time [s]."""
    calibration_ms: float | None
    """Time of the fixed calculation before and after the trial [ms]; if unknown, the median over the trials of the
    folder; None if the time is unknown for all trials of the folder."""


def past_trials(folder: Path) -> list[PastTrial]:
    """Return the trials of a folder that are readable and have a known wall time.

    The result is empty if the environment file of the folder marks the times as disturbed. An unsupported trial without
    a wall time counts with a wall time of 0 s.
    """
    if not ResultsFolder(folder).environment.get("timed", True):
        return []  # its trials disturbed each other's times
    rows = [row for row in map(_with_refusals, _rows(folder)) if _known(row.get("wall_s")) and "trial" in row]
    taken = [row["calibration_ms"] for row in rows if _known(row.get("calibration_ms"))]
    typical = statistics.median(taken) if taken else None
    return [
        PastTrial(
            str(row["trial"]),
            str(row.get("engine")),
            str(row.get("profile")),
            str(row.get("scene")),
            str(row.get("policy")),
            float(row.get("levels_planned") or 0) * float(row.get("simulated_s") or 0.0),
            float(row["wall_s"]),
            float(row["calibration_ms"]) if _known(row.get("calibration_ms")) else typical,
        )
        for row in rows
    ]


def _with_refusals(row: Mapping[str, Any]) -> Mapping[str, Any]:
    refused = row.get("status") == "unsupported" and not _known(row.get("wall_s"))
    return {**row, "wall_s": 0.0} if refused else row


def _known(value: object) -> bool:
    return isinstance(value, int | float) and math.isfinite(value)


def _rows(folder: Path) -> Iterator[Mapping[str, Any]]:
    """Yield the readable rows; skip all others without an error, because an estimate does not need every row.

    The function reads ``TRIALS`` or, if this file does not exist, ``PARQUET``.
    """
    try:
        if (folder / TRIALS).exists():
            with (folder / TRIALS).open(encoding="utf-8", errors="replace") as lines:
                for line in lines:
                    try:
                        row = json.loads(line)
                    except ValueError:
                        continue
                    if isinstance(row, dict):
                        yield row
        elif (folder / PARQUET).exists():
            there = set(pq.read_schema(folder / PARQUET).names)
            columns = [name for name in COLUMNS if name in there]
            yield from pq.read_table(folder / PARQUET, columns=columns).to_pylist()
    except (OSError, pa.ArrowException):
        return
