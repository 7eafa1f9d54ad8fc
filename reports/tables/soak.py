"""The tables of a soak: creep of stacks that must stand, and the time until a brick has moved by its thickness."""

from __future__ import annotations

from collections.abc import Sequence

from reports.records.trial import TrialRecord
from reports.statistics.soak import creeps_at_all, soak_summaries, soaked, time_of_a_thickness
from reports.tables.table import NOTHING, Table
from reports.tables.wording import MICRO

_UNITS = ((365.25 * 86400.0, "years"), (86400.0, "days"), (3600.0, "h"), (60.0, "min"), (1.0, "s"))
"""Units of time: length [s] and name, the longest first."""
_MOST_YEARS = 100.0
"""Longest time that the table gives as a number [years]."""


def soak_tables(records: Sequence[TrialRecord]) -> list[Table]:
    """Return the table by engine, profile and policy, and the table of all trials; empty without a soak."""
    trials = soaked(records)
    if not trials:
        return []
    watched = " or ".join(f"{watch_s:g} s" for watch_s in sorted({trial.watch_s or 0.0 for trial in trials}))
    return [_summaries(records, watched), _trials(trials)]


def duration(seconds: float | None) -> str:
    """Format a time [s] in a suitable unit, such as ``8.4 h``; return a dash for None.

    The text gives only the bound for a time above ``_MOST_YEARS``.
    """
    if seconds is None:
        return NOTHING
    if seconds > _MOST_YEARS * _UNITS[0][0]:
        return f">{_MOST_YEARS:g} years"
    length, unit = next(((length, unit) for length, unit in _UNITS if seconds >= length), _UNITS[-1])
    return f"{seconds / length:.3g} {unit}"


def _summaries(records: Sequence[TrialRecord], watched: str) -> Table:
    rows = tuple(
        (
            one.engine,
            one.profile,
            one.policy,
            str(one.trials),
            f"{one.fell}",
            f"{one.failed}",
            f"{one.creep}",
            NOTHING if one.median_m_s is None else f"{one.median_m_s * MICRO:.3g}",
            duration(one.shortest_s),
        )
        for one in soak_summaries(records)
    )
    notes = (
        f"Stacks that must stand, watched for {watched}. Creep: those of which the 95 % interval excludes zero; the "
        "median creep [µm/s] of all that stood; and the shortest time until a brick has moved by its thickness, at "
        "the creep that was measured. Failed: stopped by the time limit, diverged or crashed.",
    )
    header = ("engine", "profile", "policy", "stacks", "fell", "failed", "creep", "median µm/s", "a thickness in")
    return Table("Soak", header, rows, notes, id="soak")


def _trials(trials: Sequence[TrialRecord]) -> Table:
    notes = (
        "Creep [µm/s] of the brick that is fastest for its thickness, over the last half of the watch, ± half of its "
        "95 % interval (Kiefer, Vogelsang and Bunzel 2000: frames are not independent); the fastest horizontal and "
        "vertical creep of any brick; and the time until that brick has moved by its thickness, where the interval "
        "excludes zero.",
    )
    header = ("scene", "engine", "profile", "policy", "creep", "±", "sliding", "sinking", "a thickness in")
    return Table("Soak, stack by stack", header, tuple(map(_row, trials)), notes, id="soak_stacks")


def _row(trial: TrialRecord) -> tuple[str, ...]:
    head = (trial.scene, trial.engine, trial.profile, trial.policy)
    if trial.status == "collapsed" and trial.collapse_s is not None:
        return (*head, "fell", NOTHING, NOTHING, NOTHING, duration(trial.collapse_s))
    if trial.creep_m_s is None:
        return (*head, trial.status, *(NOTHING,) * 4)
    speeds = (trial.creep_m_s, trial.creep_error_m_s, trial.sliding_m_s, trial.sinking_m_s)
    texts = (NOTHING if speed is None else f"{speed * MICRO:.3g}" for speed in speeds)
    return (*head, *texts, duration(time_of_a_thickness(trial)) if creeps_at_all(trial) else "never")
