"""Points at which boxes nearly touch, for engines that list penetrating points only.

Of a brick that rests on three corners, tilted by micrometres, such an engine lists three points: half of the true
contact area. Of a roof over four edges that differ in height by as little, it lists two edges. Under load the others
would carry as well. Other engines report them by a small gap; for the rest they are found here from the boxes'
geometry, by clipping one face by the other as the engines themselves do.
"""

from __future__ import annotations

from collections.abc import Callable

import numba
import numpy as np

from adapters.face_corners import CENTER, HALF, REACH, TURN, box_axes, face_corners, parting_face
from scenarios.model import Vector
from stability_core.port import GROUND, Contacts, FloatArray, IntArray

NEAR = 0.1e-3
"""Gap [m] up to which faces nearly touch: above the tilt of a brick at rest, below any visible distance."""
SAME = 1e-3
"""Distance [m] within which a corner is one that the engine has listed."""

_GROUND_BOX = (0.0, 0.0, -1.0, 1.0, 0.0, 0.0, 0.0, 1e3, 1e3, 1.0, 1e3, 1e3, 1.0)
"""The ground as a box: its top is z = 0."""
_MOST_CORNERS = 8
"""Of a face that is clipped by another: each of four cuts adds one at most."""

VelocitiesAt = Callable[[IntArray, FloatArray], FloatArray]
"""From ids (k,) and points (k, 3) [m] to the velocities (k, 3) [m/s] that the bodies have there."""


@numba.njit(cache=True)
def _note_reach(boxes: FloatArray, rows: IntArray) -> None:
    """Work out how far the boxes of these ``rows`` reach along x, y and z."""
    for row in rows:
        axes = box_axes(boxes[row, TURN])
        for k in range(3):
            reach = 0.0
            for axis in range(3):
                reach += abs(axes[k, axis]) * boxes[row, HALF][axis]
            boxes[row, REACH][k] = reach


@numba.njit(cache=True)
def _missing(
    boxes: FloatArray, a: IntArray, b: IntArray, normal: FloatArray, point: FloatArray
) -> tuple[IntArray, FloatArray, FloatArray]:
    """A row of its pair (k,), point (k, 3) and separation (k,) of each corner that its pair's rows do not list.

    Rows of a pair stand together; ``a`` and ``b``, (n,), are rows of ``boxes``.
    """
    n = len(a)
    row, corner, gap = np.empty(8 * n, np.int64), np.empty((8 * n, 3)), np.empty(8 * n)
    size, first = 0, 0
    while first < n:
        last = first
        while last < n and a[last] == a[first] and b[last] == b[first]:
            last += 1
        points, separations = face_corners(boxes[a[first]], boxes[b[first]], normal[first])
        for i in range(len(points)):
            listed = False
            for j in range(first, last):
                distance2 = 0.0
                for k in range(3):
                    distance2 += (points[i, k] - point[j, k]) ** 2
                listed = listed or distance2 < SAME**2
            if not listed and abs(separations[i]) <= NEAR:
                row[size], corner[size], gap[size] = first, points[i], separations[i]
                size += 1
        first = last
    return row[:size], corner[:size], gap[:size]


@numba.njit(cache=True)
def _neighbours(boxes: FloatArray, live: IntArray, listed: IntArray) -> list[tuple[int, int]]:
    """Pairs of rows, the lower first, of which one is ``live``, that are not ``listed``, and whose extents nearly meet.

    O(boxes) a live one.

    Args:
        boxes: all of them, shape (n, 13).
        live: rows, rising, shape (m,).
        listed: n a + b for each pair (a, b) that the engine lists, rising.
    """
    found = [(0, 0) for _ in range(0)]
    for one in live:
        for other in range(len(boxes)):
            near = other != one
            for k in range(3):  # written so that NaN, a row without a body, fails
                reach = boxes[one, REACH][k] + boxes[other, REACH][k] + NEAR
                near = near and abs(boxes[one, k] - boxes[other, k]) <= reach
            if not near:
                continue
            at = np.searchsorted(live, other)
            if other < one and at < len(live) and live[at] == other:
                continue  # a pair of live boxes is met twice
            key = min(one, other) * len(boxes) + max(one, other)
            at = np.searchsorted(listed, key)
            if at == len(listed) or listed[at] != key:
                found.append((min(one, other), max(one, other)))
    return found


