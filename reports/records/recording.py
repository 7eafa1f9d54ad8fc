"""The recording of a trial: the pose of every brick in every frame, with a row only for each change.

A row gives the pose of a brick from the row's frame until the brick's next row. The resolution is 0.01 mm for positions
and 1e-4 for components of quaternions. A motion within the dead band (0.05 mm, about 0.05 degrees) counts as rest. The
file sorts rows by brick, then by frame. The file stores columns as differences, so that a standing stack of 100 planks
takes about 0.1 MB.
"""

from __future__ import annotations

import json
import math
from collections.abc import Collection, Mapping
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pyarrow.parquet as pq

from reports.records.atomic import write_atomic
from reports.records.body_fields import fixed_body, fixed_fields, read_shape, shape_field
from scenarios.model import Brick, Vector, World
from scenarios.shapes import Shape

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int32]

LENGTH_STEP = 1e-5
"""Resolution of positions [m], about a thousandth of a plank's thickness, because a viewer of a replay cannot see
smaller motions."""
QUATERNION_STEP = 1e-4
"""Resolution of the components of quaternions, chosen so that one step moves a plank's end by about 0.01 mm."""
MOST_BYTES = 1_000_000
"""Size above which the writer thins a recording [bytes]."""
THINNED = 3
"""Interval of the frames that a thinned recording keeps."""
LENGTH_BAND = 5e-5
"""Dead band of each coordinate of a position [m], which suppresses the vibration of a solver."""
_QUATERNION_BAND = 4e-4
"""Dead band of each component of a quaternion, chosen so that a change by the dead band moves a plank's end by about
0.05 mm."""
_COLUMNS = ("body", "frame", "x", "y", "z", "qw", "qx", "qy", "qz", "state")
STATES: tuple[Literal["live", "frozen", "removed"], ...] = ("live", "frozen", "removed")
"""Names of the states of a body."""
LIVE, FROZEN, REMOVED = range(3)
"""Index of each state in ``STATES``."""
WORLD = World()
"""Default world of a recorder."""


_TURN = 1e-3
"""Least relative change of the gravity vector with which a recording keeps the new gravity. The change is the length of
the difference over the length of the new vector: 0.001 for a turn of gravity by 0.06 deg."""


@dataclass(frozen=True, slots=True)
class Physics:
    """Friction, masses and gravity of a trial: the data that statics needs in addition to the poses."""

    friction: float
    """Friction coefficient of Coulomb's law, equal for all contacts."""
    masses: Mapping[int, float]
    """Mass of each body [kg], by its id; without bodies that only the host moves."""
    gravity: tuple[tuple[int, Vector], ...]
    """Changes of gravity in order of time, at least one: the first frame, and the vector from this frame on [m/s2],
    world frame."""

    def gravity_at(self, frame: int) -> Vector:
        """Return the gravity vector in a frame [m/s2], world frame."""
        return next((gravity for since, gravity in reversed(self.gravity) if since <= frame), self.gravity[0][1])


class RecordingError(ValueError):
    """An unreadable recording; the message names the file and the fix."""


@dataclass(frozen=True, slots=True)
class Recording:
    """The poses of a trial as columns of n rows, sorted by body, then by frame."""

    frame_s: float
    """Simulated time of a frame [s]."""
    frames: int
    """Number of frames of the trial."""
    sizes: Mapping[int, Vector]
    """Edge lengths of each body [m], by its id."""
    body: IntArray
    """Id of the body, shape (n,)."""
    frame: IntArray
    """First frame in which the row holds, shape (n,)."""
    position: IntArray
    """Centre of the body in steps of ``LENGTH_STEP``, shape (n, 3), world frame."""
    quaternion: IntArray
    """Orientation (w, x, y, z) in steps of ``QUATERNION_STEP``, shape (n, 4), world frame. Of the two signs of a
    quaternion, a row has the sign that is nearer to the body's previous row."""
    state: IntArray
    """Index into ``STATES``, shape (n,)."""
    every: int = 1
    """Interval of the kept frames: 1, or ``THINNED`` for a thinned recording."""
    fixed: tuple[Brick, ...] = ()
    """Bodies that never move."""
    physics: Physics | None = None
    """Masses, friction and gravity; None in recordings of version 0.1.0."""
    shapes: Mapping[int, Shape] = field(default_factory=dict)
    """Shape of each body that is not a box, by its id."""

    def shape(self, body: int) -> Shape:
        """Return the shape of a body from its id."""
        return self.shapes.get(body, "box")

    def thinned(self) -> Recording:
        """Return a smaller recording.

        The recording keeps the rows in every third frame, all changes of state, and the first row of each body.
        """
        new_state = np.ones(len(self.body), bool)
        new_state[1:] = (np.diff(self.body) != 0) | (np.diff(self.state) != 0)
        keep = new_state | (self.frame % THINNED == 0)
        names = ("body", "frame", "position", "quaternion", "state")
        return replace(self, **{name: getattr(self, name)[keep] for name in names}, every=THINNED)


