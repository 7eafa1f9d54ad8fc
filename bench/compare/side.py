"""The content of one side of a comparison; ``baseline`` reads a side from a results folder or a baseline file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, PrivateAttr, ValidationError, model_validator

from bench.compare.timing import PARTS, Part
from bench.studies.tolerance import Tolerance
from reports.records.pose_trace import PoseTrace, PoseTraceError, read_pose_trace, unpacked
from reports.records.trial import TrialRecord

FORMAT: Literal["stillstack-baseline-1"] = "stillstack-baseline-1"
"""Name of the file format, in the field ``format`` of each baseline file."""


class BaselineError(ValueError):
    """A side that a comparison cannot use; the message names the problem and the fix."""


class _Model(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class Engine(_Model):
    """Version and repeatability of an engine on the machine of the trials."""

    version: str
    deterministic: str
    """Scope in which the engine repeats bit for bit: "across processes", "within a process" or "no"."""
    missing_knobs: Sequence[str] = ()
    """Settings of the profiles that this version of the engine does not have, so that it ran without them."""


class Machine(_Model):
    """Properties of a machine for the comparability of results; the host name is absent."""

    processor: str
    platform: str
    python: str
    commit: str | None = None
    modified: bool = False
    """True if the checkout had uncommitted changes."""
    sources: str | None = None
    """Digest of the suite's sources; None if unknown."""
    packages: Mapping[str, str] = {}
    engines: Mapping[str, Engine] = {}

    def runs_same_code(self, other: Machine) -> bool:
        """Return whether sources, Python and packages are known and equal on both machines; engines may differ."""
        mine, its = ((machine.sources, machine.python, machine.packages) for machine in (self, other))
        return self.sources is not None and mine == its


class Baseline(_Model):
    """Content of a run, as one side of comparisons with other runs."""

    format: Literal["stillstack-baseline-1"] = FORMAT
    study: str
    trial_wall_s: float = Field(gt=0)
    """Wall time after which the run stopped a trial [s]."""
    tolerances: Mapping[str, Tolerance] = {}
    """Tolerances of the scenarios for which the study sets them, by name of the scenario."""
    machines: Mapping[str, Machine] = {}
    """Machines, by the digest of the environment; each record contains such a digest."""
    shares: Mapping[str, Mapping[Part, Annotated[float, Field(gt=0)]]] = {}
    """Ratio of the time of each part of a frame to the time of the engine's step (see ``timing``), by trial id."""
    poses: Mapping[str, Mapping[str, str]] = {}
    """Pose hashes of trials on further processors: by digest of the environment, then by trial id."""
    traces: Mapping[str, str] = {}
    """Packed pose traces, by pose hash."""
    trials: Sequence[TrialRecord] = Field(min_length=1)
    _trace_files: Mapping[str, Path] = PrivateAttr(default_factory=dict)  # of a results folder, by pose hash

    @model_validator(mode="after")
    def _shares_are_whole(self) -> Baseline:
        for trial, parts in self.shares.items():
            if set(parts) != set(PARTS):
                raise ValueError(
                    f"shares of trial {trial[:200]!r}: must be exactly the parts {', '.join(PARTS)}, got "
                    f"{', '.join(parts)[:200] or 'none'}: give exactly these parts"
                )
        return self

    def machine(self, record: TrialRecord) -> Machine | None:
        """Return the machine of a trial; None for an unknown machine."""
        return self.machines.get(record.environment)

    @property
    def present_machines(self) -> dict[str, Machine]:
        """Machines of the records, by digest of the environment; without machines that only have pose hashes."""
        used = {record.environment for record in self.trials}
        return {digest: machine for digest, machine in self.machines.items() if digest in used}

    def pose_hashes(self, record: TrialRecord) -> dict[str, str]:
        """Return the pose hashes of a trial, by model of processor; omit pose hashes of unknown machines."""
        kept = {digest: hashes[record.trial] for digest, hashes in self.poses.items() if record.trial in hashes}
        if record.pose_hash is not None:
            kept[record.environment] = record.pose_hash
        return {self.machines[digest].processor: value for digest, value in kept.items() if digest in self.machines}

    def trace(self, pose_hash: str) -> PoseTrace | None:
        """Return the pose trace of the trials with a pose hash; None if the side has no trace for this hash.

        Raises:
            BaselineError: if the trace is unreadable.
        """
        file, text = self._trace_files.get(pose_hash), self.traces.get(pose_hash)
        try:
            if file is not None:
                return read_pose_trace(file)
            return None if text is None else unpacked(text)
        except PoseTraceError as error:
            place = f"pose hash {pose_hash[:80]} of study '{self.study[:80]}'"
            fix = "" if file is not None else ", or create the baseline again with 'bench baseline'"
            raise BaselineError(f"{place}: {error}{fix}") from error

    def with_trace_files(self, files: Mapping[str, Path]) -> Baseline:
        """Return this side with further files of pose traces, by pose hash."""
        side = self.model_copy()
        side._trace_files = {**self._trace_files, **files}
        return side

    @property
    def trace_files(self) -> Mapping[str, Path]:
        """Files of pose traces in results folders, by pose hash."""
        return self._trace_files

    def repeats_itself(self, record: TrialRecord) -> bool:
        """Return whether the trial's engine declares that it repeats bit for bit across processes."""
        machine = self.machine(record)
        engine = machine.engines.get(record.engine) if machine else None
        return engine is not None and engine.deterministic == "across processes"

    def is_limited(self, record: TrialRecord) -> bool:
        """Return whether the time limit may have determined the end of the trial.

        A stack that is falling at the time limit counts as collapsed, although its fall may not be complete.
        """
        slow = record.status == "collapsed" and record.wall_s is not None and record.wall_s >= self.trial_wall_s
        return record.status == "timeout" or slow


def first_error(error: ValidationError) -> str:
    """Return the first error without the text of the file, because that text is untrusted."""
    first = error.errors(include_url=False, include_input=False)[0]
    field = ".".join(map(str, first["loc"]))[:200]
    words = str(first["msg"]).removeprefix("Value error, ")
    return f"field '{field}': {words}" if field else words
