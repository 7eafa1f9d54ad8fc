"""The table of the sleep audit: for bricks that must move, the time asleep and the time to the required motion."""

from __future__ import annotations

from collections.abc import Sequence

from reports.records.trial import TrialRecord
from reports.statistics.groups import grouped, ordered_policies
from reports.tables.table import NOTHING, Table
from scenarios.registry import build

TITLE = "Sleep audit"
"""Title of the table."""
NEVER = "never"
"""Entry for a brick that did not move far enough within the trial."""


def sleep_tables(records: Sequence[TrialRecord]) -> list[Table]:
    """Return the table of all trials in which a brick must move, in a list.

    The list is empty if no such trial has an audit.
    """
    audited = [record for record in records if _must_move(record)]
    if not any(record.asleep_s is not None for record in audited):
        return []
    policies = ordered_policies(record.policy for record in audited)
    rows = []
    for (scene, engine, profile), trials in grouped(audited, "scene", "engine", "profile").items():
        by_policy = {policy: list(those) for (policy,), those in grouped(trials, "policy").items()}
        cells = (_cell(by_policy.get(policy, [])) for policy in policies)
        rows.append((scene, engine, profile, _exact(trials[0]), *cells))
    notes = (
        "Seconds in which a brick that must move kept its pose to the last bit, then seconds until it had moved as far "
        f"as it must (“{NEVER}”: not within the trial); the worst of several trials. Exact: the latter by "
        "closed form. A frame is 1/60 s.",
    )
    return [Table(TITLE, ("scene", "engine", "profile", "exact", *policies), tuple(rows), notes, id="sleep")]


def _must_move(record: TrialRecord) -> bool:
    return record.asleep_s is not None or (record.status == "unsupported" and bool(_due(record)))


def _due(record: TrialRecord) -> tuple[float | None, ...]:
    """Return the times that theory gives for the required motions of a scene [s]; None for an unknown time."""
    return tuple(due.takes_s for due in build(record.scenario, **record.parameters).must_move)


def _exact(record: TrialRecord) -> str:
    known = [seconds for seconds in _due(record) if seconds is not None]
    return f"{max(known):.2f}" if known else NOTHING


def _cell(trials: Sequence[TrialRecord]) -> str:
    seen = [(trial.asleep_s, trial.moved_after_s) for trial in trials if trial.asleep_s is not None]
    if not seen:
        return "n/a" if any(trial.status == "unsupported" for trial in trials) else NOTHING
    asleep = max(seconds for seconds, _ in seen)
    times = [moved for _, moved in seen if moved is not None]
    moved = f"{max(times):.2f}" if len(times) == len(seen) else NEVER
    return f"{asleep:.2f}, {moved}"
