"""Contact manifolds: unite the points of a pair over the dwell frames into contact patches.

The manifold of a single frame is often degenerate. For example, a brick on two bricks has 4 + 4 points in one frame. In
the next frame, tilted by micrometres, the brick has 1 or 2 points. The hull of the points of several frames
approximates the true contact area. The module groups the points of a pair by their normals. Therefore a pair that
touches in several faces (two walls of one ground, a bracket) has a patch for each face.
"""

from __future__ import annotations

import numpy as np

from stability_core.compiled import compiled
from stability_core.contact_filter import BEARS, ContactRows, bit_of, upper_of
from stability_core.frame_buffers import FrameBuffers, frame_before
from stability_core.polygon import centroid, convex_hull, width
from stability_core.port import GROUND, FloatArray, IntArray
from stability_core.stack import (
    FROZEN,
    LEAN,
    MAX_VERTICES,
    NONE,
    SUPPORT,
    Graph,
    Patches,
    axes_of,
    drop_supports,
    is_stack,
    link,
)
from stability_core.upright import turned

ENOUGH_VERTICES = 4
"""Number of vertices at which ``_thinned`` stops, because a box stands on four vertices."""
NEGLIGIBLE = 1e-3
"""Share of a patch's area up to which ``_thinned`` drops a vertex, because the points of several frames scatter,
and each vertex costs time."""
_LOAD, _FILED = -1, -2
"""Further kinds of contacts:

- _LOAD: the other body stands on this body;
- _FILED: the contact is already in a patch.
"""


@compiled
def _twice_area(hull: FloatArray) -> float:
    total = 0.0
    for i in range(len(hull)):
        a, b = hull[i - 1], hull[i]
        total += a[0] * b[1] - a[1] * b[0]
    return total


@compiled
def _thinned(hull: FloatArray) -> FloatArray:
    """Return the hull (k, 3) without the vertices that add the least area.

    At most MAX_VERTICES vertices remain. While more than ``ENOUGH_VERTICES`` vertices remain, the function also drops a
    vertex that adds at most ``NEGLIGIBLE`` of the area.
    """
    size = len(hull)
    negligible = NEGLIGIBLE * _twice_area(hull) if size > ENOUGH_VERTICES else 0.0
    while size > ENOUGH_VERTICES:
        least, least_area = 0, np.inf
        for i in range(size):
            a, b, c = hull[(i - 1) % size], hull[i], hull[(i + 1) % size]
            twice_area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
            if twice_area < least_area:
                least, least_area = i, twice_area
        if size <= MAX_VERTICES and least_area > negligible:
            break
        for i in range(least, size - 1):
            hull[i] = hull[i + 1]
        size -= 1
    return hull[:size]


@compiled
def shape_patch(patch: Patches, points: FloatArray) -> None:
    """Write the hull of contact points (k, 3), its centre and its width to a patch with known kind and normal.

    A load-bearing patch has the hull in plan. Any other patch has the hull in its own plane.
    """
    if patch.kind == SUPPORT:
        hull = _thinned(convex_hull(points))
        patch.center[0], patch.center[1], patch.center[2] = centroid(hull)
        patch.width = width(hull)
    else:
        axes = axes_of(patch.normal)
        flat = _thinned(convex_hull(turned(points, axes)))
        hull = turned(flat, axes.T)
        patch.width = width(flat)
        middle = np.empty((1, 3))
        middle[0, 0], middle[0, 1], middle[0, 2] = centroid(flat)
        middle = turned(middle, axes.T)
        for k in range(3):
            patch.center[k] = middle[0, k]
    corners = patch.vertex
    patch.vertices = len(hull)
    for i in range(len(hull)):
        for k in range(3):
            corners[i, k] = hull[i, k]


@compiled
def _lay_patch(graph: Graph, contacts: ContactRows, rows: IntArray, body: int, other: int, kind: int) -> None:
    """Build a patch of ``body`` on ``other`` from the contacts ``rows``."""
    points = np.empty((len(rows), 3))
    patch = link(graph, body, other, kind)
    x, y, z = 0.0, 0.0, 0.0
    friction = np.inf
    for i in range(len(rows)):
        contact = contacts[rows[i]]
        point, normal = contact.point, contact.normal
        for k in range(3):
            points[i, k] = point[k]
        sign = 1.0 if contact.body_b == body else -1.0
        x, y, z = x + sign * normal[0], y + sign * normal[1], z + sign * normal[2]
        friction = min(friction, contact.friction)
    length = np.sqrt(x**2 + y**2 + z**2)
    patch.normal[0], patch.normal[1], patch.normal[2] = x / length, y / length, z / length
    patch.friction = friction
    shape_patch(patch, points)


@compiled
def _kind_for(contact: ContactRows, body: int) -> int:
    """Return SUPPORT if ``body`` stands on its partner, LEAN if ``body`` leans, _LOAD for a partner on ``body``."""
    if not contact.level:
        return LEAN
    return SUPPORT if upper_of(contact.body_a, contact.body_b, contact.normal[2]) == body else _LOAD


@compiled
def _share_a_face(first: ContactRows, second: ContactRows, face_angle: float) -> bool:
    """Return True if two contacts of a pair have the same normal, within ``face_angle`` [rad]."""
    sign = 1.0 if first.body_a == second.body_a else -1.0
    cosine = 0.0
    for k in range(3):
        cosine += sign * first.normal[k] * second.normal[k]
    return bool(cosine >= np.cos(face_angle))


