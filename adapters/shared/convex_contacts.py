"""Completion, from the bodies' geometry, of the contacts of pairs with at least one body that is no box.

Engines list few points of a round face or of a line, and some engines list one more point in each step. For example,
MuJoCo lists three points below a standing cylinder, and these points span a quarter of its face. The extension needs
the whole contact area. For the normal that the engine lists, the geometry gives the facing points of both bodies:

- box, polyhedron: the vertices;
- cylinder: ``RIM`` points on each rim, with a point in the direction of the normal; one point on each rim if the
  normal is perpendicular to the axis;
- capsule: the two points of the rounded ends, in the direction of the normal;
- sphere: one point.

``stability_core.ports.shared.contact_area`` intersects both sets. Two parallel lines, for example of two logs, meet in
their common part.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from adapters.shared.contact_completion import fixed_id, joined
from adapters.shared.vectors import rotate
from scenarios.model import Brick, World
from scenarios.shapes import Polyhedron
from scenarios.solids import reach_of
from stability_core.port import GROUND, Contacts, FloatArray, IntArray
from stability_core.ports.shared.contact_area import NEAR, SAME, area_corners

RIM = 24
"""Number of points on the rim of a cylinder: their polygon lies within the circle, by 0.9 % of the radius."""
PARALLEL = 1e-3
"""Greatest sine of the angle between two lines that count as parallel. There lines of 0.1 m are 0.05 mm apart at
their ends."""
_LINE = 2
"""Number of points that face along a normal, of a line."""
_HALF_SPACE: FloatArray = np.empty((0, 3))
_CORNERS = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])

PosesOf = Callable[[IntArray], tuple[FloatArray, FloatArray]]
"""Function of ids (k,) that returns positions (k, 3) [m] and quaternions (k, 4)."""


class ConvexContacts:
    """Completion of contacts in a world that has bodies of other shapes than boxes."""

    def __init__(self, world: World) -> None:
        self._bricks: dict[int, Brick] = {fixed_id(index): body for index, body in enumerate(world.fixed)}
        self._others = {body for body, brick in self._bricks.items() if brick.shape != "box"}

    def add(self, body: int, brick: Brick) -> None:
        """Add a body."""
        self._bricks[body] = brick
        if brick.shape != "box":
            self._others.add(body)

    def remove(self, body: int) -> None:
        """Delete a body."""
        del self._bricks[body]
        self._others.discard(body)

    def completed(self, contacts: Contacts, poses_of: PosesOf) -> Contacts:
        """Return the contacts, followed by the missing corners of pairs with a body that is no box.

        A corner has the velocity and the friction of the first contact of its pair, and no force.
        """
        if not self._others or not len(contacts):
            return contacts
        rows_of: dict[tuple[int, int], list[int]] = {}
        for row, pair in enumerate(zip(contacts.body_a.tolist(), contacts.body_b.tolist(), strict=True)):
            if pair[0] in self._others or pair[1] in self._others:
                rows_of.setdefault(pair, []).append(row)
        if not rows_of:
            return contacts
        places = self._places({body for pair in rows_of for body in pair}, poses_of)
        rows: list[int] = []
        corners: list[FloatArray] = []
        gaps: list[float] = []
        for (a, b), listed in rows_of.items():
            for corner, gap in self._missing(a, b, contacts.chosen(np.array(listed)), places):
                rows.append(listed[0])
                corners.append(corner)
                gaps.append(gap)
        if not rows:
            return contacts
        more = contacts.chosen(np.array(rows))
        return joined(contacts, replace(more, point=np.array(corners), separation=np.array(gaps), force=None))

    def _places(self, bodies: set[int], poses_of: PosesOf) -> dict[int, tuple[FloatArray, FloatArray]]:
        """Return position (3,) [m] and quaternion (4,) of each body except the ground."""
        places = {
            body: (np.array(self._bricks[body].position), np.array(self._bricks[body].quaternion))
            for body in bodies
            if body < GROUND
        }
        ids = np.array(sorted(body for body in bodies if body > GROUND), np.int64)
        return places | dict(zip(ids.tolist(), zip(*poses_of(ids), strict=True), strict=True))

    def _missing(
        self, a: int, b: int, listed: Contacts, places: dict[int, tuple[FloatArray, FloatArray]]
    ) -> list[tuple[FloatArray, float]]:
        """Return the corners (3,) [m] of a pair's contact area that the engine does not list, with their gaps [m]."""
        deepest = int(np.nanargmin(listed.separation)) if np.isfinite(listed.separation).any() else 0
        gap = float(np.nan_to_num(listed.separation[deepest]))
        normal, point = listed.normal[deepest], listed.point[deepest]
        facing_a, facing_b = self._facing(a, normal, places), self._facing(b, -normal, places)
        size = min(reach_of(self._bricks[body]) for body in (a, b) if body != GROUND)
        corners, gaps = area_corners(facing_a, facing_b, normal, point, gap, NEAR * size)
        if len(facing_a) == len(facing_b) == _LINE:
            corners = _shared_part(facing_a, facing_b)
            gaps = np.full(len(corners), gap)
        known = [*listed.point]
        found = []
        for corner, opened in zip(corners, gaps.tolist(), strict=True):
            if min(float(np.linalg.norm(corner - other)) for other in known) > SAME * size:
                known.append(corner)
                found.append((corner, opened))
        return found

    def _facing(self, body: int, direction: FloatArray, places: dict[int, tuple[FloatArray, FloatArray]]) -> FloatArray:
        """Return the points (k, 3) [m] of a body that may face along a direction (3,); no points for the ground."""
        if body == GROUND:
            return _HALF_SPACE
        brick, (position, quaternion) = self._bricks[body], places[body]
        inverse = quaternion * (1.0, -1.0, -1.0, -1.0)
        local = _local_points(brick, rotate(inverse[None], direction[None])[0])
        return position + rotate(np.broadcast_to(quaternion, (len(local), 4)), local)


