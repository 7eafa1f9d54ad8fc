"""The pose trace of a trial: every change of a pose, to the last bit, to find where two trials begin to differ.

A recording (``recording``) rounds poses, because viewers cannot see small motions. A trace is exact and large, and
therefore ends with the frame that completes ``MOST_ROWS`` changes.
"""

from __future__ import annotations

import base64
import binascii
import zlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pyarrow.parquet as pq

from reports.records.atomic import write_atomic

FloatArray = npt.NDArray[np.float64]

MOST_ROWS = 6000
"""Number of rows after which a trace ends: 0.25 MB in a file, 16 kB in a baseline file. Twelve awake bricks reach this
number in 8 s at 60 frames per second."""
_POSE = ("x", "y", "z", "qw", "qx", "qy", "qz")
_ROW = np.dtype([("body", "<i4"), ("step", "<i4"), ("digest", "<u2")])
"""A row of a packed trace; ``step`` is the difference to the frame of the row before."""
_FRAMES_BYTES = 4
"""Size of the number of frames, at the start of a packed trace [bytes]."""
_MOST_UNPACKED = _FRAMES_BYTES + 2 * MOST_ROWS * _ROW.itemsize
"""Greatest size of an unpacked trace [bytes], so that a small malicious text cannot fill the memory. The limit allows
``2 * MOST_ROWS`` rows, because the last frame of a trace is complete."""
_FACTORS = np.array([0x9E3779B97F4A7C15 * (2 * k + 1) % 2**64 for k in range(len(_POSE))], np.uint64)
"""Odd factors of ``_digests``, one for each component of a pose."""
_MIXER = np.uint64(0xD6E8FEB86659FD93)


class PoseTraceError(ValueError):
    """An unreadable trace; the message names the fix and, except for a packed trace, the file."""


@dataclass(frozen=True, slots=True)
class PoseTrace:
    """Changes of poses in the first frames of a trial, as n rows in order of frame, then body.

    A row of NaN means that the body left the world.
    """

    frames: int
    """Number of frames that the trace covers, counted from frame 0."""
    frame: npt.NDArray[np.int32]
    """Frame of the change, shape (n,)."""
    body: npt.NDArray[np.int32]
    """Id of the body, shape (n,)."""
    digest: npt.NDArray[np.uint16]
    """Digest of the new pose, shape (n,). Two different poses have equal digests with a probability of 1 in 65,536."""
    pose: FloatArray | None = None
    """New pose (x, y, z [m], qw, qx, qy, qz), shape (n, 7), world frame; None in a trace of a baseline file."""

    def packed(self) -> str:
        """Return the trace without its poses as text, for a baseline file."""
        rows = np.empty(len(self.frame), _ROW)
        order = np.lexsort((self.frame, self.body))  # a still body's rows are equal, so that they need no room
        rows["body"], rows["digest"] = self.body[order], self.digest[order]
        rows["step"] = np.diff(self.frame[order], prepend=0)
        columns = b"".join(rows[name].tobytes() for name in _ROW.names or ())
        return base64.b64encode(zlib.compress(self.frames.to_bytes(_FRAMES_BYTES, "little") + columns, 9)).decode()


@dataclass(frozen=True, slots=True)
class Parting:
    """The first frame in which two trials differ, and the first body that differs in this frame."""

    frame: int
    """Number of the frame, from 0."""
    body: int
    """Least id of a body that differs."""
    bodies: int
    """Number of bodies that differ in this frame."""
    poses: tuple[FloatArray | None, FloatArray | None]
    """Pose of the body in this frame in both trials, shape (7,); None where the trace has no poses."""


class PoseTracer:
    """Recorder of a pose trace, frame by frame."""

    def __init__(self) -> None:
        """Start a trace without frames."""
        self._frames = 0
        self._count = 0
        self._latest = np.empty((0, len(_POSE)))
        self._rows: list[tuple[npt.NDArray[np.int32], npt.NDArray[np.int32], FloatArray]] = []

    def see(self, bodies: npt.NDArray[np.int64], position: FloatArray, quaternion: FloatArray) -> None:
        """Record one frame, unless the trace has ended.

        Args:
            bodies: ids of the n bodies in the world, shape (n,); two bodies never share an id.
            position: centres of the bodies [m], shape (n, 3), world frame.
            quaternion: orientations of the bodies (w, x, y, z), shape (n, 4), world frame.
        """
        if self._count >= MOST_ROWS:
            return
        now = np.full((max(len(self._latest), int(bodies.max(initial=-1)) + 1), len(_POSE)), np.nan)
        now[bodies] = np.hstack([position, quaternion])
        before = np.full_like(now, np.nan)
        before[: len(self._latest)] = self._latest
        changed = np.flatnonzero((now.view(np.uint64) != before.view(np.uint64)).any(axis=1))
        if len(changed):
            frame = np.full(len(changed), self._frames, np.int32)
            self._rows.append((frame, changed.astype(np.int32), now[changed]))
            self._count += len(changed)
        self._latest = now
        self._frames += 1

    def finish(self) -> PoseTrace:
        """Return the trace of all frames so far."""
        frame = np.concatenate([np.empty(0, np.int32), *(frame for frame, _, _ in self._rows)])
        body = np.concatenate([np.empty(0, np.int32), *(body for _, body, _ in self._rows)])
        pose = np.concatenate([np.empty((0, len(_POSE))), *(pose for _, _, pose in self._rows)])
        return PoseTrace(self._frames, frame, body, _digests(pose), pose)


