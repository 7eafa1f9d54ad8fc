"""The table that compares engines, alone and with the extension, by results of several published studies."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from reports.records.folder import ResultsFolder
from reports.records.trial import TrialRecord
from reports.statistics.groups import ALONE, judged_trials
from reports.statistics.soak import soak_summaries
from reports.statistics.thresholds import thresholds_of
from reports.tables.table import NOTHING, Table
from reports.tables.thresholds import percent_of_exact
from reports.tables.tilt import Onset, onsets_of
from reports.tables.wording import MICRO

STUDIES = ("thresholds", "tilt", "soak", "heavy", "issues", "sleep")
"""Published studies that the table reads."""
PROFILE = "game"
EXTENSION = "equilibrium"
SLEEPING = {ALONE: "native", EXTENSION: EXTENSION}
"""Policy from which the column ``asleep`` takes its time, by the method of the row. The row of the engine alone uses
``native``, because under the policy ``none`` no body sleeps."""
LEAST_SHOWN = 1e-3
"""Least creep [um/s] that the table shows as a number, because at this creep a plank takes three months to move by its
thickness."""


def separation_table(studies: Mapping[str, ResultsFolder]) -> Table:
    """Return a table with two rows per engine in profile ``game``: the engine alone, and with ``equilibrium``.

    Args:
        studies: the results folder of each of ``STUDIES``.
    """
    engines = dict.fromkeys(record.engine for folder in studies.values() for record in folder.records)
    rows = tuple((engine, method, *_figures(studies, engine, method)) for engine in engines for method in SLEEPING)
    header = ("engine", "method", "friction", "toppling", "tilt", "creep", "heavy on light", "threads", "asleep")
    return Table("What separates engines", header, rows, id="separation")


def _figures(studies: Mapping[str, ResultsFolder], engine: str, method: str) -> tuple[str, ...]:
    def is_of(record: TrialRecord, policy: str = method) -> bool:
        return (record.engine, record.profile, record.policy) == (engine, PROFILE, policy)

    def of(study: str, policy: str = method) -> list[TrialRecord]:
        return [record for record in studies[study].records if is_of(record, policy)]

    return (
        _limit("friction", of("thresholds"), studies["thresholds"]),
        _limit("ratio", of("thresholds"), studies["thresholds"]),
        _tilt([one for one in onsets_of(studies["tilt"].records) if is_of(one.trial)]),
        _creep(of("soak")),
        _right(of("heavy")),
        _right(of("issues")),
        _asleep(of("sleep", SLEEPING[method])),
    )


def _limit(parameter: str, records: Sequence[TrialRecord], folder: ResultsFolder) -> str:
    """Return the threshold of a parameter in percent of the exact threshold, as text; a dash without a threshold."""
    found = [one for one in thresholds_of(records, folder.study) if one.parameter == parameter]
    return percent_of_exact(found[0]) if found else NOTHING


def _tilt(onsets: Sequence[Onset]) -> str:
    """Return the number of trials with an onset near a limit, over the number of all trials, as text.

    The function leaves out trials of stacks whose limit depends on the normal of a ridge.
    """
    counted = [one for one in onsets if not one.depends_on_ridge]
    return f"{sum(one.is_near for one in counted)}/{len(counted)}" if counted else NOTHING


def _creep(records: Sequence[TrialRecord]) -> str:
    """Return as text the median creep [um/s] of the stacks that stood, and the number of stacks that fell or failed."""
    for one in soak_summaries(records):
        lost = one.fell + one.failed
        speed = NOTHING if one.median_m_s is None else _micrometres(one.median_m_s)
        return f"{speed} ({lost} of {one.trials} lost)" if lost else speed
    return NOTHING


def _micrometres(speed_m_s: float) -> str:
    """Format a speed [m/s] in um/s; return only the bound for a positive speed below ``LEAST_SHOWN``."""
    speed = speed_m_s * MICRO
    return f"<{LEAST_SHOWN:g}" if 0.0 < speed < LEAST_SHOWN else f"{speed:.2g}"


def _right(records: Sequence[TrialRecord]) -> str:
    """Return the number of trials with the verdict ``right``, over the number of judged trials, as text."""
    judged = judged_trials(records)
    return f"{sum(trial.verdict == 'right' for trial in judged)}/{len(judged)}" if judged else NOTHING


def _asleep(records: Sequence[TrialRecord]) -> str:
    """Return the longest time [s] in one trial in which a brick that must move kept its pose, as text."""
    times = [record.asleep_s for record in records if record.asleep_s is not None]
    return f"{max(times):.2f}" if times else NOTHING
