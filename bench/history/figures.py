"""Figures of a results folder for a history: levels, collapse level, creep, sink, angle of onset and frame time."""

from __future__ import annotations

import statistics
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from reports.records.history import Kind, Series
from reports.records.trial import TrialRecord

_FAILED = frozenset({"error", "crashed", "out_of_memory", "unsupported"})
"""Statuses of trials without figures."""


class Figure(NamedTuple):
    """A figure of one trial or one version; its value is None if unknown."""

    name: str
    kind: Kind
    unit: str
    value: float | None


def figures_of(records: Sequence[TrialRecord]) -> list[Figure]:
    """Return the figures of one version, each the median over all trials of a scene and a policy that have a value."""
    found: dict[str, list[Figure]] = {}
    for record in records:
        if record.status not in _FAILED:
            for figure in _of_trial(record):
                found.setdefault(figure.name, []).append(figure)
    return [_median(group) for group in found.values()]


def as_series(versions: Sequence[Sequence[Figure]]) -> list[Series]:
    """Return the figures of all versions as series, in the order of their first appearance.

    The function leaves out a figure without any value.
    """
    tables: list[Mapping[str, Figure]] = [{figure.name: figure for figure in figures} for figures in versions]
    first = {name: figure for table in reversed(tables) for name, figure in table.items()}
    named = dict.fromkeys(name for table in tables for name in table)
    series = []
    for name in named:
        values = [table[name].value if name in table else None for table in tables]
        if any(value is not None for value in values):
            series.append(Series(name=name, kind=first[name].kind, unit=first[name].unit, values=values))
    return series


def first_failure(records: Sequence[TrialRecord]) -> str:
    """Return an example of a failure if no trial has figures; otherwise an empty text.

    The example is the first trial that is not unsupported, or the first trial if all are unsupported. There must be at
    least one record.
    """
    if any(record.status not in _FAILED for record in records):
        return ""
    first = next((one for one in records if one.status != "unsupported"), records[0])
    return f"none of the {len(records)} trials has figures, for example: {first.status}: {first.message}"


def _of_trial(record: TrialRecord) -> Iterator[Figure]:
    trial = f"{record.scene}" + ("" if record.policy == "none" else f" with {record.policy}")
    if record.onset_deg is not None or record.scenario == "tilt_test":
        yield Figure(f"tilt of {trial}", "tilt", "deg", record.onset_deg)
        return
    if record.expectation.outcome == "fall":
        falls_at = record.levels_planned + 1 if record.collapse_level is None else record.collapse_level
        yield Figure(f"collapse level of {trial}", "collapse", "levels", _if_decided(record, falls_at))
        return
    yield Figure(f"levels of {trial}", "levels", "levels", _if_decided(record, record.height_levels))
    stands = record.status == "completed"
    yield Figure(f"creep of {trial}", "creep", "m/s", record.creep_m_s if stands else None)
    yield Figure(f"sink of {trial}", "sink", "m", record.sink_m if stands else None)
    if record.policy == "none":
        yield Figure(
            f"frame time of {trial}", "time", "of a fixed calculation", _frame_time(record) if stands else None
        )


def _if_decided(record: TrialRecord, value: int) -> float | None:
    """Return a level, or None if the time limit stopped the trial (censored)."""
    return None if record.status == "timeout" else float(value)


def _median(group: Sequence[Figure]) -> Figure:
    values = [figure.value for figure in group if figure.value is not None]
    return group[0]._replace(value=statistics.median(values) if values else None)


def _frame_time(record: TrialRecord) -> float | None:
    """Return the ratio of the median frame time to the time of a fixed calculation; None if a time is unknown.

    The calculation runs just before and just after the frames, so that the ratio depends less on the machine's present
    speed than a time does. The caller leaves out stacks that fell, because their frames have fewer bricks.
    """
    if not (record.frame_ms_p50 and record.calibration_ms):
        return None
    return record.frame_ms_p50 / record.calibration_ms