def parting(base: PoseTrace, head: PoseTrace) -> Parting | None:
    """Return the first difference of two traces by frame, body and digest.

    The result is None if the traces agree in all frames that both cover.
    """
    covered = min(base.frames, head.frames)
    before, now = _keys(base, covered), _keys(head, covered)
    different = np.setxor1d(before, now, assume_unique=True)
    if not len(different):
        return None
    frames, bodies = different["frame"], different["body"]
    first = int(frames.min())
    apart = np.unique(bodies[frames == first])
    poses = _pose_at(base, int(apart[0]), first), _pose_at(head, int(apart[0]), first)
    return Parting(first, int(apart[0]), len(apart), poses)


def unpacked(text: str) -> PoseTrace:
    """Return the trace from a text that ``PoseTrace.packed`` returned.

    Raises:
        PoseTraceError: if the text is not a packed trace.
    """
    try:
        stream = zlib.decompressobj()
        content = stream.decompress(base64.b64decode(text, validate=True), _MOST_UNPACKED)
    except (binascii.Error, ValueError, zlib.error) as error:
        raise PoseTraceError(
            f"a text in the baseline file is not a packed trace ({error}): restore the file"
        ) from error
    count, rest = divmod(len(content) - _FRAMES_BYTES, _ROW.itemsize)
    if not stream.eof or count < 0 or rest:
        raise PoseTraceError(
            "a text in the baseline file is not a packed trace (incomplete, or too long): restore the file"
        )
    columns, start = {}, _FRAMES_BYTES
    for name in _ROW.names or ():
        columns[name] = np.frombuffer(content, _ROW[name], count, start)
        start += columns[name].nbytes
    frame = np.cumsum(columns["step"])
    order = np.lexsort((columns["body"], frame))
    return PoseTrace(
        int.from_bytes(content[:_FRAMES_BYTES], "little"),
        frame[order].astype(np.int32),
        columns["body"][order],
        columns["digest"][order],
    )


def write_pose_trace(path: Path, trace: PoseTrace) -> None:
    """Write a trace with its poses atomically; the folder must exist."""
    assert trace.pose is not None
    arrays = [pa.array(trace.frame), pa.array(trace.body), *map(pa.array, trace.pose.T.copy())]
    schema = pa.schema(
        [("frame", pa.int32()), ("body", pa.int32()), *((name, pa.float64()) for name in _POSE)],
        {"frames": str(trace.frames)},
    )
    sink = pa.BufferOutputStream()
    pq.write_table(
        pa.Table.from_arrays(arrays, schema=schema),
        sink,
        compression="zstd",
        use_dictionary=False,
        column_encoding={"frame": "DELTA_BINARY_PACKED", "body": "DELTA_BINARY_PACKED"}
        | dict.fromkeys(_POSE, "BYTE_STREAM_SPLIT"),
    )
    write_atomic(path, sink.getvalue().to_pybytes())


def read_pose_trace(path: Path) -> PoseTrace:
    """Return the trace in a file.

    Raises:
        PoseTraceError: if the file is missing, incomplete, or not a trace.
    """
    try:
        with pq.ParquetFile(path) as file:
            table = file.read()
        frames = int((table.schema.metadata or {})[b"frames"])
        pose = np.stack([table[name].to_numpy() for name in _POSE], axis=1)
        frame, body = (table[name].to_numpy().astype(np.int32) for name in ("frame", "body"))
        return PoseTrace(frames, frame, body, _digests(pose), pose)
    except (OSError, KeyError, ValueError, pa.ArrowException) as error:
        raise PoseTraceError(f"{path}: not a complete pose trace ({error}); run the trial again") from error


def _digests(pose: FloatArray) -> npt.NDArray[np.uint16]:
    """Return a digest of the bits of each pose, shape (n,)."""
    mixed = (np.ascontiguousarray(pose).view(np.uint64) * _FACTORS).sum(axis=1)
    digests: npt.NDArray[np.uint16] = ((mixed ^ mixed >> np.uint64(32)) * _MIXER >> np.uint64(48)).astype(np.uint16)
    return digests


def _keys(trace: PoseTrace, covered: int) -> npt.NDArray[np.void]:
    """Return a key of each row in the first ``covered`` frames: frame, body and digest."""
    keys = np.empty(len(trace.frame), [("frame", np.int32), ("body", np.int32), ("digest", np.uint16)])
    keys["frame"], keys["body"], keys["digest"] = trace.frame, trace.body, trace.digest
    return keys[trace.frame < covered]


def _pose_at(trace: PoseTrace, body: int, frame: int) -> FloatArray | None:
    """Return the pose of a body in a frame, shape (7,): NaN if the body is absent; None if the trace has no poses."""
    if trace.pose is None:
        return None
    rows = np.flatnonzero((trace.body == body) & (trace.frame <= frame))
    return trace.pose[rows[-1]] if len(rows) else np.full(len(_POSE), np.nan)
