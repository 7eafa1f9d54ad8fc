"""Renew a baseline file, and keep the file's pose hashes of other processors."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping
from typing import NamedTuple

from bench.compare.side import Baseline
from reports.records.trial import TrialRecord


class Renewal(NamedTuple):
    """A new baseline, with the pose hashes of other processors."""

    baseline: Baseline
    kept: Mapping[str, int]
    """Number of kept pose hashes, by model of processor."""
    dropped: Mapping[str, int]
    """Number of pose hashes of the former baseline that may no longer hold, by model of processor."""


def renewed(new: Baseline, former: Baseline) -> Renewal:
    """Return ``new`` with the pose hashes of ``former`` that other processors still have to reproduce.

    The function considers only trials of engines that repeat bit for bit across processes. It keeps a trial's pose hash
    of another processor in two cases, if the version of the engine is the same:

    - both baselines have pose hashes of the trial on common processors, and these pose hashes are equal;
    - the baselines have no such processor in common, and both runs have the same sources, Python and packages.
    """
    before = {record.trial: record for record in former.trials}
    poses: dict[str, dict[str, str]] = defaultdict(dict)
    kept, dropped = Counter[str](), Counter[str]()
    for record in new.trials:
        old = before.get(record.trial)
        if old is None or not new.repeats_itself(record):
            continue
        mine = new.pose_hashes(record)
        known = former.pose_hashes(old)
        for digest, pose_hash in _hashes(former, old):
            processor = former.machines[digest].processor
            if processor in mine:
                continue
            common = [name for name in mine if name in known]
            holds = (
                all(mine[name] == known[name] for name in common) if common else _same_code(new, record, former, digest)
            )
            if holds and record.engine_version == old.engine_version:
                poses[digest][record.trial] = pose_hash
                kept[processor] += 1
            else:
                dropped[processor] += 1
    machines = {**{digest: former.machines[digest] for digest in poses}, **new.machines}
    together = new.model_copy(
        update={"poses": dict(poses), "machines": machines, "traces": {**former.traces, **new.traces}}
    )
    return Renewal(together.with_trace_files(former.trace_files), kept, dropped)


def _hashes(side: Baseline, record: TrialRecord) -> Iterator[tuple[str, str]]:
    """Yield the digest of the environment and the pose hash, of each known machine of a trial."""
    if record.pose_hash is not None and record.environment in side.machines:
        yield record.environment, record.pose_hash
    for digest, hashes in side.poses.items():
        if record.trial in hashes and digest in side.machines:
            yield digest, hashes[record.trial]


def _same_code(new: Baseline, record: TrialRecord, former: Baseline, digest: str) -> bool:
    machine = new.machine(record)
    return machine is not None and machine.runs_same_code(former.machines[digest])
