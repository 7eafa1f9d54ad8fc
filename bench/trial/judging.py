"""Judge the outcome of a trial against the expectation of its scene."""

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
    is_neutral: bool = False,
) -> Verdict:
    """Return the verdict on an outcome.

    The cases, in order:

    - ``none``: theory demands no outcome, the engine does not support the scene, or a stack that must stand is in
      neutral balance;
    - ``undecided``: the time limit stopped the trial;
    - ``failed``: the trial neither completed nor collapsed;
    - for a stack that must stand: ``false_collapse`` if the stack fell, ``creeps`` if a brick creeps, else ``right``;
    - for a stack that must fall: ``false_stand`` if the stack fell at a higher level than expected or not at all;
      ``false_collapse`` if the stack fell at a lower level or too early; ``false_stand`` if the stack fell too late;
      ``failed`` if the stack sank; else ``right``.

    Args:
        expectation: the outcome that theory demands.
        status: status with which the trial ended.
        collapse_level: number of placed levels in the first frame of the collapse; None without a collapse.
        kind: kind of the collapse; None without a collapse.
        collapse_s: simulated time of the first frame of the collapse [s]; None without a collapse.
        creeps: True if the interval of a brick's creep exceeds the creep limit.
        is_neutral: True if the stack is in neutral balance: a rounding error moves the stack, and no force stops the
            motion.

    Raises:
        ValueError: if the stack must fall, and ``expectation`` has no level.
    """
    if expectation.outcome == "study" or status == "unsupported" or (expectation.outcome == "stand" and is_neutral):
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
        raise ValueError("an expectation with the outcome 'fall' needs a level, got None: set Expectation.level")
    if collapse_level is None or collapse_level > expectation.level:
        return "false_stand"
    is_early = collapse_s is not None and collapse_s < expectation.not_before_s
    if collapse_level < expectation.level or is_early:
        return "false_collapse"
    if _is_late(expectation, collapse_s):
        return "false_stand"
    return "failed" if kind == "sink" else "right"


def _is_late(expectation: Expectation, collapse_s: float | None) -> bool:
    """Return whether the stack fell later than theory allows."""
    if expectation.within_s is None or collapse_s is None:
        return False
    return collapse_s > expectation.not_before_s + expectation.within_s
