"""The outcome gate, which judges status, levels, collapse level, verdict, sink and creep.

The caller excludes trials that the time limit may have ended. For an engine that repeats bit for bit, the gate compares
single trials. For another engine, the gate compares groups of repeats, because a single trial is a random draw.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

from bench.compare.findings import Judgement
from bench.studies.tolerance import Tolerance
from reports.records.trial import TrialRecord

LEAST_REPEATS = 5
"""Fewest repeats per side for an engine that does not repeat bit for bit. Five repeats are enough, because with equal
sides all repeats of the head are worse than all repeats of the base in only one of 252 groups."""

_PLAYED = frozenset({"completed", "collapsed"})
"""Statuses of trials that the harness played to their ends."""
_MM = 1e3
"""Factor from metres to millimetres."""


def judge_outcome(base: TrialRecord, head: TrialRecord, tolerance: Tolerance) -> tuple[Judgement, str]:
    """Judge whether ``head`` has a worse outcome than ``base``; return the judgement and its reasons."""
    if head.status not in _PLAYED or base.status not in _PLAYED:
        return _judge_failure(base, head)
    worse = [*_lost(base, head), *_less(base, head, tolerance)]
    if worse:
        return "worse", "; ".join(worse)
    better = [*_lost(head, base), *_less(head, base, tolerance)]
    if better:
        return "better", f"was: {'; '.join(better)}"
    if base.verdict != head.verdict and _differ_in_creep_rule(base, head):
        return "open", f"{head.verdict}, was {base.verdict}: the creep of one side is unknown"
    if base.verdict != head.verdict:
        return "open", f"{head.verdict}, was {base.verdict}: neither is right"
    return "same", ""


def judge_draws(
    base: Sequence[TrialRecord], head: Sequence[TrialRecord], tolerance: Tolerance
) -> tuple[Judgement, str]:
    """Judge repeats of an engine that does not repeat bit for bit; return the judgement and its reasons.

    The head is worse (better) only if each trial of the head is worse (better) than each trial of the base. If a side
    then has fewer than ``LEAST_REPEATS`` repeats, the judgement is ``open``. If two pairs of trials have different
    judgements, the judgement is ``same``.
    """
    judged = [judge_outcome(was, now, tolerance) for was, now in product(base, head)]
    kinds = {judgement for judgement, _ in judged}
    if len(kinds) > 1:
        return "same", ""
    judgement, message = judged[0]
    fewest = min(len(base), len(head))
    if judgement in {"worse", "better"} and fewest < LEAST_REPEATS:
        draw = f"the engine does not repeat bit for bit, and {fewest} of the {LEAST_REPEATS} repeats needed exist"
        return "open", f"{message}; may be chance: {draw}"
    return judgement, message


def values_of(records: Sequence[TrialRecord]) -> str:
    """Return the outcome of a trial, or the distinct outcomes of its repeats: verdict, levels, sink and creep."""
    return " | ".join(dict.fromkeys(map(_values, records)))


def _values(record: TrialRecord) -> str:
    if record.status not in _PLAYED:
        return f"{record.status}: {record.message}" if record.message else record.status
    parts = [record.verdict, f"{record.height_levels} of {record.levels_planned} levels"]
    if record.collapse_level is not None:
        parts.append(f"falls at {record.collapse_level}")
    if record.sink_m is not None:
        parts.append(f"sinks {_figure(record.sink_m, 'mm')}")
    if record.creep_m_s is not None:
        parts.append(f"creeps {_figure(record.creep_m_s, 'mm/s')}")
    return ", ".join(parts)


def _judge_failure(base: TrialRecord, head: TrialRecord) -> tuple[Judgement, str]:
    """Judge two trials if the harness did not play both trials to their ends."""
    message = f"{head.status}, was {base.status}"
    if head.message and head.status not in _PLAYED:
        message += f" ({head.message})"
    if base.status in _PLAYED:
        return "worse", message
    if head.status in _PLAYED:
        return "better", message
    return ("same", "") if base.status == head.status else ("open", message)


def _lost(base: TrialRecord, head: TrialRecord) -> list[str]:
    """Return a list with the verdict of ``head`` if ``base`` is right and ``head`` is not right; else an empty list.

    If only one side has a measured creep, a change from right to creeping does not count.
    """
    if _differ_in_creep_rule(base, head):
        return []
    return [f"{head.verdict}, was right"] if base.verdict == "right" and head.verdict != "right" else []


def _differ_in_creep_rule(base: TrialRecord, head: TrialRecord) -> bool:
    """Return whether one side is right and the other side creeps, and only one side has a measured creep.

    A record from before format 3 has no creep, because format 3 introduced the field.
    """
    is_judged_alike = (base.creep_m_s is None) == (head.creep_m_s is None)
    return not is_judged_alike and {base.verdict, head.verdict} == {"right", "creeps"}


def _less(base: TrialRecord, head: TrialRecord, tolerance: Tolerance) -> list[str]:
    """Return the figures in which ``head`` is worse than ``base`` by more than the tolerance."""
    reasons = []
    if _fall_error(head) > _fall_error(base) + tolerance.levels:
        reasons.append(f"{_fall(head)}, {_fall(base)} before")
    if head.expectation.outcome != "fall" and head.height_levels < base.height_levels - tolerance.levels:
        reasons.append(f"{head.height_levels} of {head.levels_planned} levels, {base.height_levels} before")
    if head.height_levels == base.height_levels:  # sinks of stacks of different heights are not comparable
        allowed = _allowed(base.sink_m, tolerance.sink_m, tolerance.sink_share)
        if _exceeds(head.sink_m, allowed):
            reasons.append(f"sinks {_figure(head.sink_m, 'mm')}, {_figure(base.sink_m, 'mm')} before")
    allowed = _allowed(base.creep_m_s, tolerance.creep_m_s, tolerance.creep_share)
    if _exceeds(_certain_creep(head), allowed):
        reasons.append(f"creeps {_figure(head.creep_m_s, 'mm/s')}, {_figure(base.creep_m_s, 'mm/s')} before")
    return reasons


def _certain_creep(record: TrialRecord) -> float | None:
    """Return the creep [m/s] if its interval excludes zero, else None.

    An interval that includes zero counts as no creep, because the vibration of a stack can look like creep.
    """
    is_certain = record.creep_m_s is not None and record.creep_m_s > (record.creep_error_m_s or 0.0)
    return record.creep_m_s if is_certain else None


def _fall_error(record: TrialRecord) -> int:
    """Return the absolute difference [levels] between the collapse level and the level that theory demands.

    For a stack that did not fall, the collapse level is the level above the last level of the stack. The same level
    replaces the demanded level if theory demands no fall.
    """
    beyond = record.levels_planned + 1
    falls_at = beyond if record.collapse_level is None else record.collapse_level
    demanded = record.expectation.level if record.expectation.outcome == "fall" else None
    return abs(falls_at - (beyond if demanded is None else demanded))


def _fall(record: TrialRecord) -> str:
    return "stands" if record.collapse_level is None else f"falls at {record.collapse_level}"


def _allowed(base: float | None, absolute: float, share: float) -> float | None:
    return None if base is None else base + absolute + share * abs(base)


def _exceeds(head: float | None, allowed: float | None) -> bool:
    return head is not None and allowed is not None and head > allowed


def _figure(value: float | None, unit: str) -> str:
    return "-" if value is None else f"{value * _MM:.3g} {unit}"
