"""Recorded poses of every brick in every frame, compact: a row only where something changed.

A row gives a brick's pose from its frame until the brick's next row. Poses are kept to 0.01 mm and 1e-4 of a
quaternion; a motion within the dead band (0.05 mm, some 0.05 degrees) counts as rest. Rows are sorted by brick, then by
frame, and columns are stored as differences: a standing stack of 100 planks takes about 0.1 MB.
"""

from __future__ import annotations

import json
from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pyarrow.parquet as pq

from reports.records.atomic import write_atomic
from scenarios.model import Brick, Vector

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int32]

LENGTH_STEP = 1e-5
"""Resolution of positions [m]: a thousandth of a plank's thickness cannot be seen."""
QUATERNION_STEP = 1e-4
"""Resolution of the components of quaternions: it turns a plank's end by 0.01 mm."""
MOST_BYTES = 1_000_000
"""Size above which a recording keeps only every third frame, and every change of state [bytes]."""
THINNED = 3
LENGTH_BAND = 5e-5
_QUATERNION_BAND = 4e-4
"""Dead bands [m] and [1], which drop the trembling of a solver. The second moves a plank's end by 0.05 mm."""
FIXED_FIELDS = ("size", "position", "quaternion")
"""Fields of a fixed box that a recording keeps."""
_COLUMNS = ("body", "frame", "x", "y", "z", "qw", "qx", "qy", "qz", "state")
STATES: tuple[Literal["live", "frozen", "removed"], ...] = ("live", "frozen", "removed")
LIVE, FROZEN, REMOVED = range(3)


class RecordingError(ValueError):
    """A recording that cannot be read; the message names the file."""


@dataclass(frozen=True, slots=True)
class Recording:
    """A trial's poses. Row i is the same in every column; rows are sorted by body, then by frame."""

    frame_s: float
    """Simulated time [s] of a frame."""
    frames: int
    """Number of frames of the trial."""
    sizes: Mapping[int, Vector]
    """Edge lengths [m] of each body."""
    body: IntArray
    """Bodies, shape (n,)."""
    frame: IntArray
    """First frame of each row, shape (n,)."""
    position: IntArray
    """Centres in steps of ``LENGTH_STEP``, shape (n, 3)."""
    quaternion: IntArray
    """Orientations (w, x, y, z) in steps of ``QUATERNION_STEP``, shape (n, 4); of the two signs, the one nearer to the
    previous row."""
    state: IntArray
    """Indices into ``STATES``, shape (n,)."""
    every: int = 1
    """1, or ``THINNED`` if the recording was too large and only every third frame is kept."""
    fixed: tuple[Brick, ...] = ()
    """Boxes that never move."""

    def thinned(self) -> Recording:
        """Return the recording with every third frame only, and every change of state and every body's first row."""
        new_state = np.ones(len(self.body), bool)
        new_state[1:] = (np.diff(self.body) != 0) | (np.diff(self.state) != 0)
        keep = new_state | (self.frame % THINNED == 0)
        names = ("body", "frame", "position", "quaternion", "state")
        return replace(self, **{name: getattr(self, name)[keep] for name in names}, every=THINNED)


