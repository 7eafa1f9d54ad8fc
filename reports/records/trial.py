"""The record of a trial: its schema, its writer and its reader.

A file has one line of JSON per trial. The writer flushes each line to disk, so that an interrupted run keeps every
finished trial. A missing value is null. The schema rejects NaN and infinity. Records are raw data: derive other data
from them, but never edit them.
"""

from __future__ import annotations

import json
import os
import warnings
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Literal, TypeAlias

from pydantic import BaseModel, ConfigDict, ValidationError, field_validator, model_validator

from reports.records.plain_text import plain_text
from scenarios.model import Expectation

Status: TypeAlias = Literal[
    "completed", "collapsed", "timeout", "diverged", "crashed", "error", "out_of_memory", "unsupported"
]
"""Status of a trial at its end."""
Verdict: TypeAlias = Literal["right", "false_collapse", "false_stand", "creeps", "failed", "undecided", "none"]
"""Comparison of a trial's outcome with theory."""
CollapseKind: TypeAlias = Literal["topple", "slide", "drop", "sink"]
"""Kind of a collapse."""

CENSORED: frozenset[Status] = frozenset({"timeout"})
"""Statuses of censored trials, whose levels are only lower bounds."""

NOT_JUDGED: frozenset[Verdict] = frozenset({"none", "undecided"})
"""Verdicts that count as neither right nor wrong."""

FORMAT: Literal[3] = 3
"""Version of the schema, which increases when a field changes its meaning. The reader converts older records:

- format 1: the verdict of a trial that its time limit stopped was ``failed``, and becomes ``undecided``;
- formats 1 and 2: ``creep_m_s`` was the mean motion over the whole watch, and becomes ``mean_motion_m_s``. The verdict
  did not depend on creep and does not change; ``creep_m_s`` becomes null.
"""


class RecordError(ValueError):
    """An unreadable file of records; the message names the file, the fix and, for a faulty line of JSON, the line."""


class RecordWarning(UserWarning):
    """Warning that the last line of a file of records is incomplete."""