def _local_points(brick: Brick, direction: FloatArray) -> FloatArray:
    """Return the points (k, 3) [m] of a brick that may face along a direction (3,), in the brick's own frame."""
    shape, (diameter, _, length) = brick.shape, brick.size
    if isinstance(shape, Polyhedron):
        return shape.array
    if shape == "box":
        return _CORNERS * brick.size
    if shape == "cylinder":
        across = float(np.hypot(direction[0], direction[1]))
        start = float(np.arctan2(direction[1], direction[0])) if across > PARALLEL else 0.0
        steps = 1 if across > 1 - PARALLEL else RIM  # a lying cylinder faces along a line
        angles = start + np.arange(steps) * (2 * np.pi / RIM)
        circle = diameter / 2 * np.column_stack([np.cos(angles), np.sin(angles)])
        return np.vstack([np.column_stack([circle, np.full(steps, z)]) for z in (-length / 2, length / 2)])
    end = length / 2 - diameter / 2
    middles = np.array([[0.0, 0.0, -end], [0.0, 0.0, end]]) if shape == "capsule" else np.zeros((1, 3))
    points: FloatArray = middles + diameter / 2 * direction
    return points


def _shared_part(one: FloatArray, other: FloatArray) -> FloatArray:
    """Return the ends (2, 3) [m] of the common part of two lines; no ends unless the lines are parallel and overlap."""
    (start, end), (p, q) = one, other
    length = float(np.linalg.norm(end - start))
    along = (end - start) / length
    direction = (q - p) / np.linalg.norm(q - p)
    if np.linalg.norm(np.cross(along, direction)) > PARALLEL:
        return _HALF_SPACE
    first, last = sorted(((p - start) @ along, (q - start) @ along))
    low, high = max(0.0, float(first)), min(length, float(last))
    return np.array([start + low * along, start + high * along]) if low < high else _HALF_SPACE
