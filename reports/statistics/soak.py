"""Creep over a long watch (soak): creeping trials, and the time until a brick has moved by its thickness."""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from dataclasses import dataclass

from reports.records.trial import TrialRecord
from reports.statistics.groups import grouped, groups_of

LEAST_WATCH_S = 60.0
"""Shortest watch of a soak [s], because in a shorter watch the noise of a solver hides a creep of a micrometre per
second."""


@dataclass(frozen=True, slots=True)
class SoakSummary:
    """Summary of the soaked trials of one engine and profile under one policy."""

    engine: str
    profile: str
    policy: str
    trials: int
    """Number of soaked trials of scenes that must stand, without repeats."""
    fell: int
    """Number of trials whose stack collapsed."""
    failed: int
    """Number of trials that neither completed nor collapsed."""
    creep: int
    """Number of trials for which the 95 % interval of the creep excludes zero."""
    median_m_s: float | None
    """Median creep of the trials with a measured creep [m/s]; None without such trials."""
    shortest_s: float | None
    """Shortest time [s] in which a brick of a creeping trial moves by its thickness, at its measured creep; None
    without creeping trials."""


def soaked(records: Sequence[TrialRecord]) -> list[TrialRecord]:
    """Return the trials of scenes that must stand, with a watch of at least ``LEAST_WATCH_S``, without repeats.

    The trials are in the order of their groups. Scenes that the engine does not support do not count.
    """
    return [
        record
        for group in groups_of(records)
        for record in group.trials
        if record.expectation.outcome == "stand"
        and record.repeat == 0
        and record.status != "unsupported"
        and (record.watch_s or 0.0) >= LEAST_WATCH_S
    ]


def creeps_at_all(record: TrialRecord) -> bool:
    """Return whether the 95 % interval of a trial's creep excludes zero; False without a measured creep."""
    return record.creep_m_s is not None and record.creep_m_s > (record.creep_error_m_s or 0.0)


def time_of_a_thickness(record: TrialRecord) -> float | None:
    """Return the time [s] in which the brick with the greatest creep per thickness moves by its thickness.

    The result is None without a measured creep, and if the interval of the creep includes zero.
    """
    if not creeps_at_all(record) or not record.creep_m_s or record.creep_thickness_m is None:
        return None
    return record.creep_thickness_m / record.creep_m_s


def soak_summaries(records: Sequence[TrialRecord]) -> list[SoakSummary]:
    """Return the summary of the soaked trials of each engine, profile and policy, in the order of the groups."""
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
