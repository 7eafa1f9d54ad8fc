"""The record of a trial: its schema, its writer and its reader.

A file has one line of JSON per trial, appended and flushed, so that an interrupted run keeps every finished trial. A
value that does not exist is null; NaN and infinity are refused. Derive from these records, never edit them.
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
Verdict: TypeAlias = Literal["right", "false_collapse", "false_stand", "creeps", "failed", "undecided", "none"]
CollapseKind: TypeAlias = Literal["topple", "slide", "drop", "sink"]

CENSORED: frozenset[Status] = frozenset({"timeout"})
"""Statuses of censored trials: their levels are lower bounds, never heights."""

NOT_JUDGED: frozenset[Verdict] = frozenset({"none", "undecided"})
"""Verdicts that count as neither right nor wrong."""

FORMAT: Literal[3] = 3
"""Version of the schema; raised when a field changes its meaning. Older records are converted when they are read:

- format 1: the verdict of a trial that its time limit stopped was ``failed``, and becomes ``undecided``;
- formats 1 and 2: ``creep_m_s`` was the mean motion over the whole watch, and becomes ``mean_motion_m_s``. Creep did
  not count, and such a record does not contain it: it is missing, and the verdict stays as it was.
"""


class RecordError(ValueError):
    """A file of records that cannot be read; the message names the file and the line."""


class RecordWarning(UserWarning):
    """A file of records whose last line is incomplete."""


class TrialRecord(BaseModel):
    """The results of one trial. Null means that there is no such value, never zero.

    The docstrings of the fields are the meanings in ``docs/columns.md``.
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
    """Set-up of the engine; ``NAME@knob=value`` varies a knob of a profile."""
    unit_scale: float | None = None
    """The engine's length units per metre; null if the engine was never opened."""
    scenario: str
    """Name of the scenario."""
    scene: str
    """Id of the scene: the scenario with its parameters."""
    parameters: Mapping[str, int | float | str]
    """Parameters of the scenario; JSON in files."""
    policy: str
    """Sleeping method: which bodies freeze; ``none`` is the engine alone."""
    seed: int
    """Seed of the placement noise; 0 is the exact build."""
    repeat: int
    """Number of the repeat with the same seed, from 0."""
    status: Status
    """How the trial ended."""
    message: str = ""
    """Why the trial ended so, unless it completed."""
    levels_placed: int = 0
    """Number of levels of which every brick had been released."""
    height_levels: int = 0
    """Highest level that ever stood intact, with all below it, after its bricks had had time to land."""
    height_m: float | None = None
    """Top [m] of the highest intact level when last seen intact before the next level started."""
    collapse_level: int | None = None
    """Levels placed when the collapse was first seen; null without a collapse (censored)."""
    sink_m: float | None = None
    """Mean depth [m] of the bricks of the highest intact level below their ideal height at that time."""
    drift_m: float | None = None
    """Greatest horizontal distance [m] of a brick from its release position when the highest level was last seen
    intact."""
    creep_m_s: float | None = None
    """Creep [m/s]: slope of the centre's position over the last half of the watch, of the brick that is fastest for its
    thickness; null if the stack did not stand through it, and for trials from before format 3."""
    frame_ms_p50: float | None = None
    """Median time [ms] of a frame: engine, read-back, core and port calls, without the bridge to an engine in a process
    of its own. The first five frames are left out."""
    frame_ms_p95: float | None = None
    """95th percentile of the time [ms] of a frame."""
    frame_ms_p99: float | None = None
    """99th percentile of the time [ms] of a frame."""
    frame_ms_max: float | None = None
    """Longest time [ms] of a frame."""
    engine_ms: float | None = None
    """Mean time [ms] per frame of the engine's step; for an engine in a separate process by that process's clock."""
    readback_ms: float | None = None
    """Mean time [ms] per frame in which the port reads contacts and masses; null without an extension."""
    core_ms: float | None = None
    """Mean time [ms] per frame of the stability core itself; null without an extension."""
    port_ms: float | None = None
    """Mean time [ms] per frame in which the port freezes and unfreezes bodies; null without an extension."""
    frame_ratio: float | None = None
    """Frame time with the extension over the frame time without it, on the same standing stack."""
    wakes: int | None = None
    """Number of times that the core unfroze a body; null without an extension."""
    refreezes: int | None = None
    """Number of times that the core froze a body that it had frozen before; null without an extension."""
    longest_live_s: float | None = None
    """Longest simulated time [s] that one body stayed live; null without an extension."""
    realtime_factor: float | None = None
    """Simulated over measured time of all timed frames; below 1 is slower than real time."""
    pose_hash: str | None = None
    """BLAKE2b over every frame's float64 poses, in hexadecimal."""
    expectation: Expectation
    """The outcome that theory demands."""
    verdict: Verdict
    """Comparison of the outcome with theory: ``creeps`` if it had to stand and did, but a brick certainly crept
    faster than the limit, ``undecided`` if the time limit stopped the trial, ``none`` where theory is silent or the
    engine cannot play the scene, ``failed`` if it sank, diverged or crashed."""
    environment: str
    """Digest of the environment.json of the run."""
    collapse_kind: CollapseKind | None = None
    """Kind of the collapse: sink only if nothing toppled, slid or dropped within a second of it."""
    collapse_s: float | None = None
    """Simulated time [s] at which the collapse was first seen."""
    frame_ratio_level: int | None = None
    """Level of the stack at which ``frame_ratio`` was measured."""
    frame_ratio_message: str = ""
    """Why there is no ``frame_ratio``, where it was requested."""
    levels_planned: int
    """Levels of the whole scene."""
    simulated_s: float = 0.0
    """Simulated time [s] when the trial ended."""
    wall_s: float | None = None
    """Wall time [s] of the trial, including untimed work."""
    timed_frames: int | None = None
    """Number of timed frames: those after the first five, up to a collapse."""
    calibration_ms: float | None = None
    """Median time [ms] of a fixed calculation just before and just after the frames; its spread over the trials of a
    run shows how steady the machine was."""
    core: int | None = None
    """The processor core that the trial was pinned to; null if it was not pinned."""
    pair: str = ""
    """Id shared by a scene that must stand and its partner that must fall; empty without a partner."""
    rest_s: float | None = None
    """Time [s] after the last action at which a brick of a poured pile was last seen moving; null if one still moved at
    the end, and for scenes without a pile."""
    repose_deg: float | None = None
    """Angle of repose [deg] of a poured pile: of the cone with the same median height and radius."""
    live_mean: float | None = None
    """Mean number of live bricks per frame; null without an extension, where it is unknown."""
    live_last: int | None = None
    """Number of live bricks in the last frame; null without an extension."""
    adopted: int | None = None
    """Number of bodies of prebuilt stacks that the core froze before the first step after they were set down; null
    without an extension, and for a scene without a prebuilt stack."""
    watch_s: float | None = None
    """Time [s] for which the trial watches after its last action."""
    creep_error_m_s: float | None = None
    """Half width [m/s] of the 95 % interval of ``creep_m_s``; frames are not assumed to be independent. A stack creeps
    if the whole interval lies above ``creep_limit_m_s``."""
    creep_limit_m_s: float | None = None
    """Creep limit [m/s] of the brick of ``creep_m_s``: by default 1 % of its thickness per minute."""
    creep_thickness_m: float | None = None
    """Thickness [m] of the brick of ``creep_m_s``."""
    sliding_m_s: float | None = None
    """Fastest horizontal creep [m/s] of any centre."""
    sinking_m_s: float | None = None
    """Fastest vertical creep [m/s] of any centre, downward or upward."""
    mean_motion_m_s: float | None = None
    """Of trials from before format 3, which called it creep: fastest mean motion [m/s] of a brick over the whole watch,
    in which a stack still settles; null since."""
    host: str | None = None
    """Name of the machine; timings of different machines are not comparable."""
    bridge_ms: float | None = None
    """Mean time [ms] per frame of the transfer to an engine in a separate process, and back; it is in no other time.
    Null for engines in the trial's process."""
    onset_deg: float | None = None
    """Slope [deg] of tilting ground at which a brick had moved by 1 % of its thickness or turned by half a degree; null
    if none did, and where no ground tilts."""
    own_limit_deg: float | None = None
    """Slope [deg] at which exact statics gives way with the points and normals of the engine's own contacts; null with
    an extension, and where no ground tilts."""
    ridge_deg: float | None = None
    """Greatest angle [deg] between the engine's normal where two leaning planks meet and the bisector; null where none
    was seen."""
    asleep_s: float | None = None
    """Simulated time [s] in which a brick that must move by theory kept its pose to the last bit; null where no brick
    must."""
    moved_after_s: float | None = None
    """Simulated time [s] in which the bricks that must move went as far as they must; null if one did not."""
    carried_share: float | None = None
    """Weight that the ground carries by the engine's contact forces, over that of all bricks: the mean of the frames in
    which the finished stack is watched; null where forces were not audited or are not reported."""
    cone_excess: float | None = None
    """By how much the friction at the worst contact exceeds mu times its normal force, in mean weights of a brick: the
    mean of those frames; null as before."""
    complementarity: float | None = None
    """Natural residual of the worst contact, the lesser of its force in mean weights of a brick and its gap in
    thicknesses, or its overlap: the mean of those frames; null as before, or without separations."""

    memory_mib: float | None = None
    """Memory [MiB] by which the peak of the process's resident memory while the scene was played exceeded its size just
    before the engine was opened: of the engine, of the extension and of what the harness records, and the pages of
    programs used for the first time; of a trial that compiles a kernel also the compiler. Each trial has a process of
    its own. Null where the system does not show it, and for engines in a separate process."""
    solver_iterations: float | None = None
    """Mean number of iterations of the engine's solver in the last step of a frame, of the island that took most; null
    where the engine does not report them. Frames as in ``frame_ms_p50``."""
    core_instructions: float | None = None
    """Mean number of instructions per frame of the core in user code, without port calls; null without an extension,
    and where the system does not count them. Frames as in ``frame_ms_p50``."""

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
        """True if the outcome counts as right or wrong."""
        return self.verdict not in NOT_JUDGED

    @field_validator("message", "frame_ratio_message", mode="before")
    @classmethod
    def _without_escapes(cls, text: object) -> object:
        """Remove the terminal escapes in the text that engines print and raise."""
        return plain_text(text) if isinstance(text, str) else text


