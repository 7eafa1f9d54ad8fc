"""Completion, from the boxes' geometry, of the contacts of engines that list penetrating points only.

A brick that rests on three corners, tilted by micrometres, has three points in these lists: half of the true contact
area. A roof over four edges, at heights that differ by micrometres, has two edges in these lists. Under load the
missing corners would bear force as well. Other engines list these corners with a small gap. This module clips a face of
one body by the facing face of the other body, which gives the missing corners. The engines use the same method.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from adapters.shared.box_contacts import CENTER, HALF, SLACK, TURN, missing_corners, near_corners, note_reach
from adapters.shared.swept_contacts import approaches, fast_rows
from scenarios.model import Brick, Vector
from stability_core.port import GROUND, Contacts, FloatArray, IntArray

_GROUND_BOX = (0.0, 0.0, -1.0, 1.0, 0.0, 0.0, 0.0, 1e3, 1e3, 1.0, 1e3, 1e3, 1.0)
"""Row of the ground, a box whose top is z = 0."""

VelocitiesAt = Callable[[IntArray, FloatArray], FloatArray]
"""Function of ids (k,) and points (k, 3) [m] that returns the bodies' velocities (k, 3) [m/s] at these points."""


def fixed_id(index: int) -> int:
    """Return the id of the fixed box at ``index`` in ``World.fixed``, for the contacts of an adapter.

    The port completes the contacts of each fixed box separately, and then replaces the id by ``GROUND``.
    """
    return GROUND - 1 - index


class BoxTable:
    """Poses of the boxes of a world, and the completion of an engine's contacts.

    The caller places a frozen body once. Per frame and live body the table therefore updates one pose, and tests the
    extents of every other body.
    """

    def __init__(self, fixed: Sequence[Brick] = ()) -> None:
        self._first = (
            len(fixed) + 1
        )  # row of body 0, after the fixed boxes and the ground; the row of any body is its id plus this number
        self._boxes = np.full((64 + self._first, len(_GROUND_BOX)), np.nan)  # NaN in a row without a body
        self._boxes[self._first + GROUND] = _GROUND_BOX
        self._rows = self._first
        if fixed:
            ids = np.array([fixed_id(index) for index in range(len(fixed))])
            self._boxes[self._first + ids, HALF] = np.array([edges_of(body) for body in fixed]) / 2
            self.place(ids, np.array([box.position for box in fixed]), np.array([box.quaternion for box in fixed]))

    def add(self, body: int, size: Vector) -> None:
        """Add a body with edges ``size`` [m] and without a pose. The id must be higher than all earlier ids."""
        row = self._first + body
        self._rows = row + 1
        if self._rows > len(self._boxes):
            self._boxes = np.concatenate([self._boxes, np.full_like(self._boxes, np.nan)])
        self._boxes[row, HALF] = np.asarray(size) / 2

    def place(self, bodies: IntArray, positions: FloatArray, quaternions: FloatArray) -> None:
        """Set the positions (k, 3) [m] and the quaternions (k, 4) of ``bodies`` (k,)."""
        rows = bodies + self._first
        self._boxes[rows, CENTER] = positions
        self._boxes[rows, TURN] = quaternions
        note_reach(self._boxes, rows)

    def remove(self, body: int) -> None:
        """Delete the row of a body."""
        self._boxes[self._first + body] = np.nan

    def with_missing_corners(self, contacts: Contacts) -> Contacts:
        """Return the contacts, followed by the missing corners, touching or nearly touching, of their contact areas.

        Each corner has the normal and the relative velocity of the first point of its pair.
        """
        if not len(contacts):
            return contacts
        a, b = contacts.body_a + self._first, contacts.body_b + self._first
        order = np.argsort(a * self._rows + b, kind="stable")
        row, corner, gap = missing_corners(
            self._boxes, a[order], b[order], contacts.normal[order], contacts.point[order]
        )
        row = order[row]
        return joined(
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
        self, contacts: Contacts, live: IntArray, friction: float, velocities: VelocitiesAt, way: float = 0.0
    ) -> Contacts:
        """Return the contacts, followed by the corners of near pairs that the engine does not list.

        Args:
            contacts: contacts that the engine lists.
            live: ids of the live bodies, in rising order, shape (m,).
            friction: coefficient of every pair.
            velocities: function that returns the velocities of bodies at points. These velocities precede the impact,
                because no contact has stopped the bodies yet.
            way: distance [m] that a body may have moved after it touched another body.
        """
        listed = np.sort(self._pairs(contacts))
        a, b, corner, normal, gap = near_corners(self._boxes[: self._rows], live + self._first, listed, 0.0, way)
        if not len(a):
            return contacts
        a, b = a - self._first, b - self._first
        relative = velocities(b, corner) - velocities(a, corner)
        return joined(contacts, Contacts(a, b, corner, normal, gap, relative, np.full(len(a), friction)))

    def with_exact_faces(self, contacts: Contacts, live: IntArray, friction: float) -> Contacts:
        """Return the corners of all pairs that touch or nearly touch, followed by the contacts of all other pairs.

        The boxes' geometry is more exact at a gap of zero. There an engine may list no contact, or its normal between
        coinciding corners may be a rounding error. Deeper overlaps and crossing edges keep the engine's contacts.

        Args:
            contacts: contacts that the engine lists.
            live: ids of the live bodies, in rising order, shape (m,).
            friction: coefficient of every pair.
        """
        none_listed = np.empty(0, np.int64)
        a, b, corner, normal, gap = near_corners(self._boxes[: self._rows], live + self._first, none_listed, SLACK, 0.0)
        a, b = a - self._first, b - self._first
        unknown = np.full_like(corner, np.nan)
        near = Contacts(a, b, corner, normal, gap, unknown, np.full(len(a), friction))
        others = ~np.isin(self._pairs(contacts), self._pairs(near))
        return joined(near, self.with_missing_corners(contacts.chosen(others)))

    def with_approaching(
        self,
        contacts: Contacts,
        live: IntArray,
        movers: IntArray,
        velocity: FloatArray,
        seconds: float,
        friction: float,
    ) -> Contacts:
        """Return the contacts, followed by one point for each pair of bodies that will meet within ``seconds``.

        See ``shared.swept_contacts``. Separations are positive. Relative velocities are differences of the centres'
        velocities.

        Args:
            contacts: contacts of the frame.
            live: ids of the live bodies, in rising order, shape (m,).
            movers: ids of the bodies that may move, in rising order, shape (k,), placed at their present poses.
            velocity: velocities [m/s] of ``movers``, shape (k, 3).
            seconds: time within which the pairs meet.
            friction: coefficient of every pair.
        """
        rows = movers + self._first
        velocities, is_live = np.zeros((self._rows, 3)), np.zeros(self._rows, np.bool_)
        velocities[rows] = velocity
        is_live[live + self._first] = True
        fast = rows[fast_rows(self._boxes[rows, HALF], velocity)]
        listed = np.sort(self._pairs(contacts))
        boxes = self._boxes[: self._rows]
        a, b, point, normal, gap = approaches(boxes, velocities, fast, is_live, listed, self._first, seconds)
        if not len(a):
            return contacts
        relative = velocities[b] - velocities[a]
        a, b = a - self._first, b - self._first
        return joined(contacts, Contacts(a, b, point, normal, gap, relative, np.full(len(a), friction)))

    def are_fast(self, bodies: IntArray, velocity: FloatArray) -> bool:
        """Return whether any of ``bodies`` (k,), with velocities (k, 3) [m/s], is fast enough for a sweep."""
        return len(fast_rows(self._boxes[bodies + self._first, HALF], velocity)) > 0

    def _pairs(self, contacts: Contacts) -> IntArray:
        """Return a number (n,) for the pair of each contact, independent of the order of its bodies."""
        a, b = contacts.body_a + self._first, contacts.body_b + self._first
        pairs: IntArray = np.minimum(a, b) * self._rows + np.maximum(a, b)
        return pairs


