"""The table of a trial's frames: its columns, their units, and its Parquet file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pyarrow.parquet as pq

from reports.records.atomic import atomic_file

UNTIMED_FRAMES = 5
"""Frames left out of every timing: in them the engine builds its caches, the first brick lands, and kernels for the
first contacts are compiled."""


class FrameRow(NamedTuple):
    """One frame. Columns are null in trials without an extension."""

    frame: int
    """Number of the frame, from 0. The first five are left out of a record's timings."""
    time_s: float
    """Simulated time at the end of the frame [s]."""
    level: int
    """The highest level of which a brick has been released."""
    bricks: int
    """Bodies in the world."""
    live: int
    """Bodies that are not frozen, after the frame."""
    engine_ms: float
    """Time of the engine's step [ms]."""
    frame_ms: float
    """Time of the whole frame [ms]: the engine's step, contacts, core and port calls, without the bridge."""
    contacts: int | None = None
    """Contact points read by the core."""
    readback_ms: float | None = None
    """Time of reading contacts and masses [ms]."""
    core_ms: float | None = None
    """Time of the core itself [ms]."""
    port_ms: float | None = None
    """Time of freezing and unfreezing bodies in the engine [ms]."""
    frozen: int | None = None
    """Bodies that the core froze in this frame."""
    woken: int | None = None
    """Bodies that the core unfroze in this frame."""
    woken_because: str | None = None
    """The core's reasons for unfreezing them, each with its count: "1 struck; 3 rested on what was struck"."""
    bridge_ms: float | None = None
    """Time [ms] of the transfer to an engine in a separate process, and back; null for engines in the trial's
    process."""
    solver_iterations: int | None = None
    """Iterations of the engine's solver in the frame's last step, of the island that took most; null where the engine
    does not report them."""
    core_instructions: int | None = None
    """Instructions of the core in user code, without port calls; null where they cannot be counted."""


_COUNT, _REAL = pa.int32(), pa.float64()
SCHEMA = pa.schema(
    [
        pa.field("frame", _COUNT, nullable=False),
        pa.field("time_s", _REAL, nullable=False),
        pa.field("level", _COUNT, nullable=False),
        pa.field("bricks", _COUNT, nullable=False),
        pa.field("live", _COUNT, nullable=False),
        pa.field("engine_ms", _REAL, nullable=False),
        pa.field("frame_ms", _REAL, nullable=False),
        pa.field("contacts", _COUNT),
        pa.field("readback_ms", _REAL),
        pa.field("core_ms", _REAL),
        pa.field("port_ms", _REAL),
        pa.field("frozen", _COUNT),
        pa.field("woken", _COUNT),
        pa.field("woken_because", pa.string()),
        pa.field("bridge_ms", _REAL),
        pa.field("solver_iterations", _COUNT),
        pa.field("core_instructions", pa.int64()),
    ]
)


def write_frames(path: Path, rows: Sequence[FrameRow]) -> None:
    """Write a trial's frames atomically; the folder must exist."""
    columns = list(zip(*rows, strict=True)) if rows else [()] * len(FrameRow._fields)
    arrays = [pa.array(values, field.type) for values, field in zip(columns, SCHEMA, strict=True)]
    with atomic_file(path) as draft:
        pq.write_table(pa.Table.from_arrays(arrays, schema=SCHEMA), draft)


def read_columns(path: Path, names: Sequence[str]) -> dict[str, npt.NDArray[np.float64]]:
    """Return some numeric columns of a trial's frames, each of shape (frames,); null is nan.

    Raises:
        OSError: if the file is missing.
        pyarrow.ArrowException: if it is not such a table, or is torn.
    """
    with pq.ParquetFile(path) as file:  # 30 times faster than pyarrow's readers of whole data sets
        table = file.read(list(names))
    return {name: table[name].to_numpy().astype(np.float64) for name in names}


def read_frames(path: Path) -> list[FrameRow]:
    """Return a trial's frames, in order."""
    columns = pq.read_table(path, schema=SCHEMA).to_pydict()
    return [FrameRow(*values) for values in zip(*(columns[name] for name in FrameRow._fields), strict=True)]
