"""Judge the outcome of a trial by the expectation of its scene."""

from __future__ import annotations

from reports.records.trial import CollapseKind, Status, Verdict
from scenarios.model import Expectation


def verdict(
    expectation: Expectation,
    status: Status,
    collapse_level: int | None,
    kind: CollapseKind | None,
    collapse_s: float | None = None,
    *,
    creeps: bool = False,
) -> Verdict:
    """Return the verdict on an outcome.

    Standing is right if the trial ran to its end and no brick creeps; falling is right only at the level itself, not
    before it is due and not later than theory allows, by toppling, sliding or dropping. A trial that did not get to its
    end, and one that sank where it had to fall, has failed; one that its time limit stopped is undecided.
    """
    if expectation.outcome == "study" or status == "unsupported":
        return "none"
    if status == "timeout":
        return "undecided"
    if status not in {"completed", "collapsed"}:
        return "failed"
    if expectation.outcome == "stand":
        if status == "collapsed":
            return "false_collapse"
        return "creeps" if creeps else "right"
    if expectation.level is None:
        raise ValueError("an expectation to fall needs a level: set Expectation.level")
    if collapse_level is None or collapse_level > expectation.level:
        return "false_stand"
    is_early = collapse_s is not None and collapse_s < expectation.not_before_s
    if collapse_level < expectation.level or is_early:
        return "false_collapse"
    if _is_late(expectation, collapse_s):
        return "false_stand"
    return "failed" if kind == "sink" else "right"


def _is_late(expectation: Expectation, collapse_s: float | None) -> bool:
    """Return whether a fall came later than theory allows, so that something held the stack."""
    if expectation.within_s is None or collapse_s is None:
        return False
    return collapse_s > expectation.not_before_s + expectation.within_s