class TrialRecord(BaseModel):
    """Results of one trial. A missing value is null, never zero.

    ``reports.records.columns`` writes ``docs/columns.md`` from the docstrings of the fields.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    format: Literal[3] = FORMAT
    """Version of the schema."""
    trial: str
    """Id of the trial, unique within a study."""
    engine: str
    """Name of the physics engine."""
    engine_version: str
    """Version of the engine's package."""
    profile: str
    """Profile of the engine; ``NAME@knob=value`` is a profile with a varied knob."""
    unit_scale: float | None = None
    """Length units of the engine per metre; null if the trial ended before its first frame could start."""
    scenario: str
    """Name of the scenario."""
    scene: str
    """Id of the scene: the scenario with its parameters."""
    parameters: Mapping[str, int | float | str]
    """Parameters of the scenario; JSON in files."""
    policy: str
    """Sleeping method, which decides which bodies freeze; ``none`` is the engine alone."""
    seed: int
    """Seed of the placement noise; seed 0 has no noise."""
    repeat: int
    """Number of the repeat with the same seed, from 0."""
    status: Status
    """Status at the end of the trial: ``completed``, ``collapsed``, ``timeout``, ``diverged``, ``crashed``, ``error``,
    ``out_of_memory`` or ``unsupported``."""
    message: str = ""
    """Reason for the end of the trial; empty for a completed trial."""
    levels_placed: int = 0
    """Number of levels of which every brick had been released."""
    height_levels: int = 0
    """Highest level that ever stood intact, with all levels below it, after its bricks had had time to land. For a
    poured pile: the number of poured bricks."""
    height_m: float | None = None
    """Height [m] of the top of the highest intact level, measured when this level was last seen intact before the next
    level started. For a poured pile: the height of its highest corner in the last frame."""
    collapse_level: int | None = None
    """Number of levels placed when the collapse was first seen; null without a collapse (censored)."""
    sink_m: float | None = None
    """Mean depth [m] of the bricks of the highest intact level below their planned height, at the time of ``height_m``.
    For a poured pile: the decrease of the mean height of all bricks during the watch."""
    drift_m: float | None = None
    """Greatest horizontal distance [m] of a brick from its release position, at the time of ``height_m``."""
    creep_m_s: float | None = None
    """Creep [m/s]: slope of the centre's position over the last half of the watch, for the brick that is fastest
    relative to its thickness. Null if the stack fell, if this half has fewer than 20 frames, and for trials from before
    format 3 unless their recordings prove the creep."""
    frame_ms_p50: float | None = None
    """Median time [ms] of a frame: engine, read-back, core and port calls, but not the bridge to an engine in a
    separate process. The median is over the frames that ``timed_frames`` counts."""
    frame_ms_p95: float | None = None
    """95th percentile of the time [ms] of a frame."""
    frame_ms_p99: float | None = None
    """99th percentile of the time [ms] of a frame."""
    frame_ms_max: float | None = None
    """Longest time [ms] of a frame."""
    engine_ms: float | None = None
    """Mean time [ms] per frame of the engine's step; measured in the engine's process if the engine runs in a separate
    process."""
    readback_ms: float | None = None
    """Mean time [ms] per frame in which the port reads contacts and masses; null without an extension."""
    core_ms: float | None = None
    """Mean time [ms] per frame of the stability core without port calls; null without an extension."""
    port_ms: float | None = None
    """Mean time [ms] per frame in which the port freezes and unfreezes bodies; null without an extension."""
    frame_ratio: float | None = None
    """Ratio of the frame time with the extension to the frame time without the extension, on the same standing
    stack."""
    wakes: int | None = None
    """Number of times that the core unfroze a body; null without an extension."""
    refreezes: int | None = None
    """Number of times that the core froze a body that it had frozen before; null without an extension."""
    longest_live_s: float | None = None
    """Longest simulated time [s] for which one body stayed live; null without an extension."""
    realtime_factor: float | None = None
    """Ratio of the simulated time to the measured time of all timed frames; a value below 1 is slower than real
    time."""
    pose_hash: str | None = None
    """BLAKE2b digest of the float64 poses of all frames, in hexadecimal."""
    expectation: Expectation
    """The outcome that theory demands."""
    verdict: Verdict
    """Comparison of the outcome with theory.
    ``right``: the outcome agrees with theory.
    ``false_stand``: a stack that must fall stood, or fell too late or at too high a level.
    ``false_collapse``: a stack that must stand fell, or a stack that must fall fell too early or at too low a level.
    ``creeps``: a stack that must stand stood, but the whole interval of a brick's creep exceeds the limit.
    ``failed``: a stack that must fall only sank, or an error, a crash, a lack of memory or a divergence ended the
    trial.
    ``undecided``: the time limit stopped the trial.
    ``none``: theory demands no outcome, the engine does not support the scene, or a stack that must stand is in neutral
    balance."""
    environment: str
    """Digest of the environment of the run (``environment.json``)."""
    collapse_kind: CollapseKind | None = None
    """Kind of the collapse; ``sink`` only if nothing toppled, slid or dropped until 1 s after the collapse was first
    seen. For bricks thicker than a plank, this time is longer."""
    collapse_s: float | None = None
    """Simulated time [s] at which the collapse was first seen."""
    frame_ratio_level: int | None = None
    """Level of the stack for which the trial measured, or could not measure, ``frame_ratio``."""
    frame_ratio_one_live: float | None = None
    """Ratio of the time of the engine's step with one live brick on the same stack, frozen, to the frame time without
    the extension. A frame in which no brick is live may take less. Null without ``frame_ratio``, and in older
    records."""
    frame_ratio_message: str = ""
    """Reason why the trial could not measure ``frame_ratio``; empty if the trial measured the ratio, or did not try to
    measure the ratio."""
    levels_planned: int
    """Number of levels of the whole scene."""
    simulated_s: float = 0.0
    """Simulated time [s] when the trial ended."""
    wall_s: float | None = None
    """Wall time [s] of the trial, including work outside timed frames."""
    timed_frames: int | None = None
    """Number of timed frames: all frames after the first five, up to a collapse; null without timed frames."""
    calibration_ms: float | None = None
    """Median time [ms] of a fixed calculation just before and just after the frames. The spread of this time over the
    trials of a run shows variations of the machine's speed. Null if an exception or a crash ended the trial."""
    core: int | None = None
    """Index of the only processor core that the trial could use; null if the trial could use several cores, or if an
    exception or a crash ended the trial."""
    pair: str = ""
    """Id shared by the two scenes of a pair; empty for a scene without a partner."""
    rest_s: float | None = None
    """Time [s] after the last action at which a brick of a poured pile was last seen moving. Null if a brick still
    moved at the end, and for scenes without a pile."""
    repose_deg: float | None = None
    """Angle of repose [deg] of a poured pile: the slope of the cone that has the median height and the median radius of
    the pile."""
    live_mean: float | None = None
    """Mean number of live bricks per frame; null (unknown) without an extension."""
    live_last: int | None = None
    """Number of live bricks in the last frame; null without an extension."""
    adopted: int | None = None
    """Number of bodies of prebuilt stacks that the core froze before the first step after their placement. Null without
    an extension, and for a scene without a prebuilt stack."""
    watch_s: float | None = None
    """Simulated time [s] for which the trial watches the scene after its last action."""
    creep_error_m_s: float | None = None
    """Half width [m/s] of the 95 % interval of ``creep_m_s``, which does not assume independent frames. A stack creeps
    if the whole interval lies above ``creep_limit_m_s``."""
    creep_limit_m_s: float | None = None
    """Creep limit [m/s] of the brick of ``creep_m_s``, by default 1 % of its thickness per minute."""
    creep_thickness_m: float | None = None
    """Thickness [m] of the brick of ``creep_m_s``."""
    sliding_m_s: float | None = None
    """Fastest horizontal creep [m/s] of any centre."""
    sinking_m_s: float | None = None
    """Fastest vertical creep [m/s] of any centre, downward or upward."""
    mean_motion_m_s: float | None = None
    """Fastest mean motion [m/s] of a brick over the whole watch, including the settling of the stack. Null in trials
    since format 3; earlier formats called this motion creep."""
    host: str | None = None
    """Name of the machine; timings of different machines are not comparable. Null if an exception or a crash
    ended the trial."""
    bridge_ms: float | None = None
    """Mean time [ms] per frame of the transfer to an engine in a separate process and back, which no other time
    includes. Null for an engine in the trial's own process."""
    onset_deg: float | None = None
    """Slope [deg] of tilting ground at which a brick had moved by 1 % of its thickness or turned by half a degree. Null
    if no brick moved or turned by that much, and if no ground tilts."""
    own_limit_deg: float | None = None
    """Greatest slope [deg] at which exact statics finds an equilibrium with the points and normals of the engine's own
    contacts. Null with an extension, if no ground tilts, and if statics gives the same answer at 0 and 45 deg."""
    ridge_deg: float | None = None
    """Greatest angle [deg] between the engine's contact normal at a ridge, where two leaning planks meet, and the
    bisector of the normals that are possible there. Null with an extension, if no ground tilts, and if no contact at a
    ridge was seen."""
    asleep_s: float | None = None
    """Simulated time [s] in which a brick that must move by theory kept its pose to the last bit; null if no brick must
    move."""
    moved_after_s: float | None = None
    """Simulated time [s] after which all bricks that must move had covered the distance that theory demands. Null if a
    brick had not covered its distance, and if no brick must move."""
    carried_share: float | None = None
    """Ratio of the weight that the ground carries, by the engine's contact forces, to the weight of all bricks. The
    value is the mean over the frames of the watch of the finished stack. Null if the trial has no audit of forces, or
    the engine reports no forces."""
    cone_excess: float | None = None
    """Amount by which the friction force of the worst contact exceeds mu times its normal force, in units of the mean
    weight of a brick. The value is the mean over the frames of ``carried_share``. Null if ``carried_share`` is null."""
    complementarity: float | None = None
    """Greatest natural residual abs(min(f / w, s / h)) of a contact. A contact has the normal force f and the
    separation s (negative for an overlap); w is the mean weight and h the least thickness of a brick. The value is the
    mean over the frames of ``carried_share``. Null if ``carried_share`` is null, and if the engine reports no
    separations."""

    memory_mib: float | None = None
    """Peak of the resident memory [MiB] of the trial's process from the opening of the engine to the last frame, minus
    the resident memory just before that opening. The difference includes the engine, the extension, the data recorded
    by the harness, and code pages used for the first time. If the trial compiles a kernel, the compiler counts too.
    Null if the system does not report the peak, for an engine in a separate process, and if an exception or a crash
    ended the trial."""
    solver_iterations: float | None = None
    """Mean number of iterations of the engine's solver in the last step of a frame, for the island with the most
    iterations. Null if the engine reports no iterations. The frames are the frames of ``frame_ms_p50``."""
    core_instructions: float | None = None
    """Mean number of instructions per frame of the core in user code, without port calls. Null without an extension,
    for a policy that joins bodies, and if the system does not count instructions. The frames are the frames of
    ``frame_ms_p50``."""

    @model_validator(mode="before")
    @classmethod
    def _of_present_format(cls, fields: object) -> object:
        """Convert a record of an earlier format."""
        if not isinstance(fields, dict) or fields.get("format") not in (1, 2):
            return fields
        converted = {**fields, "format": FORMAT, "creep_m_s": None, "mean_motion_m_s": fields.get("creep_m_s")}
        if fields["format"] == 1 and fields.get("status") in CENSORED and fields.get("verdict") == "failed":
            converted["verdict"] = "undecided"
        return converted

    @property
    def is_judged(self) -> bool:
        """True if the verdict counts as right or wrong."""
        return self.verdict not in NOT_JUDGED

    @property
    def creep_is_uncertain(self) -> bool:
        """True if the verdict is ``right`` although the creep exceeds its limit.

        The interval of such a creep includes the limit.
        """
        measured, limit = self.creep_m_s, self.creep_limit_m_s
        return self.verdict == "right" and measured is not None and limit is not None and measured > limit

    @field_validator("message", "frame_ratio_message", mode="before")
    @classmethod
    def _without_escapes(cls, text: object) -> object:
        """Remove terminal control sequences from text that an engine printed or raised."""
        return plain_text(text) if isinstance(text, str) else text