class Recorder:
    """Takes the poses of every frame and keeps the changes."""

    def __init__(self, frame_s: float, fixed: tuple[Brick, ...] = ()) -> None:
        """Record frames of ``frame_s`` [s] in a world with ``fixed`` boxes."""
        self._frame_s = frame_s
        self._fixed = fixed
        self._frames = 0
        self._sizes: dict[int, Vector] = {}
        self._position = np.empty((0, 3))
        self._quaternion = np.empty((0, 4))
        self._state = np.empty(0, np.int32)
        self._rows: list[tuple[npt.NDArray[np.int64], int, FloatArray, FloatArray, IntArray]] = []
        self._latest: tuple[npt.NDArray[Any], ...] = ()
        self._frozen: set[int] = set()

    def see(
        self,
        bodies: npt.NDArray[np.int64],
        position: FloatArray,
        quaternion: FloatArray,
        frozen: Collection[int],
        bricks: Mapping[int, Brick],
    ) -> None:
        """Take one frame. The cost grows with the number of bodies, and is least while all of them are still.

        Args:
            bodies: ids of the bodies in the world, shape (n,); never reused.
            position: their centres [m], shape (n, 3).
            quaternion: their orientations (w, x, y, z), shape (n, 4).
            frozen: bodies that the core or the engine holds still.
            bricks: the brick of each body.
        """
        self._frames += 1
        latest = bodies, position, quaternion
        if self._latest and all(map(np.array_equal, latest, self._latest)) and self._frozen == set(frozen):
            return  # a stack at rest costs almost nothing, so that the engine finds its memory in the caches
        self._latest, self._frozen = tuple(array.copy() for array in latest), set(frozen)
        self._make_room(int(bodies.max(initial=-1)) + 1)
        self._sizes |= {body: bricks[body].size for body in bricks if body not in self._sizes}
        state = np.full(len(self._state), REMOVED, np.int32)
        state[bodies] = LIVE
        state[[body for body in frozen if body < len(state)]] = FROZEN
        quaternion = np.where((quaternion * self._quaternion[bodies]).sum(1)[:, None] < 0, -quaternion, quaternion)
        moved = state != self._state
        moved[bodies] |= (np.abs(position - self._position[bodies]) > LENGTH_BAND).any(1)
        moved[bodies] |= (np.abs(quaternion - self._quaternion[bodies]) > _QUATERNION_BAND).any(1)
        here = moved[bodies]
        self._position[bodies[here]], self._quaternion[bodies[here]] = position[here], quaternion[here]
        changed = np.flatnonzero(moved)
        if len(changed):
            poses = self._position[changed], self._quaternion[changed]
            self._rows.append((changed, self._frames - 1, *poses, state[changed]))
        self._state = state

    def finish(self) -> Recording:
        """Return the recording."""
        body = np.concatenate([rows[0] for rows in self._rows] or [np.empty(0, np.int64)])
        frame = np.concatenate([np.full(len(rows[0]), rows[1]) for rows in self._rows] or [np.empty(0, np.int64)])
        position = np.concatenate([rows[2] for rows in self._rows] or [np.empty((0, 3))])
        quaternion = np.concatenate([rows[3] for rows in self._rows] or [np.empty((0, 4))])
        state = np.concatenate([rows[4] for rows in self._rows] or [np.empty(0, np.int32)])
        order = np.lexsort((frame, body))
        return Recording(
            self._frame_s,
            self._frames,
            self._sizes,
            body[order].astype(np.int32),
            frame[order].astype(np.int32),
            np.rint(position[order] / LENGTH_STEP).astype(np.int32),
            np.rint(quaternion[order] / QUATERNION_STEP).astype(np.int32),
            state[order],
            fixed=self._fixed,
        )

    def _make_room(self, count: int) -> None:
        new = count - len(self._state)
        if new > 0:
            self._position = np.vstack([self._position, np.full((new, 3), np.inf)])  # the first pose is a change
            self._quaternion = np.vstack([self._quaternion, np.zeros((new, 4))])
            self._state = np.concatenate([self._state, np.full(new, REMOVED, np.int32)])


def write_recording(path: Path, recording: Recording) -> None:
    """Write a recording atomically; thin it if it is too large. The folder must exist."""
    content = _packed(recording)
    if len(content) > MOST_BYTES and recording.every == 1:
        content = _packed(recording.thinned())
    write_atomic(path, content)


def read_recording(path: Path) -> Recording:
    """Return the recording of a file.

    Raises:
        RecordingError: if it is missing, torn, or not a recording.
    """
    try:
        with pq.ParquetFile(path) as file:
            table = file.read()
        header: dict[str, Any] = json.loads((table.schema.metadata or {})[b"stillstack"])
        columns = {name: table[name].to_numpy().astype(np.int32) for name in _COLUMNS}
    except FileNotFoundError as error:
        raise RecordingError(f"{path}: no such recording; run the trial again to record it") from error
    except (OSError, KeyError, ValueError, pa.ArrowException) as error:
        raise RecordingError(f"{path}: not a recording, or a torn one ({error}); run the trial again") from error
    return Recording(
        header["frame_s"],
        header["frames"],
        {int(body): (size[0], size[1], size[2]) for body, size in header["sizes"].items()},
        columns["body"],
        columns["frame"],
        np.stack([columns[name] for name in "xyz"], axis=1),
        np.stack([columns[name] for name in ("qw", "qx", "qy", "qz")], axis=1),
        columns["state"],
        header["every"],
        tuple(_fixed_box(box) for box in header.get("fixed", ())),
    )


def _fixed_box(box: Mapping[str, Any]) -> Brick:
    (length, width, height), (x, y, z), (w, i, j, k) = (box[name] for name in FIXED_FIELDS)
    return Brick((length, width, height), 1.0, (x, y, z), (w, i, j, k))


def _packed(recording: Recording) -> bytes:
    values = [recording.body, recording.frame, *recording.position.T, *recording.quaternion.T, recording.state]
    header = {
        "frame_s": recording.frame_s,
        "frames": recording.frames,
        "sizes": recording.sizes,
        "every": recording.every,
        "fixed": [{name: getattr(box, name) for name in FIXED_FIELDS} for box in recording.fixed],
    }
    schema = pa.schema([pa.field(name, pa.int32()) for name in _COLUMNS], {"stillstack": json.dumps(header)})
    table = pa.Table.from_arrays([pa.array(value, pa.int32()) for value in values], schema=schema)
    sink = pa.BufferOutputStream()
    pq.write_table(
        table,
        sink,
        compression="zstd",
        compression_level=9,
        use_dictionary=False,
        column_encoding=dict.fromkeys(_COLUMNS, "DELTA_BINARY_PACKED"),
    )
    packed: bytes = sink.getvalue().to_pybytes()
    return packed
