"""The determinism gate, which judges whether every pose is the same to the last bit.

The gate judges only engines that repeat bit for bit across processes, on one model of processor. A side may have pose
hashes of several models. The gate compares the pose hashes of the models that both sides have. It compares different
versions of an engine only if the caller asks for this comparison. A change of a pose is an alarm, not necessarily an
error: a change of the core or of a scene may move bricks on purpose. The commit of a change on purpose must also
contain a new baseline.
"""

from __future__ import annotations

import numpy as np

from bench.compare.findings import Judgement
from bench.compare.side import Baseline, Machine
from reports.records.pose_trace import FloatArray, parting
from reports.records.trial import TrialRecord

_NAMES = ("x", "y", "z", "qw", "qx", "qy", "qz")
"""Names of the components of a pose; the first three are lengths [m]."""


def judge_poses(
    base: TrialRecord,
    head: TrialRecord,
    sides: tuple[Baseline, Baseline],
    *,
    across_versions: bool = False,
) -> tuple[Judgement, str]:
    """Judge whether the poses of both trials are the same.

    Args:
        base: a trial of an engine that repeats bit for bit, not stopped by its time limit.
        head: the trial with the same id in the head.
        sides: the sides of base and head.
        across_versions: True to compare the poses of different versions of an engine.

    Returns:
        The judgement, and a message that explains the judgement.

    Raises:
        BaselineError: if a pose trace is unreadable.
    """
    if base.engine_version != head.engine_version and not across_versions:
        return "open", f"{head.engine} {head.engine_version}, was {base.engine_version} (--poses compares them)"
    if base.pose_hash is None or head.pose_hash is None:
        return "open", "no poses were recorded"
    before, now = sides[0].pose_hashes(base), sides[1].pose_hashes(head)
    if not before or not now:
        return "open", "its processor is unknown"
    processors = [name for name in now if name in before]
    if not processors:
        return "open", _on_other_processor(", ".join(now), ", ".join(before))
    for name in processors:
        if before[name] != now[name]:
            message = f"poses {now[name][:8]}, were {before[name][:8]}"
            where = _where_they_part(before[name], now[name], sides)
            return "changed", f"{message}{where}" + (f", on {name}" if len(before) > 1 else "")
    return "same", ""


def other_processor(base: Machine | None, head: Machine | None) -> str | None:
    """Return the reason that excludes a comparison of processor-dependent results; None without a reason."""
    if base is None or head is None:
        return "its processor is unknown"
    if base.processor != head.processor:
        return _on_other_processor(head.processor, base.processor)
    return None


def _on_other_processor(head: str, base: str) -> str:
    return f"on {head}, was on {base}"


def _where_they_part(base: str, head: str, sides: tuple[Baseline, Baseline]) -> str:
    """Return the first difference of two trials as the end of a message: frame, body and values.

    The text is empty if a side has no pose trace.

    Args:
        base: pose hash of the base.
        head: pose hash of the head.
        sides: the sides of base and head.
    """
    before, now = sides[0].trace(base), sides[1].trace(head)
    if before is None or now is None:
        return ""
    part = parting(before, now)
    if part is None:
        return f"; the first {min(before.frames, now.frames)} frames are the same"
    others = f" and {part.bodies - 1} more" if part.bodies > 1 else ""
    return f"; first in frame {part.frame}: body {part.body}{others}{_values(*part.poses)}"


def _values(base: FloatArray | None, head: FloatArray | None) -> str:
    """Return the component with the greatest difference, with both values, as the end of a message.

    If only the head is known, the text gives its position. Without a known head, the text is empty.

    Args:
        base: pose in the base (x, y, z [m], qw, qx, qy, qz), shape (7,); None if unknown. NaN or infinite if the world
            does not contain the body.
        head: pose in the head, with the same exceptions.
    """
    if head is None:
        return ""
    if base is None:
        position = ", ".join(f"{value:.9g}" for value in head[:3])
        return f", now at ({position}) m (two results folders show both values)"
    if not np.isfinite(base).all() or not np.isfinite(head).all():
        return f", which {'the base' if np.isfinite(head).all() else 'the head'} does not have"
    most = int(np.argmax(np.abs(head - base)))
    unit = " m" if most < 3 else ""
    return f", {_NAMES[most]} = {head[most]:.17g}{unit}, was {base[most]:.17g}{unit}"
