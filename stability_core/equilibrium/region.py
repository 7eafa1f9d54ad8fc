"""Safe regions: the part U of a body that may bear a load, because the stack below bears this load too.

U(contact with the ground) is the whole contact patch. U(body) is the convex hull of the body's patches on its supports,
each patch cut with U(support). Proof by induction from the ground up:

- Vertical forces at points of the patches, inside the supports' own U, balance a weight at a point of U(body).
  Load-bearing contacts can bear these forces.
- The supports pass on each of these forces in the same way, down to the ground.
- The sum of these forces and the forces of any equilibrium lies in the Coulomb cones, because the cones are convex.

Therefore a stack that stood before also stands with the weight.
"""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np

from stability_core.compiled import compiled
from stability_core.polygon import convex_hull, inside_distance, is_inside, nearest_point
from stability_core.port import GROUND, FloatArray
from stability_core.stack import (
    FROZEN,
    IN_DOUBT,
    LEAN,
    MAX_VERTICES,
    NONE,
    NOTED,
    PROVEN,
    SUPPORT,
    Bodies,
    Graph,
    Patches,
    count_patches,
    hull_of,
    is_ground,
    is_stack,
)
from stability_core.stack_mass import support_polygon

ON_BORDER = 1e-9
"""Distance [m] up to which a point lies on a border, because rounding errors are smaller."""
SAME_NORMAL = 1e-6
"""Change of a normal's component that counts as none, because a patch rebuilt from the same points keeps its normal."""
SAME_MASS = 1e-9
"""Change of a mass [kg] that counts as none, because rounding errors are smaller."""


REGION = np.dtype(
    [
        ("vertices", "i8"),  # 0 without a known region
        ("vertex", "f8", (MAX_VERTICES, 3)),  # a convex polygon in plan, counter-clockwise [m]
        ("links", "i8"),  # fingerprint of the body's surroundings at its latest proof, or at its freeze in doubt
    ],
    align=True,
)
"""Row of a frozen body: its safe region, and the fingerprint of its proof."""
Regions: TypeAlias = Any
"""Structured array of ``REGION``, with one row for each body."""


def regions_for(bodies: int, known: Regions) -> Regions:
    """Return a table with a row for each of ``bodies`` bodies, and with a copy of the ``known`` rows."""
    fresh = np.zeros(bodies, REGION)
    fresh[: len(known)] = known
    return fresh


@compiled
def cut(subject: FloatArray, by: FloatArray) -> FloatArray:
    """Return the intersection (k, 3) of two convex polygons in plan, counter-clockwise (Sutherland and Hodgman)."""
    room = len(subject) + len(by)  # each side of a convex polygon adds one vertex at most
    shape, kept = np.empty((room, 3)), np.empty((room, 3))
    shape[: len(subject)] = subject
    sides = len(subject)
    for i in range(len(by)):
        ax, ay = by[i, 0], by[i, 1]
        ex, ey = by[(i + 1) % len(by), 0] - ax, by[(i + 1) % len(by), 1] - ay
        size = 0
        for p in range(sides):
            q = (p + 1) % sides
            left_p = ex * (shape[p, 1] - ay) - ey * (shape[p, 0] - ax)
            left_q = ex * (shape[q, 1] - ay) - ey * (shape[q, 0] - ax)
            if left_p >= 0.0 and size < room:
                for k in range(3):
                    kept[size, k] = shape[p, k]
                size += 1
            if left_p * left_q < 0.0 and size < room:
                for k in range(3):
                    kept[size, k] = shape[p, k] + (shape[q, k] - shape[p, k]) * (left_p / (left_p - left_q))
                size += 1
        shape, kept, sides = kept, shape, size
    return shape[:sides]


@compiled
def known_region(regions: Regions, body: int) -> FloatArray:
    """Return U of a frozen body, shape (k, 3), or an empty array for an unknown region."""
    row = regions[body]
    region: FloatArray = row.vertex[: row.vertices]
    return region


@compiled
def region_of(graph: Graph, regions: Regions, body: int) -> FloatArray:
    """Return U of a body that stands on the stack, shape (k, 3), from the regions of its supports.

    The cost is O(supports), independent of the height of the stack.
    """
    bodies, patches = graph.bodies, graph.patches
    points = np.empty((2 * MAX_VERTICES * count_patches(graph, body), 3))
    n = 0
    at = bodies[body].first_support
    while at != NONE:
        patch = patches[at]
        if patch.kind == SUPPORT and is_stack(bodies, patch.lower):
            area = hull_of(patch)
            if not is_ground(bodies, patch.lower):
                below = known_region(regions, patch.lower)
                area = cut(area, below) if len(below) > 2 else area[:0]
            for vertex in range(len(area)):
                for k in range(3):
                    points[n, k] = area[vertex, k]
                n += 1
        at = patch.next_support
    return convex_hull(points[:n])


@compiled
def _trait(patch: Patches, other: int, factor: int) -> int:
    """Return a hash of a neighbour's id times ``factor``, and of the contact's kind and normal."""
    total = (other + 2) * factor + patch.kind
    for k in range(3):
        total = total * 31 + int(np.rint(patch.normal[k] / SAME_NORMAL))
    return int(total)


@compiled
def _id_of(bodies: Bodies, body: int) -> int:
    """Return the id of a body, because an id is unique, but a row may belong to a new body later."""
    return int(GROUND) if body == GROUND else int(bodies[body].id)


