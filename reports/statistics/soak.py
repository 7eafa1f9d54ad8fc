"""Creep over a long watch: whether a stack creeps at all, and when a brick will have moved by its thickness."""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from dataclasses import dataclass

from reports.records.trial import TrialRecord
from reports.statistics.groups import grouped

LEAST_WATCH_S = 60.0
"""Shorter watches [s] are no soak: solver noise then hides a creep of a micrometre a second."""


@dataclass(frozen=True, slots=True)
class SoakSummary:
    """The soaked trials of one engine and profile under one policy."""

    engine: str
    profile: str
    policy: str
    trials: int
    """Scenes that must stand, each seed once."""
    fell: int
    failed: int
    """Trials that did not come to their end."""
    creep: int
    """Trials that creep."""
    median_m_s: float | None
    """Median creep [m/s] of those that stood; None if none did."""
    shortest_s: float | None
    """Least time [s] until a brick has moved by its thickness, of those that creep; None if none does."""


def soaked(records: Sequence[TrialRecord]) -> list[TrialRecord]:
    """Return the trials of stacks that must stand and were watched for long, without repeats."""
    return [
        record
        for record in records
        if record.expectation.outcome == "stand"
        and record.repeat == 0
        and record.status != "unsupported"
        and (record.watch_s or 0.0) >= LEAST_WATCH_S
    ]


def creeps_at_all(record: TrialRecord) -> bool:
    """Return True if the 95 % interval of a trial's creep excludes zero."""
    return record.creep_m_s is not None and record.creep_m_s > (record.creep_error_m_s or 0.0)


def time_of_a_thickness(record: TrialRecord) -> float | None:
    """Return after how long [s] the brick that creeps fastest has moved by its thickness; None if it does not creep."""
    if not creeps_at_all(record) or not record.creep_m_s or record.creep_thickness_m is None:
        return None
    return record.creep_thickness_m / record.creep_m_s


def soak_summaries(records: Sequence[TrialRecord]) -> list[SoakSummary]:
    """Sum up the soaked trials of each engine, profile and policy, in the order in which they come."""
    by_set_up = grouped(soaked(records), "engine", "profile", "policy")
    return [_summary(trials, *set_up) for set_up, trials in by_set_up.items()]


def _summary(trials: Sequence[TrialRecord], engine: str, profile: str, policy: str) -> SoakSummary:
    speeds = [trial.creep_m_s for trial in trials if trial.creep_m_s is not None]
    times = [time for trial in trials if (time := time_of_a_thickness(trial)) is not None]
    fell = sum(trial.status == "collapsed" for trial in trials)
    return SoakSummary(
        engine,
        profile,
        policy,
        len(trials),
        fell,
        sum(trial.status != "completed" for trial in trials) - fell,
        sum(map(creeps_at_all, trials)),
        statistics.median(speeds) if speeds else None,
        min(times, default=None),
    )
