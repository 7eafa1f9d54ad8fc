"""Stack mass and stack centre, carried down through the graph (Thomsen and Kraus 2015, Eqs 1-5).

Each body carries its own mass and the loads of the bodies above. A body on one support puts its whole load on this
support. A body on several supports shares its load by one of the paper's three merge cases.
"""

from __future__ import annotations

import heapq

import numpy as np

from stability_core.compiled import compiled
from stability_core.polygon import convex_hull, lies_on
from stability_core.port import GROUND, FloatArray, IntArray
from stability_core.stack import MAX_VERTICES, NONE, SUPPORT, Graph, count_patches, hull_of, is_stack


@compiled
def support_polygon(graph: Graph, body: int) -> FloatArray:
    """Return the hull (k, 3) in plan of a body's load-bearing patches on the stack: its combined contact area."""
    bodies, patches = graph.bodies, graph.patches
    points = np.empty((MAX_VERTICES * count_patches(graph, body), 3))
    n, at = 0, bodies[body].first_support
    while at != NONE:
        patch = patches[at]
        if patch.kind == SUPPORT and is_stack(bodies, patch.lower):
            corners = hull_of(patch)
            for vertex in range(len(corners)):
                for k in range(3):
                    points[n, k] = corners[vertex, k]
                n += 1
        at = patch.next_support
    return convex_hull(points[:n])


@compiled
def pivot_of(graph: Graph, body: int) -> int:
    """Return the row of a leaning body's lowest patch, on which the body pivots, or NONE without patches."""
    patches = graph.patches
    lowest, height = NONE, np.inf
    at = graph.bodies[body].first_support
    while at != NONE:
        if patches[at].center[2] < height:
            lowest, height = at, patches[at].center[2]
        at = patches[at].next_support
    return lowest


@compiled
def nearest_vertex(hull: FloatArray, point: FloatArray) -> FloatArray:
    """Return the vertex (3,) of ``hull`` that is nearest to ``point`` in plan."""
    best, least = 0, np.inf
    for i in range(len(hull)):
        distance = np.hypot(hull[i, 0] - point[0], hull[i, 1] - point[1])
        if distance < least:
            best, least = i, distance
    nearest: FloatArray = hull[best]
    return nearest


@compiled
def equivalent_mass(mass: float, center: FloatArray, pivot: FloatArray, contact: FloatArray) -> float:
    """Return m_equiv [kg]: the share of a body's load that one of its two supports bears (Eqs 3-5).

    Gravity G acts at ``center`` and turns the body about ``pivot`` on the second support with the torque T. A vertical
    force F at ``contact`` balances this torque:

        T = (C_stack - P_pivot) x G,    |F| = |T| / (|C_contact - P_pivot| sin(theta)),    m_equiv = |F| / g

    Here theta is the angle between the lever and the force F, and g is the gravitational acceleration. All forces are
    vertical. Therefore |T| / |G| and |C_contact - P_pivot| sin(theta) are distances in plan. The shares
    of the two supports need not add up to the mass, because each share has its own pivot.

    Args:
        mass: m_stack [kg] of the upper body.
        center: C_stack [m] of the upper body, shape (3,).
        pivot: contact point [m] on the second support nearest to ``center``, shape (3,).
        contact: centre [m] of the contact area with the support that bears the share, shape (3,).

    Returns:
        The share [kg], or half of ``mass`` if ``contact`` and ``pivot`` have the same place in plan.
    """
    torque = np.hypot(center[0] - pivot[0], center[1] - pivot[1])
    lever = np.hypot(contact[0] - pivot[0], contact[1] - pivot[1])
    if lever == 0.0:  # both supports meet in one point, so that neither support has a lever
        return 0.5 * mass
    return float(mass * torque / lever)


@compiled
def share_on(graph: Graph, at: int) -> tuple[float, float, float, float]:
    """Return the load of the upper body of patch ``at`` on the lower body: mass [kg], and its point x, y, z [m].

    - Single branch: the whole load, at C_stack.
    - Merge branch, C_stack in the contact area of one support: the whole load on this support, at C_stack.
    - Merge branch, other cases with two supports: the equivalent mass, at the centre of the contact area.
    - Merge branch, other cases with more supports: equal shares, at the centre of each contact area.
    - Leaning body: the whole load on the pivot, at the contact point nearest to C_stack. This rule is an
      addition, because the paper does not describe how a leaning body passes its load down.

    A patch that bears none of these loads gets the mass zero.
    """
    bodies, patches = graph.bodies, graph.patches
    patch = patches[at]
    upper = bodies[patch.upper]
    mass, center, contact = upper.stack_mass, upper.stack_center, patch.center
    if upper.leans:
        if at == pivot_of(graph, patch.upper):
            foot = nearest_vertex(hull_of(patch), center)
            return mass, foot[0], foot[1], foot[2]
        return 0.0, 0.0, 0.0, 0.0
    if patch.kind != SUPPORT:
        return 0.0, 0.0, 0.0, 0.0
    supports, bearer, other = 0, NONE, NONE
    i = upper.first_support
    while i != NONE:
        if patches[i].kind == SUPPORT:
            supports += 1
            if bearer == NONE and lies_on(hull_of(patches[i]), center[0], center[1]):
                bearer = i
            if i != at:
                other = i
        i = patches[i].next_support
    if supports == 1 or bearer != NONE:
        borne = mass if supports == 1 or bearer == at else 0.0
        return borne, center[0], center[1], center[2]
    share = mass / supports
    if supports == 2:
        pivot = nearest_vertex(hull_of(patches[other]), center)
        share = equivalent_mass(mass, center, pivot, contact)
    return share, contact[0], contact[1], contact[2]


@compiled
def stack_above(graph: Graph, body: int) -> tuple[float, float, float, float]:
    """Return m_stack [kg] and C_stack: x, y, z [m], of a body with all its loads (Eqs 2 and 1).

    The paper gives the equations for one body above. The function sums over all bodies above (split branch):

    m_stack = m_obj + sum m_above,    C_stack = (C_obj m_obj + sum C_above m_above) / m_stack

    Here m_obj and C_obj are mass and centre of the body, and m_above and C_above are mass and point of each load.
    """
    bodies, patches = graph.bodies, graph.patches
    row = bodies[body]
    mass, center = row.mass, row.center
    x, y, z = center[0] * mass, center[1] * mass, center[2] * mass
    at = row.first_load
    while at != NONE:
        share, share_x, share_y, share_z = share_on(graph, at)
        mass += share
        x, y, z = x + share_x * share, y + share_y * share, z + share_z * share
        at = patches[at].next_load
    return mass, x / mass, y / mass, z / mass


@compiled
def carry_down(graph: Graph, changed: IntArray) -> IntArray:
    """Carry mass and centre down from the ``changed`` bodies, and return all affected bodies, (k,).

    The function updates the highest body first, and each body once. A branch ends at a body whose stack data do not
    change. The cost is O(k log k) for the k affected bodies, besides two arrays with an entry for each row of the
    table.
    """
    bodies, patches = graph.bodies, graph.patches
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
        row = bodies[body]
        mass, x, y, z = stack_above(graph, body)
        center = row.stack_center
        same = mass == row.stack_mass and x == center[0] and y == center[1] and z == center[2]
        row.stack_mass, center[0], center[1], center[2] = mass, x, y, z
        at = row.first_support
        while at != NONE:
            lower = patches[at].lower
            if lower != GROUND and not queued[lower] and not same:
                queued[lower] = True
                heapq.heappush(waiting, (-bodies[lower].center[2], lower))
            at = patches[at].next_support
    return reached[:n]