@compiled
def fingerprint(graph: Graph, body: int) -> int:
    """Return a number that depends on the mass and the contacts of ``body``, but not on the order of the contacts.

    Contacts with the ground and with frozen bodies count, with their normals. For a body in doubt, contacts with live
    bodies count as well, because any change unfreezes a body in doubt.
    """
    bodies, patches = graph.bodies, graph.patches
    row = bodies[body]
    is_in_doubt = row.doubt != PROVEN
    total: int = int(row.mass / SAME_MASS)
    at = row.first_support
    while at != NONE:
        patch = patches[at]
        if is_in_doubt or is_stack(bodies, patch.lower):
            total += _trait(patch, _id_of(bodies, patch.lower), 0x9E3779B97F4A7C1)
        at = patch.next_support
    at = row.first_load
    while at != NONE:
        patch = patches[at]
        if is_in_doubt or bodies[patch.upper].state == FROZEN:
            total += _trait(patch, _id_of(bodies, patch.upper), 0x5851F42D4C957F3)
        at = patch.next_load
    return total


@compiled
def is_unchanged(graph: Graph, regions: Regions, body: int) -> bool:
    """Return True if the surroundings of ``body`` are the same as in its latest record."""
    return bool(fingerprint(graph, body) == regions[body].links)


@compiled
def is_proven(graph: Graph, regions: Regions, body: int) -> bool:
    """Return True if ``body`` is not in doubt, and has the mass and the frozen contacts of its latest proof."""
    return bool(graph.bodies[body].doubt == PROVEN and is_unchanged(graph, regions, body))


@compiled
def note_doubts(graph: Graph, regions: Regions) -> None:
    """Record the surroundings of the bodies frozen in doubt in this frame: O(bodies that changed in this frame).

    Any later change unfreezes these bodies. A body in doubt gets no region, so that bodies on this body need a
    solve.
    """
    for body in graph.changed[1 : 1 + graph.changed[0]]:
        row = graph.bodies[body]
        if row.state == FROZEN and row.doubt == IN_DOUBT:
            row.doubt = NOTED
            regions[body].vertices, regions[body].links = 0, fingerprint(graph, body)


@compiled
def _supports_are_proven(graph: Graph, regions: Regions, body: int) -> bool:
    """Return True if the proofs of all frozen bodies below ``body`` still hold."""
    bodies, patches = graph.bodies, graph.patches
    at = bodies[body].first_support
    while at != NONE:
        lower = patches[at].lower
        if lower != GROUND and bodies[lower].state == FROZEN and not is_proven(graph, regions, lower):
            return False
        at = patches[at].next_support
    return True


@compiled
def is_safe(graph: Graph, regions: Regions, body: int, region: FloatArray) -> bool:
    """Return True if the stack bears ``body``: its centre of mass lies in the ``region`` (k, 3) of its supports.

    False means unknown.
    """
    center = graph.bodies[body].center
    return bool(is_inside(region, center[0], center[1]) and _supports_are_proven(graph, regions, body))


@compiled
def topples_off(graph: Graph, regions: Regions, body: int, region: FloatArray) -> bool:
    """Return True if a body topples alone and the stack bears the toppling body's load.

    The body turns about the border of its contact area. The body presses, with at most its weight, on the point of the
    border nearest to its centre of mass. If this point lies in the ``region`` (k, 3), the supports bear the load. False
    means unknown.
    """
    support = support_polygon(graph, body)
    if not topples_alone(graph, body, support):
        return False
    center = graph.bodies[body].center
    x, y = nearest_point(support, center[0], center[1])
    return bool(inside_distance(region, x, y) >= -ON_BORDER and _supports_are_proven(graph, regions, body))


@compiled
def keep_proof(graph: Graph, regions: Regions, body: int, region: FloatArray) -> None:
    """Record that the frozen ``body`` stands, and may bear loads in its ``region`` (k, 3)."""
    graph.bodies[body].doubt = PROVEN
    row = regions[body]
    corners, size = row.vertex, min(len(region), MAX_VERTICES)  # fewer vertices make a smaller, equally safe region
    for vertex in range(size):
        for k in range(3):
            corners[vertex, k] = region[vertex, k]
    row.vertices, row.links = size, fingerprint(graph, body)


@compiled
def keep_proof_of_neighbours(graph: Graph, regions: Regions, body: int) -> None:
    """Record that the proven bodies below ``body`` also stand with ``body``."""
    bodies, patches = graph.bodies, graph.patches
    at = bodies[body].first_support
    while at != NONE:
        lower = patches[at].lower
        if lower != GROUND and bodies[lower].state == FROZEN and bodies[lower].doubt == PROVEN:
            regions[lower].links = fingerprint(graph, lower)
        at = patches[at].next_support


@compiled
def topples_alone(graph: Graph, body: int, support: FloatArray) -> bool:
    """Return True if a body topples alone: its centre of mass lies outside its contact area.

    On a horizontal face, friction cannot hold a body that topples alone. The result is False if the contact area is a
    point or a line. The result is also False if the body carries another body, leans, or stands on a body at rest
    (``is_resting``). In these cases live bodies may freeze together and hold each other.

    Args:
        graph: the stack.
        body: a body with present patches.
        support: the combined contact area of the body, shape (k, 3).
    """
    row, patches = graph.bodies[body], graph.patches
    if row.first_load != NONE:
        return False
    at = row.first_support
    while at != NONE:
        lower = patches[at].lower
        if patches[at].kind == LEAN or (lower != GROUND and graph.bodies[lower].is_resting):
            return False
        at = patches[at].next_support
    center = row.center
    return bool(len(support) > 2 and not is_inside(support, center[0], center[1]))
