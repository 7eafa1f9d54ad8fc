"""Reads Chipmunk's bodies and contacts through its batch arrays, by our ids instead of its own.

Rows of arrays are our ids. The ground's row is the last, -1, and before it come those of the fixed boxes, so that their
negative ids find them.
"""

from __future__ import annotations

from collections.abc import Iterable

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
"""Engine ids of a and b and the number of points, shape (m, 3); normal, then for two points each the place on a, the
place on b and the distance, shape (m, 12)."""


class SpaceReader:
    """Reads one space."""

    def __init__(self, space: pymunk.Space, fixed_rows: int) -> None:
        self._space = space
        self._buffer = batch.Buffer()
        self._latest: FloatArray | None = None
        self.rows = fixed_rows
        """One a body id given out so far, and those of the ground and the fixed boxes."""
        self.engine_ids = np.empty(0, np.int64)
        """Of every body, sorted; they are addresses, in no order of their own."""
        self.ids = np.empty(0, np.int64)
        """Ours, in the order of the engine's."""
        self._fixed_rows = fixed_rows

    def add(self, planar: pymunk.Body, body: int) -> None:
        """Take notice of a new body that goes by the id ``body``."""
        rank = np.searchsorted(self.engine_ids, planar.id)
        self.engine_ids = np.insert(self.engine_ids, rank, planar.id)
        self.ids = np.insert(self.ids, rank, body)
        self.rows = max(self.rows, body + 1 + self._fixed_rows)
        self._latest = None

    def remove(self, body: int) -> None:
        """Take notice that a body was removed."""
        stays = self.ids != body
        self.engine_ids, self.ids = self.engine_ids[stays], self.ids[stays]
        self._latest = None

    def note_change(self) -> None:
        """Take notice that a body has moved, or has another velocity."""
        self._latest = None

    def state(self) -> FloatArray:
        """Return place (x, z), angle, velocity (x, z) and spin of every body in engine units, shape (rows, 6).

        Read once, until something changes.
        """
        if self._latest is None:
            self._buffer.clear()
            batch.get_space_bodies(self._space, _STATE, self._buffer)
            bodies, values = self._buffered(1, 6)
            self._latest = np.zeros((self.rows, 6))
            _sort_by_id(self.engine_ids, self.ids, bodies[:, 0], values, self._latest)
        return self._latest

    def arbiters(self) -> Arbiters:
        """Return the contacts of the latest step; views, until the buffer is filled again by ``state``."""
        self._buffer.clear()
        batch.get_space_arbiters(self._space, _ARBITER, self._buffer)
        return self._buffered(3, 12)

    def query(self, bodies: Iterable[pymunk.Body]) -> Arbiters:
        """Return what a step would find of the contacts of ``bodies``, each pair once, without its arbiters."""
        arbiters: list[tuple[int, int, int]] = []
        numbers: list[list[float]] = []
        asked: set[pymunk.Shape] = set()
        for planar in bodies:
            (shape,) = planar.shapes
            asked.add(shape)
            for found in self._space.shape_query(shape):
                other = found.shape
                if other is None or other.body is None or other in asked:
                    continue
                touch = found.contact_point_set
                arbiters.append((planar.id, other.body.id, len(touch.points)))
                row = [*touch.normal]
                for point in touch.points:
                    row += [*point.point_a, *point.point_b, point.distance]
                numbers.append(row + [0.0] * (12 - len(row)))
        return np.array(arbiters, np.int64).reshape(-1, 3), np.array(numbers, np.float64).reshape(-1, 12)

    def _buffered(self, integers: int, floats: int) -> Arbiters:
        """Return the buffer's contents, so many integers and floats a row; views, until the buffer is filled again."""
        return (
            np.frombuffer(self._buffer.int_buf(), np.int64).reshape(-1, integers),
            np.frombuffer(self._buffer.float_buf()).reshape(-1, floats),
        )


@numba.njit(cache=True)
def _sort_by_id(engine_ids: IntArray, ids: IntArray, bodies: IntArray, values: FloatArray, rows: FloatArray) -> None:
    """Write ``values`` (k, w) of ``bodies`` (k,), which are engine ids, into those ``rows`` that are our ids.

    Args:
        engine_ids: every engine id, sorted.
        ids: our id of each; the ground's is -1 and so finds the last row.
        bodies: whose values they are.
        values: as the engine lists them.
        rows: written to.
    """
    for k in range(len(bodies)):
        row = ids[np.searchsorted(engine_ids, bodies[k])]
        for column in range(values.shape[1]):  # a whole row at once takes seconds to compile
            rows[row, column] = values[k, column]
