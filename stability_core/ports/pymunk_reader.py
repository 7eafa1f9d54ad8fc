"""Reader of Chipmunk's bodies and contacts in batch arrays, for the port and for the suite's adapter.

Each body has a row in the arrays. In the suite the row of a body is its id. The ground has the last row, -1, and the
fixed boxes have the rows before the last row, so that negative ids select these rows. In the port, row k belongs to
body k of a list (see ``SpaceReader.assign``).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numba
import numpy as np
import pymunk
from pymunk import batch

from stability_core.port import FloatArray, IntArray

_ARBITER = (
    batch.ArbiterFields.BODY_A_ID
    | batch.ArbiterFields.BODY_B_ID
    | batch.ArbiterFields.NORMAL
    | batch.ArbiterFields.CONTACT_COUNT
    | batch.ArbiterFields.POINT_A_1
    | batch.ArbiterFields.POINT_B_1
    | batch.ArbiterFields.DISTANCE_1
    | batch.ArbiterFields.POINT_A_2
    | batch.ArbiterFields.POINT_B_2
    | batch.ArbiterFields.DISTANCE_2
)
_STATE = (
    batch.BodyFields.BODY_ID
    | batch.BodyFields.POSITION
    | batch.BodyFields.ANGLE
    | batch.BodyFields.VELOCITY
    | batch.BodyFields.ANGULAR_VELOCITY
)

Arbiters = tuple[IntArray, FloatArray]
"""Two arrays of m pairs, in engine units:

- engine ids of a and b, and the number of points, shape (m, 3);
- normal (2 columns), then for each of two points the point on a (2), the point on b (2) and the distance (1), shape
  (m, 12).
"""


class SpaceReader:
    """Reader of one space of Chipmunk. The reader keeps the latest state until the caller notes a change."""

    def __init__(self, space: pymunk.Space, fixed_rows: int = 0) -> None:
        self._space = space
        self._buffer = batch.Buffer()
        self._latest: FloatArray | None = None
        self._raw = b""  # the buffer of the latest call of ``has_changed``
        self.rows = fixed_rows
        """Number of rows. In the suite: one for each body id so far, one for the ground, and one for each fixed box."""
        self.engine_ids = np.empty(0, np.int64)
        """The engine's id of every body, sorted. These ids are memory addresses."""
        self.ids = np.empty(0, np.int64)
        """The row of every body, in the order of ``engine_ids``."""
        self._fixed_rows = fixed_rows

    def add(self, planar: pymunk.Body, body: int) -> None:
        """Register a new body of the suite under its id ``body``."""
        rank = np.searchsorted(self.engine_ids, planar.id)
        self.engine_ids = np.insert(self.engine_ids, rank, planar.id)
        self.ids = np.insert(self.ids, rank, body)
        self.rows = max(self.rows, body + 1 + self._fixed_rows)
        self._latest = None

    def assign(self, planars: Sequence[pymunk.Body]) -> None:
        """Register ``planars``, all bodies of the space, under the rows 0, 1, and so on."""
        engine_ids = np.array([planar.id for planar in planars], np.int64)
        self.ids = np.argsort(engine_ids)
        self.engine_ids = engine_ids[self.ids]
        self.rows = len(planars)
        self._latest = None

    def remove(self, body: int) -> None:
        """Delete the record of a removed body."""
        stays = self.ids != body
        self.engine_ids, self.ids = self.engine_ids[stays], self.ids[stays]
        self._latest = None

    def note_change(self) -> None:
        """Mark the latest state as outdated, after a change of a pose or a velocity."""
        self._latest = None

    def has_changed(self) -> bool:
        """Return True if a pose or a velocity has changed since the previous call; True in a first call with bodies."""
        self._fill_with_state()
        raw, self._raw = self._raw, bytes(self._buffer.float_buf())
        return raw != self._raw

    def state(self) -> FloatArray:
        """Return position (x, z), angle, velocity (x, z) and spin of every body in engine units, shape (rows, 6).

        The method reads the engine only after a call of ``add``, ``assign``, ``remove`` or ``note_change``. Rows
        without a body of the engine are zero.
        """
        if self._latest is None:
            self._fill_with_state()
            bodies, values = self._buffered(1, 6)
            self._latest = np.zeros((self.rows, 6))
            _sort_by_id(self.engine_ids, self.ids, bodies[:, 0], values, self._latest)
        return self._latest

    def arbiters(self) -> Arbiters:
        """Return the contacts of the latest step, as views that are valid until the reader next reads the engine."""
        self._buffer.clear()
        batch.get_space_arbiters(self._space, _ARBITER, self._buffer)
        return self._buffered(3, 12)

    def query(self, bodies: Iterable[pymunk.Body]) -> Arbiters:
        """Return the contacts of ``bodies`` with overlapping shapes, without duplicate pairs; create no arbiters.

        Sensors have no contacts. The result includes pairs that a step omits, such as a kinematic and a static body.
        """
        arbiters: list[tuple[int, int, int]] = []
        numbers: list[list[float]] = []
        asked: set[pymunk.Shape] = set()
        for planar in bodies:
            for shape in planar.shapes:
                asked.add(shape)
                for found in self._space.shape_query(shape):
                    other = found.shape
                    if other is None or other.body is None or other in asked or other.sensor:
                        continue
                    touch = found.contact_point_set
                    arbiters.append((planar.id, other.body.id, len(touch.points)))
                    points = [(*point.point_a, *point.point_b, point.distance) for point in touch.points]
                    numbers.append(numbers_of(touch.normal, points))
        return arbiters_of(arbiters, numbers)

    def _fill_with_state(self) -> None:
        self._buffer.clear()
        batch.get_space_bodies(self._space, _STATE, self._buffer)

    def _buffered(self, integers: int, floats: int) -> Arbiters:
        """Return the buffer's contents as views with the given numbers of integers and floats per row.

        The views are valid until the next call that fills the buffer.
        """
        return (
            np.frombuffer(self._buffer.int_buf(), np.int64).reshape(-1, integers),
            np.frombuffer(self._buffer.float_buf()).reshape(-1, floats),
        )