class RecordWriter:
    """Writer that appends records to a file, and flushes each record to disk before the next trial starts."""

    def __init__(self, path: Path) -> None:
        """Open ``path`` for appending, and remove a last line that an interruption left incomplete."""
        self.torn = _mend(path)
        """True if the last line was incomplete."""
        self._file = path.open("a", encoding="utf-8")

    def append(self, record: TrialRecord) -> None:
        """Write one record and wait until it is on disk."""
        self._file.write(record.model_dump_json() + "\n")
        self._file.flush()
        os.fsync(self._file.fileno())

    def close(self) -> None:
        """Close the file."""
        self._file.close()


def read_records(path: Path) -> list[TrialRecord]:
    """Return all records of a file, in the order of the file.

    Raises:
        RecordError: if the file is missing or unreadable, or contains a line that is not a record.

    Warns:
        RecordWarning: if the last line is incomplete; the reader skips this line.
    """
    try:
        return list(_records(path))
    except FileNotFoundError as error:
        raise RecordError(
            f"{path}: cannot read this file (no such file); name a results folder, as written by 'bench run'"
        ) from error
    except OSError as error:
        raise RecordError(
            f"{path}: cannot read this file ({error.strerror}); name a readable results folder"
        ) from error


def _records(path: Path) -> Iterator[TrialRecord]:
    with path.open("rb") as lines:
        for number, raw in enumerate(lines, start=1):
            if not raw.strip():
                continue
            if _is_torn(raw):
                warnings.warn(
                    f"{path}:{number}: the last line is incomplete; the reader skips it; "
                    "run the study again to repeat this trial",
                    RecordWarning,
                    stacklevel=4,
                )
                return
            try:
                yield TrialRecord.model_validate_json(raw)
            except ValidationError as error:
                raise RecordError(f"{path}:{number}: {_reason(error)}") from error


