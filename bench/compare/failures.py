"""Sides and engines without a result.

A comparison with a side without a result has no result, because this side states nothing about stacking.

A trial failed if an error, a crash or a lack of memory ended the trial. A trial that collapsed, diverged or reached its
time limit has a result. An unsupported trial neither failed nor has a result.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

from bench.compare.findings import plain
from bench.compare.side import Baseline
from reports.records.trial import Status, TrialRecord

FAILED: frozenset[Status] = frozenset({"error", "crashed", "out_of_memory"})
"""Statuses of failed trials."""
_NO_RESULT: frozenset[Status] = FAILED | {"unsupported"}


class SideFailedError(ValueError):
    """A side in which no trial has a result; the message contains an example and the fix."""


def require_results(side: Baseline, name: str) -> None:
    """Check that at least one trial of a side has a result.

    Args:
        side: base or head.
        name: name of the side, for the message.

    Raises:
        SideFailedError: if no trial has a result.
    """
    if any(record.status not in _NO_RESULT for record in side.trials):
        return
    if not side.trials:
        raise SideFailedError(f"{name}: a comparison needs at least one trial, got none; run the study first")
    first, count = _first(side.trials), len(side.trials)
    raise SideFailedError(
        f"{name}: {'the only trial has no' if count == 1 else f'none of the {count} trials has a'} result, so that a "
        f"comparison has none; for example, {plain(first.trial)}: {first.status}: "
        f"{plain(first.message) or 'no message'}; correct this failure, or compare another run or version"
    )


def failed_engines(side: Baseline) -> dict[str, str]:
    """Return each engine with a failed trial and without a result, with a message that names its first failure."""
    groups: dict[str, list[TrialRecord]] = defaultdict(list)
    for record in side.trials:
        groups[record.engine].append(record)
    return {
        engine: f"none of the {len(records)} trials has a result; the first failure: {first.status}: "
        f"{first.message or 'no message'}"
        for engine, records in groups.items()
        if all(record.status in _NO_RESULT for record in records) and (first := _first(records)).status in FAILED
    }


def _first(records: Sequence[TrialRecord]) -> TrialRecord:
    """Return the first failed trial; without a failed trial, the first trial."""
    return next((record for record in records if record.status in FAILED), records[0])
