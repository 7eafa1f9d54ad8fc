"""The determinism gate: did every brick go the same way to the last bit?

Asked only where the answer means something: of engines that repeat themselves across processes, in one version of the
engine and on one model of processor. A change is an alarm, not a fault: a change of the core or of a scene may well be
meant to move bricks. Then a new baseline says so.
"""

from __future__ import annotations

from bench.compare.baseline import Machine
from bench.compare.findings import Judgement
from reports.records.trial import TrialRecord


def judge_poses(
    base: TrialRecord, head: TrialRecord, machines: tuple[Machine | None, Machine | None]
) -> tuple[Judgement, str]:
    """Whether both trials went the same way.

    Args:
        base: a trial of an engine that repeats itself, not stopped by the clock.
        head: the same of the other side.
        machines: where each of them ran; None where that is not known.
    """
    if base.engine_version != head.engine_version:
        return "open", f"{head.engine} {head.engine_version}, was {base.engine_version}"
    why = other_processor(*machines)
    if why is not None:
        return "open", why
    if base.pose_hash is None or head.pose_hash is None:
        return "open", "no poses were recorded"
    if base.pose_hash == head.pose_hash:
        return "same", ""
    return "changed", f"poses {head.pose_hash[:8]}, were {base.pose_hash[:8]}"


def other_processor(base: Machine | None, head: Machine | None) -> str | None:
    """Why what depends on the processor cannot be compared; None if it can."""
    if base is None or head is None:
        return "on which processor it ran was not kept"
    if base.processor != head.processor:
        return f"on {head.processor}, was on {base.processor}"
    return None