class RecordWriter:
    """Appends records to a file, each flushed to disk before the next trial starts."""

    def __init__(self, path: Path) -> None:
        """Open ``path`` for appending, after removing a last line that was torn by an interruption."""
        self.torn = _mend(path)
        """True if there was a torn line."""
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
    """Return all records of a file, in its order.

    Raises:
        RecordError: if the file is missing or holds a line that is not a record of this format.

    Warns:
        RecordWarning: if the last line was torn by an interruption; it is left out.
    """
    try:
        return list(_records(path))
    except FileNotFoundError as error:
        raise RecordError(
            f"{path}: cannot be read (no such file): name a results folder, as written by 'bench run'"
        ) from error
    except OSError as error:
        raise RecordError(f"{path}: cannot be read ({error.strerror})") from error


def _records(path: Path) -> Iterator[TrialRecord]:
    with path.open("rb") as lines:
        for number, raw in enumerate(lines, start=1):
            if not raw.strip():
                continue
            if _is_torn(raw):
                warnings.warn(f"{path}:{number}: the last line is torn and was left out", RecordWarning, stacklevel=4)
                return
            try:
                yield TrialRecord.model_validate_json(raw)
            except ValidationError as error:
                raise RecordError(f"{path}:{number}: {_reason(error)}") from error


def _is_torn(raw: bytes) -> bool:
    """Return whether a line without a line break is incomplete; a line that lost only its line break is complete."""
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
        return f"not a line of JSON ({first['msg']})"
    if field == "format":
        if isinstance(first["input"], int) and first["input"] > FORMAT:
            return f"a record of format {first['input']}, newer than this suite's {FORMAT}: update the suite"
        return f"not a record of format {FORMAT} ({first['msg']}, got {first['input']!r})"
    return f"not a trial record: field '{field}': {first['msg']}"


def _mend(path: Path) -> bool:
    """Remove a torn last line, so that appended records start on a new line; return True if there was one."""
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