def numbers_of(normal: Sequence[float], points: Sequence[Sequence[float]]) -> list[float]:
    """Return the 12 numbers of an arbiter: see ``Arbiters``."""
    row = [*normal]
    for point in points:
        row += point
    return row + [0.0] * (12 - len(row))


def arbiters_of(arbiters: Sequence[tuple[int, int, int]], numbers: Sequence[Sequence[float]]) -> Arbiters:
    """Return m pairs as arrays: see ``Arbiters``."""
    return np.array(arbiters, np.int64).reshape(-1, 3), np.array(numbers, np.float64).reshape(-1, 12)


def at_centers(state: FloatArray, centers: FloatArray) -> FloatArray:
    """Return states (n, 6) of bodies with the positions of their centres of gravity.

    Args:
        state: states with the positions of the bodies' origins, with the columns of ``SpaceReader.state``.
        centers: centres of gravity in the bodies' own coordinates, shape (n, 2).
    """
    if not centers.any():
        return state
    state = state.copy()
    cos, sin = np.cos(state[:, 2]), np.sin(state[:, 2])
    state[:, 0] += cos * centers[:, 0] - sin * centers[:, 1]
    state[:, 1] += sin * centers[:, 0] + cos * centers[:, 1]
    return state


@numba.njit(cache=True)
def _sort_by_id(engine_ids: IntArray, ids: IntArray, bodies: IntArray, values: FloatArray, rows: FloatArray) -> None:
    """Write ``values`` into the rows of the bodies.

    Args:
        engine_ids: the engine's ids of all bodies, sorted.
        ids: the row of each engine id; -1 selects the last row.
        bodies: engine id of each row of ``values``, shape (k,).
        values: numbers in the engine's order, shape (k, w).
        rows: output, shape (rows, w).
    """
    for k in range(len(bodies)):
        row = ids[np.searchsorted(engine_ids, bodies[k])]
        for column in range(values.shape[1]):  # an assignment of a whole row takes seconds to compile
            rows[row, column] = values[k, column]