class Recorder:
    """Recorder that receives the poses of every frame, and stores only changes."""

    def __init__(self, frame_s: float, world: World = WORLD) -> None:
        """Start a recording without frames.

        Args:
            frame_s: simulated time of a frame [s].
            world: friction, gravity at the start [m/s2], and the bodies that never move.
        """
        self._frame_s = frame_s
        self._world = world
        self._gravity = [(0, world.gravity)]
        self._masses: dict[int, float] = {}
        self._frames = 0
        self._sizes: dict[int, Vector] = {}
        self._shapes: dict[int, Shape] = {}
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
        gravity: Vector | None = None,
    ) -> None:
        """Record one frame; the cost grows with the number of bodies, and is least if no body moves.

        Args:
            bodies: ids of the n bodies in the world, shape (n,); two bodies never share an id.
            position: centres of the bodies [m], shape (n, 3), world frame.
            quaternion: orientations of the bodies (w, x, y, z), shape (n, 4), world frame.
            frozen: ids of the bodies that the core or the engine has frozen.
            bricks: brick of each body in the world, by id.
            gravity: gravity in this frame [m/s2], shape (3,), world frame; None for unchanged gravity.
        """
        self._frames += 1
        if gravity is not None and math.dist(gravity, self._gravity[-1][1]) > _TURN * math.hypot(*gravity):
            self._gravity.append((self._frames - 1, gravity))
        latest = bodies, position, quaternion
        if self._latest and all(map(np.array_equal, latest, self._latest)) and self._frozen == set(frozen):
            return  # little work for a stack at rest, so that the engine's memory stays in the caches
        self._latest, self._frozen = tuple(array.copy() for array in latest), set(frozen)
        self._make_room(int(bodies.max(initial=-1)) + 1)
        new = [body for body in bricks if body not in self._sizes]
        self._sizes |= {body: bricks[body].size for body in new}
        self._shapes |= {body: bricks[body].shape for body in new if bricks[body].shape != "box"}
        self._masses |= {body: bricks[body].mass for body in new if not bricks[body].moved}
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
        """Return the recording of all frames so far."""
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
            fixed=self._world.fixed,
            physics=Physics(self._world.friction, self._masses, tuple(self._gravity)),
            shapes=self._shapes,
        )

    def _make_room(self, count: int) -> None:
        new = count - len(self._state)
        if new > 0:
            self._position = np.vstack(
                [self._position, np.full((new, 3), np.inf)]
            )  # so that the first pose counts as a change
            self._quaternion = np.vstack([self._quaternion, np.zeros((new, 4))])
            self._state = np.concatenate([self._state, np.full(new, REMOVED, np.int32)])


def write_recording(path: Path, recording: Recording) -> None:
    """Write a recording atomically, and thin a recording whose file would exceed ``MOST_BYTES``.

    The folder must exist. A thinned recording is not thinned again.
    """
    content = _packed(recording)
    if len(content) > MOST_BYTES and recording.every == 1:
        content = _packed(recording.thinned())
    write_atomic(path, content)


def read_recording(path: Path) -> Recording:
    """Return the recording in a file.

    Raises:
        RecordingError: if the file is missing, incomplete, or not a recording.
    """
    try:
        with pq.ParquetFile(path) as file:
            table = file.read()
        header: dict[str, Any] = json.loads((table.schema.metadata or {})[b"stillstack"])
        columns = {name: table[name].to_numpy().astype(np.int32) for name in _COLUMNS}
    except FileNotFoundError as error:
        raise RecordingError(
            f"{path}: this recording does not exist; run the trial again to record its poses"
        ) from error
    except (OSError, KeyError, ValueError, pa.ArrowException) as error:
        raise RecordingError(f"{path}: not a complete recording ({error}); run the trial again") from error
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
        tuple(fixed_body(box) for box in header.get("fixed", ())),
        _physics(header["physics"]) if header.get("physics") else None,
        {int(body): read_shape(said) for body, said in header.get("shapes", {}).items()},
    )


def _physics(header: Mapping[str, Any]) -> Physics:
    masses = {int(body): mass for body, mass in header["masses"].items()}
    return Physics(header["friction"], masses, tuple((since, (x, y, z)) for since, (x, y, z) in header["gravity"]))


def _packed(recording: Recording) -> bytes:
    values = [recording.body, recording.frame, *recording.position.T, *recording.quaternion.T, recording.state]
    header = {
        "frame_s": recording.frame_s,
        "frames": recording.frames,
        "sizes": recording.sizes,
        "every": recording.every,
        "fixed": [fixed_fields(body) for body in recording.fixed],
        "physics": None if recording.physics is None else asdict(recording.physics),
    }
    if recording.shapes:
        header["shapes"] = {body: shape_field(shape) for body, shape in recording.shapes.items()}
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