def _is_torn(raw: bytes) -> bool:
    """Return whether a line is incomplete; a line that lacks only its line break is complete."""
    if raw.endswith(b"\n"):
        return False
    try:
        json.loads(raw)
    except ValueError:
        return True
    return False


def _reason(error: ValidationError) -> str:
    first = error.errors(include_url=False)[0]
    field = ".".join(map(str, first["loc"]))
    if first["type"] == "json_invalid":
        return f"not a line of JSON ({first['msg']}); restore the file, or remove the line and run its trial again"
    if field == "format":
        if isinstance(first["input"], int) and first["input"] > FORMAT:
            return f"a record of format {first['input']}, newer than this suite's {FORMAT}: update the suite"
        return f"not a record of format {FORMAT} ({first['msg']}, got {first['input']!r}); restore the file"
    got = "" if first["type"] == "missing" else f", got {first['input']!r:.80}"
    place = f"field '{field}': " if field else ""
    return f"not a trial record: {place}{first['msg']}{got}; restore the file, or run the trial again"


def _mend(path: Path) -> bool:
    """Remove an incomplete last line from the file; return True if there was an incomplete line.

    A complete last line that lacks its line break receives a line break.
    """
    if not path.exists():
        return False
    content = path.read_bytes()
    last = content.rpartition(b"\n")[2]
    if not last:
        return False
    torn = _is_torn(last)
    with path.open("r+b") as file:
        if torn:
            file.truncate(len(content) - len(last))
        else:
            file.seek(0, 2)
            file.write(b"\n")
    return torn