@numba.njit(cache=True)
def _near(
    boxes: FloatArray, live: IntArray, listed: IntArray
) -> tuple[IntArray, IntArray, FloatArray, FloatArray, FloatArray]:
    """Rows a (k,) and b (k,), point (k, 3), normal (k, 3) and gap (k,) of each corner of near boxes not listed.

    See ``_neighbours``.
    """
    pairs = _neighbours(boxes, live, listed)
    room = _MOST_CORNERS * len(pairs)
    a, b, gap = np.empty(room, np.int64), np.empty(room, np.int64), np.empty(room)
    corner, normals = np.empty((room, 3)), np.empty((room, 3))
    normal = np.empty(3)
    size = 0
    for first, second in pairs:
        if abs(parting_face(boxes[first], boxes[second], normal)) > NEAR:
            continue
        points, separations = face_corners(boxes[first], boxes[second], normal)
        for i in range(len(points)):
            if abs(separations[i]) <= NEAR:
                a[size], b[size], gap[size] = first, second, separations[i]
                corner[size], normals[size] = points[i], normal
                size += 1
    return a[:size], b[:size], corner[:size], normals[:size], gap[:size]


class BoxTable:
    """Where the boxes of a world are, and what of their contacts an engine leaves out.

    A frozen body is placed once: completing the contacts of a frame costs what the live ones cost, and a glance at each
    of the others.
    """

    def __init__(self) -> None:
        self._boxes = np.full((64, len(_GROUND_BOX)), np.nan)  # the row is the id + 1, NaN where there is no body
        self._boxes[GROUND + 1] = _GROUND_BOX
        self._rows = 1

    def add(self, body: int, size: Vector) -> None:
        """A body of these edges [m], yet to be placed; ids rise."""
        self._rows = body + 2
        if self._rows > len(self._boxes):
            self._boxes = np.concatenate([self._boxes, np.full_like(self._boxes, np.nan)])
        self._boxes[body + 1, HALF] = np.asarray(size) / 2

    def place(self, bodies: IntArray, positions: FloatArray, quaternions: FloatArray) -> None:
        """Take over where ``bodies`` (k,) are: positions (k, 3) [m], quaternions (k, 4)."""
        self._boxes[bodies + 1, CENTER] = positions
        self._boxes[bodies + 1, TURN] = quaternions
        _note_reach(self._boxes, bodies + 1)

    def remove(self, body: int) -> None:
        """Forget a body."""
        self._boxes[body + 1] = np.nan

    def with_missing_corners(self, contacts: Contacts) -> Contacts:
        """The contacts, and behind them the corners of their faces that nearly touch and that the engine did not list.

        A corner has the normal and the relative velocity of its pair's first point.
        """
        if not len(contacts):
            return contacts
        a, b = contacts.body_a + 1, contacts.body_b + 1
        order = np.argsort(a * self._rows + b, kind="stable")
        row, corner, gap = _missing(self._boxes, a[order], b[order], contacts.normal[order], contacts.point[order])
        row = order[row]
        return _joined(
            contacts,
            Contacts(
                contacts.body_a[row],
                contacts.body_b[row],
                corner,
                contacts.normal[row],
                gap,
                contacts.relative_velocity[row],
                contacts.friction[row],
            ),
        )

    def with_near_pairs(
        self, contacts: Contacts, live: IntArray, friction: float, velocities: VelocitiesAt
    ) -> Contacts:
        """The contacts, and behind them the corners of pairs that nearly touch and of which the engine lists no point.

        Args:
            contacts: as the engine lists them.
            live: ids of the live bodies, rising, shape (m,).
            friction: of every pair.
            velocities: of bodies at points. What has not touched has not been stopped: they are those before impact.
        """
        a, b = contacts.body_a + 1, contacts.body_b + 1
        listed = np.unique(np.minimum(a, b) * self._rows + np.maximum(a, b))
        a, b, corner, normal, gap = _near(self._boxes[: self._rows], live + 1, listed)
        if not len(a):
            return contacts
        relative = velocities(b - 1, corner) - velocities(a - 1, corner)
        return _joined(contacts, Contacts(a - 1, b - 1, corner, normal, gap, relative, np.full(len(a), friction)))


def _joined(first: Contacts, second: Contacts) -> Contacts:
    if not len(second):
        return first
    columns = ("body_a", "body_b", "point", "normal", "separation", "relative_velocity", "friction")
    return Contacts(*(np.concatenate([getattr(first, name), getattr(second, name)]) for name in columns))


def prepare() -> None:
    """Compile the kernels, or read them from the cache, before any frame is timed."""
    table = BoxTable()
    for body in range(3):
        table.add(body, (1.0, 1.0, 1.0))
    upright = np.tile((1.0, 0.0, 0.0, 0.0), (3, 1))
    table.place(np.arange(3), np.array([[0.0, 0.0, z] for z in (0.5, 1.5, 2.5)]), upright)
    up, ids = np.array([[0.0, 0.0, 1.0]]), np.arange(2)
    contacts = Contacts(ids[:1], ids[1:], up, up, np.zeros(1), up, np.zeros(1))
    table.with_near_pairs(table.with_missing_corners(contacts), ids, 0.0, lambda _, points: points)