@compiled
def lay_patches(graph: Graph, contacts: ContactRows, mine: IntArray, body: int, face_angle: float) -> None:
    """Rebuild the patches of ``body`` on its supports and leaning partners in ``contacts``.

    A frozen body gets patches on the stack only (ground, FIXED bodies and frozen bodies), because a frozen body keeps
    its patches. Frozen bodies that stand on a frozen ``body`` also get patches on this body. The cost is O(n times
    neighbours), independent of the height of the stack.

    Args:
        graph: the stack, with at least n spare patches.
        contacts: rows of ``CONTACT``.
        mine: the contacts that touch the body, shape (n,).
        body: row of the body.
        face_angle: greatest angle [rad] between the normals of two contacts on one face.
    """
    drop_supports(graph, body)
    bodies, row = graph.bodies, graph.bodies[body]
    n = len(mine)
    others, kinds = np.empty(n, np.int64), np.empty(n, np.int64)
    for i in range(n):
        contact = contacts[mine[i]]
        others[i] = contact.body_b if contact.body_a == body else contact.body_a
        kinds[i] = _kind_for(contact, body)
    is_kept = row.state == FROZEN
    row.provisional = False
    rows = np.empty(n, np.int64)
    for first in range(n):
        other, kind = others[first], kinds[first]
        if kind == _FILED:
            continue
        size = 0
        for i in range(first, n):
            is_same = others[i] == other and kinds[i] == kind
            if is_same and _share_a_face(contacts[mine[first]], contacts[mine[i]], face_angle):
                kinds[i] = _FILED
                rows[size] = mine[i]
                size += 1
        other_is_live = not is_stack(bodies, other)
        if other_is_live or kind == _LOAD:
            row.provisional = True
        if kind != _LOAD and not (is_kept and other_is_live):
            _lay_patch(graph, contacts, rows[:size], body, other, kind)
        elif kind == _LOAD and is_kept and not other_is_live:
            _lay_patch(graph, contacts, rows[:size], other, body, SUPPORT)


@compiled
def _is_one_run(first: ContactRows, second: ContactRows, face_angle: float) -> bool:
    if first.body_a != second.body_a or first.body_b != second.body_b or first.level != second.level:
        return False
    return bool(_share_a_face(first, second, 0.5 * face_angle))


@compiled
def count_faces(buffers: FrameBuffers, face_angle: float) -> int:
    """Return an upper bound for the number of faces on which ``lay_patches`` builds patches: O(contacts).

    The bound counts the runs of contacts of one pair, of one kind, and with nearly the same normal. Any two contacts
    of a run share a face, so that a run belongs to one patch.
    """
    contacts, sizes = buffers.contacts, buffers.sizes
    room = len(contacts) // len(sizes)
    runs = 0
    for frame in range(len(sizes)):
        first = NONE
        for row in range(frame * room, frame * room + sizes[frame]):
            if first == NONE or not _is_one_run(contacts[first], contacts[row], face_angle):
                first = row
                runs += 1
    return runs


@compiled
def _contacts_of(graph: Graph, buffers: FrameBuffers, ids: IntArray, frames: int) -> tuple[IntArray, IntArray]:
    """Return the contacts of each body in ``ids`` in the last ``frames`` dwell frames, oldest first: O(contacts).

    Returns:
        Two arrays:

        - start of each body's part of the list, shape (k + 1,);
        - the list: rows of ``buffers.contacts``.
    """
    bodies, contacts, sizes = graph.bodies, buffers.contacts, buffers.sizes
    k, room = len(ids), len(contacts) // len(sizes)
    for i in range(k):
        bodies[ids[i]].place = i
    start = np.zeros(k + 1, np.int64)
    rows = np.empty(2 * sizes.sum(), np.int64)
    owner = np.empty(len(rows), np.int64)
    found = 0
    for back in range(frames - 1, -1, -1):
        frame = frame_before(buffers, back)
        for row in range(frame * room, frame * room + sizes[frame]):
            for body in (contacts[row].body_a, contacts[row].body_b):
                if body == GROUND:
                    continue
                place = bodies[body].place  # perhaps left over from another list
                if place < k and ids[place] == body:
                    rows[found], owner[found] = row, place
                    start[place + 1] += 1
                    found += 1
    for i in range(k):
        start[i + 1] += start[i]
    at = start.copy()
    by_body = np.empty(found, np.int64)
    for i in range(found):
        by_body[at[owner[i]]] = rows[i]
        at[owner[i]] += 1
    return start, by_body


@compiled
def supports_as_bits(graph: Graph, body: int) -> np.uint64:
    """Return the bodies on which ``body`` stands by its patches, as a set of 64 bits (see ``bit_of``)."""
    patches = graph.patches
    bits = np.uint64(0)
    at = graph.bodies[body].first_support
    while at != NONE:
        patch = patches[at]
        if patch.kind == SUPPORT or patch.normal[2] > BEARS:
            bits |= bit_of(patch.lower)
        at = patch.next_support
    return bits


@compiled
def lay_all(graph: Graph, buffers: FrameBuffers, ids: IntArray, frames: int, face_angle: float) -> None:
    """Rebuild the patches of the bodies ``ids`` from the last ``frames`` dwell frames, and mark the bodies as loads."""
    if len(ids) == 0:
        return
    start, rows = _contacts_of(graph, buffers, ids, frames)
    bodies, contacts = graph.bodies, buffers.contacts
    for i in range(len(ids)):
        lay_patches(graph, contacts, rows[start[i] : start[i + 1]], ids[i], face_angle)
        row = bodies[ids[i]]
        row.is_load = True
        row.load_supported_by, row.load_steady_s = row.supported_by | supports_as_bits(graph, ids[i]), row.steady_s
        for k in range(3):
            row.load_center[k] = row.center[k]


@compiled
def lift(graph: Graph, body: int) -> None:
    """Remove the patches on which a body stands and leans, so that the body is no load."""
    drop_supports(graph, body)
    graph.bodies[body].is_load = False
