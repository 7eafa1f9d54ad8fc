"""The tables of repeatability: agreement and best times of repeats, and variation of the machine's speed."""

from __future__ import annotations

import statistics
from collections import defaultdict
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from reports.records.folder import ResultsFolder
from reports.records.frames import UNTIMED_FRAMES, read_columns
from reports.records.trial import TrialRecord
from reports.statistics.groups import GroupKey, grouped
from reports.tables.table import NOTHING, Table

NOISY = 0.1
"""Spread of the times of the fixed calculation above which the table warns that smaller differences of times mean
nothing. The spread is the 95th over the 5th percentile, minus 1."""
_PERCENTILES = (50, 95, 99)
"""Percentiles of the best times."""


def repeat_tables(folder: Path, records: Sequence[TrialRecord]) -> list[Table]:
    """Return the table of repeats, if any trial has repeats, and the table of the machine's speed, if measured."""
    tables = []
    timed = grouped([record for record in records if record.timed_frames is not None], *GroupKey._fields)
    groups = {GroupKey(*key): list(grouped(trials, "seed").values()) for key, trials in timed.items()}
    repeated = {key: seeds for key, seeds in groups.items() if any(len(same) > 1 for same in seeds)}
    if repeated:
        tables.append(_repeats(folder, repeated))
    if any(record.calibration_ms is not None for record in records):
        tables.append(_steadiness(records))
    return tables


def same_poses(repeats: Sequence[TrialRecord]) -> bool:
    """Return whether the repeats of a trial have the same poses to the last bit."""
    return len({record.pose_hash for record in repeats}) == 1


def best_times(folder: Path, repeats: Sequence[TrialRecord]) -> list[float] | None:
    """Return percentiles 50, 95 and 99 of the least times of each frame over all repeats [ms].

    The result is None if the repeats differ in poses, machine or number of timed frames, because such frames are not
    comparable. The result is also None if the frames of a repeat are missing.

    Raises:
        pyarrow.ArrowException: if the file of the frames of a repeat is incomplete.
    """
    if not same_poses(repeats) or len({(record.host, record.timed_frames) for record in repeats}) != 1:
        return None
    files = [ResultsFolder(folder).frames_file(record.trial) for record in repeats]
    if not all(map(Path.exists, files)):
        return None
    frames = [read_columns(file, ["frame_ms"])["frame_ms"][UNTIMED_FRAMES:] for file in files]
    times = [frame_ms[: record.timed_frames] for frame_ms, record in zip(frames, repeats, strict=True)]
    percentiles: list[float] = np.percentile(np.min(times, axis=0), _PERCENTILES).tolist()
    return percentiles


def _repeats(folder: Path, groups: Mapping[GroupKey, Sequence[Sequence[TrialRecord]]]) -> Table:
    """Return the table of repeats, a row per group.

    Args:
        folder: a results folder.
        groups: for each group and each of its seeds, the repeats.
    """
    rows = []
    for (scene, engine, profile, policy), seeds in groups.items():
        several = [repeats for repeats in seeds if len(repeats) > 1]
        alike = sum(map(same_poses, several))
        best = [times for repeats in several if (times := best_times(folder, repeats)) is not None]
        figures = [f"{statistics.median(column):.3f}" for column in zip(*best, strict=True)] or [NOTHING] * 3
        same = f"{alike}/{len(several)}" + ("" if alike == len(several) else " DIFFER")
        spread = _median_and_deviation([record for repeats in several for record in repeats])
        rows.append((scene, f"{engine} {profile}", policy, same, spread, *figures))
    header = ("scene", "engine", "policy", "same poses", "p50 ± MAD", "best p50", "best p95", "best p99")
    notes = (
        "Same poses: number of trials whose repeats agree to the last bit. DIFFER: the engine does not "
        "repeat itself, and a single run of it is a random draw.",
        "p50 ± MAD: median and median absolute deviation of the repeats' median frame times, in ms. Best: the least "
        "time of each frame over all repeats, where they agree; a p99 of least times is no p99 of a run. "
        "None where the repeats ran on several machines.",
    )
    return Table("Repeatability", header, tuple(rows), notes, id="repeatability")


def _median_and_deviation(repeats: Sequence[TrialRecord]) -> str:
    """Return median and median absolute deviation of the median frame times [ms] as text; a dash for several machines.

    Times of several machines have no common median, because they are not comparable.
    """
    if len({record.host for record in repeats}) > 1:
        return NOTHING
    p50 = [record.frame_ms_p50 for record in repeats if record.frame_ms_p50 is not None]
    middle = statistics.median(p50)
    return f"{middle:.3f} ± {statistics.median(abs(value - middle) for value in p50):.3f}"


def _steadiness(records: Sequence[TrialRecord]) -> Table:
    times: dict[str, list[float]] = defaultdict(list)
    for record in records:
        if record.calibration_ms is not None:
            times[record.host or NOTHING].append(record.calibration_ms)
    rows, notes = [], []
    for host, values in times.items():
        machine = host if len(times) > 1 else "the only one"
        low, middle, high = np.percentile(values, [5, 50, 95]).tolist()
        spread = high / low - 1
        rows.append((machine, str(len(values)), f"{low:.3f}", f"{middle:.3f}", f"{high:.3f}", f"{spread:.0%}"))
        if spread > NOISY:
            notes.append(f"NOISY: {machine} varied by {spread:.0%}; smaller differences of times mean nothing.")
    if len(times) > 1:
        notes.append("Several machines: compare times of the same machine only.")
    notes.append("A fixed calculation beside every trial, in ms: 5th, 50th and 95th percentile, and their spread.")
    return Table(
        "Steadiness of the machine",
        ("machine", "trials", "p5", "p50", "p95", "spread"),
        tuple(rows),
        tuple(notes),
        id="machine",
    )
