"""The table of public threads: the reported outcome, the exact outcome and the outcomes on the engines."""

from __future__ import annotations

from collections.abc import Sequence

from reports.records.trial import TrialRecord
from reports.statistics.groups import grouped, ordered_policies
from reports.tables.table import NOTHING, Table
from reports.tables.wording import MICRO
from scenarios.threads import Thread, thread_of

_NOT_PLAYED = {"unsupported": "n/a", "timeout": "timed out"}


def thread_tables(records: Sequence[TrialRecord]) -> list[Table]:
    """Return the table of public threads in a list, which is empty if no scene comes from a thread.

    The table shows only trials with seed 0 and repeat 0.
    """
    found = [(record, thread) for record in records if (thread := thread_of(record.parameters)) is not None]
    draws = [(record, thread) for record, thread in found if record.seed == 0 and record.repeat == 0]
    if not draws:
        return []
    several = len({record.profile for record, _ in draws}) > 1
    columns = list(dict.fromkeys(_set_up(record, several) for record, _ in draws))
    policies = ordered_policies(record.policy for record, _ in draws)
    named = {record.scene: thread for record, thread in draws}
    rows = []
    for (scene,), trials in grouped([record for record, _ in draws], "scene").items():
        for policy in policies:
            those = {_set_up(trial, several): trial for trial in trials if trial.policy == policy}
            if those:
                rows.append(_row(named[scene], trials[0], policy, [those.get(column) for column in columns]))
    notes = (
        "Reported: of the thread's engine and settings. Exact: what statics says of the scene here, by the judge. ✓ as "
        "exact statics demands, ✗ not; “creeps”: it stands, but the 95 % interval of a creep lies above the limit.",
        "No mark: not decided, or a stack without friction, in which nothing resists a rounding error.",
        "Threads: " + ", ".join(dict.fromkeys(f"{thread.name} ({thread.url})" for _, thread in draws)) + ".",
    )
    header = ("thread", "scene", "policy", "reported", "exact", *columns)
    return [Table("Public threads", header, tuple(rows), notes, id="threads")]


def _set_up(record: TrialRecord, several: bool) -> str:
    return f"{record.engine} {record.profile}" if several else record.engine


def _row(thread: Thread, first: TrialRecord, policy: str, trials: Sequence[TrialRecord | None]) -> tuple[str, ...]:
    file = str(first.parameters["file"]).removesuffix(".toml")
    return (thread.name, file, policy, thread.reported, str(first.expectation), *map(measured, trials))


def measured(trial: TrialRecord | None) -> str:
    """Return the outcome of a trial as text, such as ``creeps 7.2 µm/s ✗``; a dash without a trial."""
    if trial is None:
        return NOTHING
    mark = "" if not trial.is_judged else " ✓" if trial.verdict == "right" else " ✗"
    return f"{_end(trial)}{mark}"


def _end(trial: TrialRecord) -> str:
    if trial.status == "collapsed" and trial.collapse_s is not None:
        return f"{'sinks' if trial.collapse_kind == 'sink' else 'falls'} at {trial.collapse_s:.1f} s"
    if trial.status != "completed":
        return _NOT_PLAYED.get(trial.status, trial.status)
    if trial.verdict == "creeps" and trial.creep_m_s is not None:
        return f"creeps {trial.creep_m_s * MICRO:.3g} µm/s"
    return "stands"
