"""Vertices of the convex bodies of a world, and the completion of an engine's contacts by their contact areas."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from stability_core.port import Contacts, FloatArray, IntArray
from stability_core.ports.shared.contact_area import missing_corners

RIM = 24
"""Number of vertices on each rim of a cylinder. The edges of this polygon lie inside the circle, by up to 0.9 % of the
radius."""
NO_AXIS: FloatArray = np.zeros(3)
HALF_SPACE: FloatArray = np.empty((0, 3))
"""Vertices of a half space, such as the ground."""


def box_vertices(half: FloatArray) -> FloatArray:
    """Return the vertices (8, 3) of a box with half edges ``half`` (3,) [m]."""
    signs = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
    return signs * half


def cylinder_vertices(radius: float, height: float) -> FloatArray:
    """Return vertices (2 ``RIM``, 3) [m] on both rims of a cylinder along z, centred on the origin."""
    angle = np.arange(RIM) * (2 * np.pi / RIM)
    circle = radius * np.column_stack([np.cos(angle), np.sin(angle)])
    return np.concatenate([np.column_stack([circle, np.full(RIM, z)]) for z in (-height / 2, height / 2)])


class Solid(NamedTuple):
    """A convex body, in the frame of its pose."""

    vertices: FloatArray
    """Vertices [m], shape (n, 3); n = 0 for a half space."""
    axis: FloatArray = NO_AXIS
    """Unit vector along the axis of a cylinder, shape (3,); zero for other bodies. The vertices of a cylinder are
    points on its rims."""


class ShapeTable:
    """Vertices and poses of bodies. The table does not complete the contacts of a body outside the table."""

    def __init__(self) -> None:
        self._solids: dict[int, Solid] = {}
        self._row_of: dict[int, int] = {}
        self._flat: FloatArray = HALF_SPACE
        self._first: IntArray = np.zeros(1, np.int64)
        self._sizes: FloatArray = np.empty(0)
        self._axes: FloatArray = HALF_SPACE
        self._poses: FloatArray = np.empty((0, 7))
        self._is_current = True

    def __contains__(self, body: int) -> bool:
        return body in self._solids

    def add(self, body: int, solid: Solid) -> None:
        """Add a convex body, or replace its shape."""
        self._solids[body] = solid
        self._is_current = False

    def remove(self, body: int) -> None:
        """Delete a body, if the table has this body."""
        if self._solids.pop(body, None) is not None:
            self._is_current = False

    def place(self, bodies: list[int], poses: FloatArray) -> None:
        """Set poses (k, 7) of ``bodies``: position [m], then quaternion (x, y, z, w); skip unknown bodies."""
        self._refresh()
        for body, pose in zip(bodies, poses, strict=True):
            row = self._row_of.get(body)
            if row is not None:
                self._poses[row] = pose

    def completed(self, contacts: Contacts) -> Contacts:
        """Return the contacts, then the missing corners of their contact areas.

        A corner has the normal, the velocity and the friction of the deepest contact of its pair. If the contacts have
        forces, the force of a corner is zero.
        """
        if not len(contacts) or not self._solids:
            return contacts
        self._refresh()
        row_of = self._row_of
        a = np.array([row_of.get(body, -1) for body in contacts.body_a.tolist()], np.int64)
        b = np.array([row_of.get(body, -1) for body in contacts.body_b.tolist()], np.int64)
        order = np.argsort(a * (len(self._sizes) + 1) + b, kind="stable")
        row, corner, gap = missing_corners(
            self._flat,
            self._first,
            self._poses,
            self._sizes,
            self._axes,
            a[order],
            b[order],
            contacts.point[order],
            contacts.normal[order],
            contacts.separation[order],
        )
        return contacts if not len(row) else _joined(contacts, order[row], corner, gap)

    def _refresh(self) -> None:
        """Rebuild the flat arrays after a change of the bodies."""
        if self._is_current:
            return
        poses = {body: self._poses[row] for body, row in self._row_of.items()}
        self._row_of = {body: row for row, body in enumerate(self._solids)}
        parts = [solid.vertices for solid in self._solids.values()]
        self._axes = np.array([solid.axis for solid in self._solids.values()]).reshape(-1, 3)
        self._flat = np.concatenate([HALF_SPACE, *parts])
        self._first = np.cumsum([0, *map(len, parts)])
        reach = [np.sqrt((part**2).sum(axis=1).max()) if len(part) else np.inf for part in parts]
        self._sizes = np.array(reach, np.float64)
        upright = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0])
        self._poses = np.array([poses.get(body, upright) for body in self._solids]).reshape(-1, 7)
        self._is_current = True


def _joined(contacts: Contacts, row: IntArray, corner: FloatArray, gap: FloatArray) -> Contacts:
    """Return the contacts, then corners (k, 3) with gaps (k,). Corner i belongs to the pair of contact ``row[i]``."""
    more = replace(
        contacts.chosen(row),
        point=corner,
        separation=gap,
        force=None if contacts.force is None else np.zeros(corner.shape),
    )
    columns = ["body_a", "body_b", "point", "normal", "separation", "relative_velocity", "friction"]
    columns += [] if contacts.force is None else ["force"]
    return Contacts(*(np.concatenate([getattr(contacts, name), getattr(more, name)]) for name in columns))


def compile_kernels() -> None:
    """Compile the kernels of ``ShapeTable.completed``, or load the kernels from the cache, so that no frame waits."""
    table, ids, up = ShapeTable(), np.arange(1, 2), np.array([[0.0, 0.0, 1.0]])
    for body in range(2):
        table.add(body, Solid(box_vertices(np.ones(3))))
    table.completed(Contacts(ids - 1, ids, up, up, np.zeros(1), up, np.zeros(1)))
