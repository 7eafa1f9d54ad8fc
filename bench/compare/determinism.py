"""The determinism gate, which judges whether every pose is the same to the last bit.

The gate judges only engines that repeat bit for bit across processes, on one model of processor. Different versions of
an engine are compared only if the caller asks whether poses changed between them. A change is an alarm, not necessarily
an error: a change of the core or of a scene may move bricks on purpose. The commit of such a change also contains a new
baseline.
"""

from __future__ import annotations

from bench.compare.baseline import Machine
from bench.compare.findings import Judgement
from reports.records.trial import TrialRecord


def judge_poses(
    base: TrialRecord,
    head: TrialRecord,
    machines: tuple[Machine | None, Machine | None],
    *,
    across_versions: bool = False,
) -> tuple[Judgement, str]:
    """Judge whether the poses of both trials are the same.

    Args:
        base: a trial of an engine that repeats bit for bit, not stopped by its time limit.
        head: the trial with the same id in the head.
        machines: the machines of base and head; None if unknown.
        across_versions: True to compare the poses of different versions of an engine.

    Returns:
        The judgement, and a message that explains it.
    """
    if base.engine_version != head.engine_version and not across_versions:
        return "open", f"{head.engine} {head.engine_version}, was {base.engine_version} (--poses compares them)"
    why = other_processor(*machines)
    if why is not None:
        return "open", why
    if base.pose_hash is None or head.pose_hash is None:
        return "open", "no poses were recorded"
    if base.pose_hash == head.pose_hash:
        return "same", ""
    return "changed", f"poses {head.pose_hash[:8]}, were {base.pose_hash[:8]}"


def other_processor(base: Machine | None, head: Machine | None) -> str | None:
    """Return the reason for which results that depend on the processor cannot be compared; None if they can."""
    if base is None or head is None:
        return "its processor is unknown"
    if base.processor != head.processor:
        return f"on {head.processor}, was on {base.processor}"
    return None