def edges_of(brick: Brick) -> Vector:
    """Return the edges [m] of a box; NaN for any other shape, as in a row without a body."""
    return brick.size if brick.shape == "box" else (math.nan, math.nan, math.nan)


def joined(first: Contacts, second: Contacts) -> Contacts:
    """Concatenate two lists of contacts. If only one list has forces, the forces of the other list are zero."""
    if not len(second):
        return first
    columns = ("body_a", "body_b", "point", "normal", "separation", "relative_velocity", "friction")
    both = Contacts(*(np.concatenate([getattr(first, name), getattr(second, name)]) for name in columns))
    if first.force is None and second.force is None:
        return both
    forces = [np.zeros(part.point.shape) if part.force is None else part.force for part in (first, second)]
    return replace(both, force=np.concatenate(forces))


def prepare() -> None:
    """Compile the kernels, or load the kernels from the cache, before the first timed frame."""
    table = BoxTable()
    for body in range(3):
        table.add(body, (1.0, 1.0, 1.0))
    upright = np.tile((1.0, 0.0, 0.0, 0.0), (3, 1))
    table.place(np.arange(3), np.array([[0.0, 0.0, z] for z in (0.5, 1.5, 2.5)]), upright)
    up, ids = np.array([[0.0, 0.0, 1.0]]), np.arange(2)
    contacts = Contacts(ids[:1], ids[1:], up, up, np.zeros(1), up, np.zeros(1))
    table.with_near_pairs(table.with_missing_corners(contacts), ids, 0.0, lambda _, points: points)
    table.with_approaching(contacts, ids, ids, np.ones((2, 3)), 1.0, 0.0)
