"""Stack mass and stack centre, carried down through the graph (Thomsen and Kraus 2015, Eqs 1-5).

Each body carries itself and what the bodies above lay on it. A body on one support lays all on it; a
body on several shares its weight by one of the paper's three merge cases.
"""

from __future__ import annotations

import heapq

import numpy as np

from stability_core.compiled import compiled
from stability_core.polygon import convex_hull, inside_distance
from stability_core.port import GROUND, FloatArray, IntArray
from stability_core.stack import MAX_VERTICES, NONE, SUPPORT, Graph, count_patches, hull_of, is_stack


@compiled
def supports_of(graph: Graph, body: int, on_stack: bool) -> IntArray:
    """The patches on which ``body`` stands, shape (k,); with ``on_stack`` those on ground and frozen bodies only."""
    bodies, patches = graph.bodies, graph.patches
    found = np.empty(count_patches(graph, body), np.int64)
    n, at = 0, bodies[body].first_support
    while at != NONE:
        patch = patches[at]
        if patch.kind == SUPPORT and (is_stack(bodies, patch.lower) or not on_stack):
            found[n] = at
            n += 1
        at = patch.next_support
    return found[:n]


@compiled
def support_polygon(graph: Graph, body: int) -> FloatArray:
    """The combined contact area: hull (k, 3) in plan of all patches on which ``body`` stands on the stack."""
    patches = graph.patches
    supports = supports_of(graph, body, True)
    points = np.empty((MAX_VERTICES * len(supports), 3))
    n = 0
    for at in supports:
        corners = hull_of(patches[at])
        for vertex in range(len(corners)):
            for k in range(3):
                points[n, k] = corners[vertex, k]
            n += 1
    return convex_hull(points[:n])


@compiled
def pivot_of(graph: Graph, body: int) -> int:
    """The lowest patch of a leaning body, on which it pivots; NONE if it has none."""
    lowest, height = NONE, np.inf
    at = graph.bodies[body].first_support
    while at != NONE:
        if graph.patches[at].center[2] < height:
            lowest, height = at, graph.patches[at].center[2]
        at = graph.patches[at].next_support
    return lowest


@compiled
def nearest_vertex(hull: FloatArray, point: FloatArray) -> FloatArray:
    """The contact point (3,) that is closest to ``point`` in plan."""
    best, least = 0, np.inf
    for i in range(len(hull)):
        distance = np.hypot(hull[i, 0] - point[0], hull[i, 1] - point[1])
        if distance < least:
            best, least = i, distance
    nearest: FloatArray = hull[best].copy()
    return nearest


@compiled
def equivalent_mass(mass: float, center: FloatArray, pivot: FloatArray, contact: FloatArray) -> float:
    """m_equiv [kg]: what a body resting on two supports lays on one of them (Eqs 3-5).

    Gravity G acts at ``center`` and turns the body about ``pivot`` on the other support,
    T = (C_stack - P_pivot) x G. A vertical force F at ``contact`` balances it:
    |F| = |T| / (|C_contact - P_pivot| sin(theta)), and m_equiv = |F| / g. With all forces vertical both
    products are plan distances. The two shares need not sum to the mass: each has its own pivot.

    Args:
        mass: m_stack of the body above [kg].
        center: its C_stack [m], shape (3,).
        pivot: contact point on the other support closest to ``center`` [m], shape (3,).
        contact: centre of the contact area with the support that is updated [m], shape (3,).
    """
    torque = np.hypot(center[0] - pivot[0], center[1] - pivot[1])
    lever = np.hypot(contact[0] - pivot[0], contact[1] - pivot[1])
    if lever == 0.0:  # both supports meet in one point: neither has a lever over the other
        return 0.5 * mass
    return float(mass * torque / lever)


@compiled
def share_on(graph: Graph, at: int) -> tuple[float, FloatArray]:
    """What the upper body of patch ``at`` lays on the lower one: mass [kg] and where it acts [m], (3,).

    Single branch: all of it, at C_stack. Merge branch: all on the support whose own area C_stack is in;
    else, of two supports, the equivalent mass at the contact's centre; of more, equal shares there.
    A leaning body stands on its pivot with all its weight, at the contact point closest to its C_stack:
    the paper is silent on how a leaning load is carried down.
    """
    patch = graph.patches[at]
    upper = graph.bodies[patch.upper]
    mass, center, contact = upper.stack_mass, upper.stack_center.copy(), patch.center.copy()
    if upper.leans:
        if at == pivot_of(graph, patch.upper):
            return mass, nearest_vertex(hull_of(patch), center)
        return 0.0, contact
    if patch.kind != SUPPORT:
        return 0.0, contact
    supports = supports_of(graph, patch.upper, False)
    if len(supports) == 1:
        return mass, center
    for other in supports:
        if inside_distance(hull_of(graph.patches[other]), center[0], center[1]) >= 0.0:
            return (mass if other == at else 0.0), center
    if len(supports) == 2:
        other = supports[0] if supports[1] == at else supports[1]
        pivot = nearest_vertex(hull_of(graph.patches[other]), center)
        return equivalent_mass(mass, center, pivot, contact), contact
    return mass / len(supports), contact


@compiled
def stack_above(graph: Graph, body: int) -> tuple[float, FloatArray]:
    """m_stack [kg] and C_stack [m], (3,), of a body and all that it carries (Eqs 2 and 1).

    m_stack = m_obj + sum m_above, C_stack = (C_obj m_obj + sum C_above m_above) / m_stack: the paper's
    equations for one body above, used for every body that rests on this one (split branch).
    """
    mass = graph.bodies[body].mass
    moment = graph.bodies[body].center * mass
    at = graph.bodies[body].first_load
    while at != NONE:
        share, where = share_on(graph, at)
        mass += share
        moment = moment + where * share
        at = graph.patches[at].next_load
    return mass, moment / mass


@compiled
def carry_down(graph: Graph, changed: IntArray) -> IntArray:
    """Carry mass and centre down from the ``changed`` bodies; returns all bodies to look at again, (k,).

    Highest first, so that each body is worked once; a branch ends where nothing changes any more.
    O(k log k) for the k bodies in the cone below the change, whatever stands elsewhere.
    """
    bodies = graph.bodies
    waiting = [(0.0, 0) for _ in range(0)]
    queued = np.zeros(len(bodies), np.bool_)
    for body in changed:
        queued[body] = True
        heapq.heappush(waiting, (-bodies[body].center[2], body))
    reached = np.empty(len(bodies), np.int64)
    n = 0
    while len(waiting) > 0:
        body = heapq.heappop(waiting)[1]
        reached[n] = body
        n += 1
        old_mass, old_center = bodies[body].stack_mass, bodies[body].stack_center.copy()
        mass, center = stack_above(graph, body)
        bodies[body].stack_mass = mass
        same = mass == old_mass
        for k in range(3):
            bodies[body].stack_center[k] = center[k]
            same = same and center[k] == old_center[k]
        at = bodies[body].first_support
        while at != NONE:
            lower = graph.patches[at].lower
            if lower != GROUND and not queued[lower] and not same:
                queued[lower] = True
                heapq.heappush(waiting, (-bodies[lower].center[2], lower))
            at = graph.patches[at].next_support
    return reached[:n]
