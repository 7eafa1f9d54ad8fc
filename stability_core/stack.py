"""The stack as a graph in two flat tables: bodies, and the contact patches that join them.

A patch joins an upper body to its support or leaning partner. Each body has two linked lists of patches: for its
supports and for its loads. The cost of adding or removing a patch depends on the neighbours of both bodies, not on
the height of the stack. A frozen pair keeps its patch, because engines may drop contacts of frozen pairs.
"""

from __future__ import annotations

from typing import Any, NamedTuple, TypeAlias

import numpy as np

from stability_core.compiled import compiled
from stability_core.port import GROUND, FloatArray, IntArray

ABSENT, LIVE, FROZEN, FIXED, MOVING = range(5)
"""A body's ``state``. FIXED and MOVING are for kinematic bodies."""
SUPPORT, LEAN = 0, 1
PROVEN, IN_DOUBT, NOTED = 0, 1, 2
"""A body's ``doubt``. NOTED is for a body in doubt after the core has recorded its surroundings, to detect changes."""
NOT_REFUSED, TOPPLES, FALLS, DOUBTED = 0, 1, 2, 3
"""A body's ``refusal``: the policy's reason for the last refusal to freeze the body."""
NONE = -1
"""End of a linked list."""
FEW = 16
"""Number of ids up to which ``sorted_ids`` sorts by insertion, because insertion is faster for few ids."""
MAX_VERTICES = 16
"""Greatest number of vertices of a patch: twice the 8 of a box on a box, because the points of frames differ."""

Bodies: TypeAlias = Any
"""Structured array of ``BODY``, with one row per body: see ``rows``. The kernels denote a body by its row."""
Patches: TypeAlias = Any
"""Structured array of ``PATCH``, one row per contact patch."""

BODY = np.dtype(
    [
        ("state", "i1"),  # ABSENT, LIVE, FROZEN, FIXED or MOVING
        ("id", "i8"),  # its id at the port
        ("held", "?"),  # True while a user holds it, so that it stays live
        ("mass", "f8"),  # [kg], infinite for kinematic bodies
        ("blow", "f8"),  # slide that the blows of the latest frame would cause [m]
        ("slid", "f8"),  # sum of these slides since its freezing [m]; infinite for a hard blow
        ("center", "f8", (3,)),  # centre of mass [m]: C_obj of Eq. 1
        ("size", "f8"),  # distance from the centre of mass to the farthest contact point so far [m]
        ("least_load", "f8"),  # of a kinematic body: size of the smallest body that has touched it [m]
        ("swept", "f8"),  # of a kinematic body: path of its surface below frozen bodies since its last move [m]
        ("sweep", "f8"),  # of a kinematic body: greatest speed of that surface in this frame [m/s]
        # the mean push of live bodies on a frozen body: see ``pushes``
        ("push", "f8", (3,)),  # [N]
        ("push_began_s", "f8"),  # start of the push [s]
        ("pushed_s", "f8"),  # time of the latest push [s]
        ("push_judged", "f8", (3,)),  # push in the last judgement of its balance [N]
        ("push_judged_s", "f8"),  # time of that judgement [s]
        # motion and contacts in the latest frame
        ("speed", "f8"),  # of the centre of mass [m/s]
        ("slip", "f8"),  # fastest sliding at a contact [m/s]
        ("depth", "f8"),  # deepest penetration into a support [m]
        ("depth_before", "f8"),  # deepest penetration in the frame before [m]
        ("touches", "?"),  # True if it touches the ground, a FIXED body or a frozen body
        ("supported_by", "u8"),  # its supports as a set of 64 bits (see ``contact_filter.bit_of``)
        ("neighbours", "u8"),  # all bodies that it touches, as a set of 64 bits
        ("frozen_neighbours", "u8"),  # the ground, and the FIXED and frozen bodies that it touches
        # durations [s] up to the latest frame
        ("rest_s", "f8"),  # at rest by the strict rule
        ("still_s", "f8"),  # in its place, at any depth, perhaps with small vibrations
        ("still_center", "f8", (3,)),  # centre of mass at the start of ``still_s`` [m]
        ("lean_s", "f8"),  # at rest by the rule for leaning
        ("load_s", "f8"),  # slow enough to lie on its support
        ("unsettled", "?"),  # unfrozen, and since then neither moving nor calm for ``calm_s``
        ("idle_s", "f8"),  # at rest by the strict rule, with any or no contacts
        ("is_resting", "?"),  # at rest for as long as freezing requires
        ("wakes", "i8"),  # number of unfreezings since it was last in flight
        ("restless", "i8"),  # greatest ``wakes`` of a body that it touches, in the latest frame
        ("quiet_s", "f8"),  # since the latest blow on a restless body joined to it by contacts of live bodies
        ("quiet_before_s", "f8"),  # the same before the contacts of the latest frame [s]
        ("carrier_normal", "f8", (3,)),  # sum of the normals from the kinematic bodies that touch it, in this frame
        ("still_normal", "f8", (3,)),  # unit direction of that sum when it last turned by ``steady_shift``
        # duration in its place among the same neighbours
        ("steady_s", "f8"),  # [s]
        ("steady_center", "f8", (3,)),  # centre of mass at the start of ``steady_s`` [m]
        ("steady_neighbours", "u8"),
        ("lately", "u8"),  # all bodies that it touched in the latest ``lately_s``
        ("lately_s", "f8"),  # [s]
        # doubt: PROVEN, or IN_DOUBT and then NOTED for a body frozen without a proof
        ("doubt", "i1"),
        ("refusal", "i1"),  # NOT_REFUSED, TOPPLES, FALLS or DOUBTED
        ("refusals", "i8"),  # number of refusals, each after a change around it, since it was last frozen or in flight
        ("not_before_s", "f8"),  # time before which the policy does not judge it again [s]
        ("refused_among", "u8"),  # its frozen neighbours at the last refusal
        ("deferred", "?"),  # on the worklist, but beyond the budget: judged in the next frame
        # a live body on the stack with patches in the graph
        ("is_load", "?"),
        ("load_center", "f8", (3,)),  # centre of mass for which the patches were built [m]
        ("load_supported_by", "u8"),  # supports for which the patches were built, as ``supported_by``
        ("load_steady_s", "f8"),  # ``steady_s`` at the time when the patches were built [s]
        ("stood_on", "u8"),  # all supports in the latest ``stood_on_s``, as ``supported_by``
        ("stood_on_s", "f8"),  # [s]
        ("shifts", "i8"),  # number of new patches because it had moved, since it came to lie on its supports
        ("provisional", "?"),  # it touches or carries live bodies, so that its patches change when it freezes
        # scratch of one frame
        ("rule", "i1"),  # its strictest rule: AT_REST, LEANING or LYING
        ("place", "i8"),  # its place in the current list
        # the paper's stack data
        ("stack_mass", "f8"),  # m_stack of Eq. 2 [kg]: of the body and all its loads
        ("stack_center", "f8", (3,)),  # C_stack of Eq. 1 [m]
        ("leans", "?"),  # frozen by the leaning test
        # the graph
        ("first_support", "i8"),
        ("first_load", "i8"),
        ("changed", "?"),  # listed in ``Graph.changed``, because the core must judge its balance again
    ],
    align=True,
)

PATCH = np.dtype(
    [
        ("upper", "i8"),  # the body that stands or leans
        ("lower", "i8"),  # its support or leaning partner, or GROUND
        ("kind", "i1"),  # SUPPORT for a load-bearing contact, else LEAN
        ("vertices", "i8"),
        ("vertex", "f8", (MAX_VERTICES, 3)),  # hull of the contact points [m], counter-clockwise
        ("center", "f8", (3,)),  # centroid of the hull [m]: C_contact of Eq. 4
        ("width", "f8"),  # least width of the hull [m]; 0 for a point or a line
        ("normal", "f8", (3,)),  # unit normal, towards the upper body
        ("friction", "f8"),
        ("next_support", "i8"),  # next patch below the same upper body
        ("next_load", "i8"),  # next patch above the same lower body
    ],
    align=True,
)


class Graph(NamedTuple):
    """The tables of bodies and patches, with their lists of free and changed rows.

    ADR-0002 gives the reason why loops take a table out of this tuple first.
    """

    bodies: Bodies
    patches: Patches
    spare: IntArray
    """Free rows of ``patches``: their number, then the rows, shape (1 + len(patches),)."""
    changed: IntArray
    """Bodies with changed patches, mass or gravity since the last ``take_changed``: their number, then rows, shape
    (1 + bodies,)."""


@compiled
def hull_of(patch: Patches) -> FloatArray:
    """Return the patch's hull, shape (vertices, 3) [m]."""
    hull: FloatArray = patch.vertex[: patch.vertices]
    return hull


@compiled
def is_ground(bodies: Bodies, body: int) -> bool:
    """Return True for the ground and for FIXED bodies, which no force moves."""
    return bool(body == GROUND or bodies[body].state == FIXED)


@compiled
def is_immovable(bodies: Bodies, body: int) -> bool:
    """Return True for the ground and for kinematic bodies, FIXED or MOVING."""
    return bool(body == GROUND or bodies[body].state == FIXED or bodies[body].state == MOVING)


@compiled
def is_stack(bodies: Bodies, body: int) -> bool:
    """Return True if other bodies may freeze on ``body``: the ground, a FIXED body or a frozen body."""
    return bool(body == GROUND or bodies[body].state == FROZEN or bodies[body].state == FIXED)


@compiled
def count_patches(graph: Graph, body: int) -> int:
    """Return the number of patches on which ``body`` stands or leans."""
    patches = graph.patches
    n, at = 0, graph.bodies[body].first_support
    while at != NONE:
        n += 1
        at = patches[at].next_support
    return n


@compiled
def note_change(graph: Graph, body: int) -> None:
    """List ``body`` as changed."""
    row = graph.bodies[body]
    if not row.changed:
        row.changed = True
        listed = graph.changed
        listed[0] += 1
        listed[listed[0]] = body


@compiled
def sorted_ids(ids: IntArray) -> IntArray:
    """Return a sorted copy of ``ids``, shape (k,)."""
    if len(ids) > FEW:
        return np.sort(ids)
    ordered = np.empty(len(ids), np.int64)
    for size in range(len(ids)):
        place = size
        while place > 0 and ordered[place - 1] > ids[size]:
            ordered[place] = ordered[place - 1]
            place -= 1
        ordered[place] = ids[size]
    return ordered


@compiled
def take_changed(graph: Graph) -> IntArray:
    """Return the bodies listed as changed, by rising row, shape (k,), and empty the list: O(k log k)."""
    bodies, listed = graph.bodies, graph.changed
    changed = sorted_ids(listed[1 : 1 + listed[0]])
    listed[0] = 0
    for body in changed:
        bodies[body].changed = False
    return changed


@compiled
def link(graph: Graph, upper: int, lower: int, kind: int) -> Patches:
    """Add a patch of an upper and a lower body to the lists of both bodies, and return the new patch."""
    bodies, spare = graph.bodies, graph.spare
    at = spare[spare[0]]
    spare[0] -= 1
    patch = graph.patches[at]
    patch.upper, patch.lower, patch.kind = upper, lower, kind
    patch.next_support, patch.next_load = bodies[upper].first_support, NONE
    bodies[upper].first_support = at
    note_change(graph, upper)
    if lower != GROUND:
        patch.next_load = bodies[lower].first_load
        bodies[lower].first_load = at
        note_change(graph, lower)
    return patch


@compiled
def unlink(graph: Graph, at: int) -> None:
    """Remove a patch from the lists of both bodies, and free its row."""
    bodies, patches, spare = graph.bodies, graph.patches, graph.spare
    upper, lower = patches[at].upper, patches[at].lower
    i = bodies[upper].first_support
    if i == at:
        bodies[upper].first_support = patches[at].next_support
    else:
        while patches[i].next_support != at:
            i = patches[i].next_support
        patches[i].next_support = patches[at].next_support
    note_change(graph, upper)
    if lower != GROUND:
        i = bodies[lower].first_load
        if i == at:
            bodies[lower].first_load = patches[at].next_load
        else:
            while patches[i].next_load != at:
                i = patches[i].next_load
            patches[i].next_load = patches[at].next_load
        note_change(graph, lower)
    spare[0] += 1
    spare[spare[0]] = at


@compiled
def note_change_of_supports(graph: Graph, body: int) -> None:
    """List ``body`` and its supports and leaning partners as changed."""
    patches = graph.patches
    note_change(graph, body)
    at = graph.bodies[body].first_support
    while at != NONE:
        if patches[at].lower != GROUND:
            note_change(graph, patches[at].lower)
        at = patches[at].next_support


@compiled
def drop_supports(graph: Graph, body: int) -> None:
    """Remove the patches on which ``body`` stands and leans."""
    row = graph.bodies[body]
    while row.first_support != NONE:
        unlink(graph, row.first_support)


@compiled
def drop_loads(graph: Graph, body: int) -> None:
    """Remove the patches of the bodies that stand on ``body`` or lean against it."""
    row = graph.bodies[body]
    while row.first_load != NONE:
        unlink(graph, row.first_load)


@compiled
def drop_frozen_loads(graph: Graph, unfrozen: IntArray) -> int:
    """Remove the patches of frozen bodies on the ``unfrozen`` bodies (k,), and return their number.

    The frozen bodies count as changed, so that the policy judges them again without these patches.
    """
    bodies, patches = graph.bodies, graph.patches
    dropped = 0
    for body in unfrozen:
        at = bodies[body].first_load
        while at != NONE:
            here, at = at, patches[at].next_load
            if bodies[patches[here].upper].state == FROZEN:
                unlink(graph, here)
                dropped += 1
    return dropped


@compiled
def axes_of(normal: FloatArray) -> FloatArray:
    """Return right-handed perpendicular unit vectors as rows, shape (3, 3). The last row is the unit ``normal``."""
    axes = np.zeros((3, 3))
    least = 0
    for k in range(1, 3):
        if abs(normal[k]) < abs(normal[least]):
            least = k
    first, second, third = axes[0], axes[1], axes[2]
    first[least] = 1.0
    length = np.sqrt(1.0 - normal[least] ** 2)
    for k in range(3):
        third[k] = normal[k]
        first[k] = (first[k] - normal[least] * normal[k]) / length
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        second[k] = third[i] * first[j] - third[j] * first[i]
    return axes


@compiled
def is_in_doubt(bodies: Bodies, body: int) -> bool:
    """Return True for a frozen body without a proof."""
    return bool(bodies[body].state == FROZEN and bodies[body].doubt != PROVEN)


@compiled
def with_all_above(graph: Graph, roots: IntArray) -> IntArray:
    """Return ``roots`` and each frozen body on them, directly or through other bodies of the result, shape (k,).

    A body is on another body if it stands or leans on this body.

    The result also includes each body in doubt that bears a body of the result. A body in doubt may need its neighbours
    to stand.
    """
    reached = np.zeros(len(graph.bodies), np.bool_)
    found = np.empty(len(graph.bodies), np.int64)
    size = 0
    for root in roots:
        if not reached[root]:
            reached[root] = True
            found[size] = root
            size += 1
    done = 0
    while done < size:
        at = graph.bodies[found[done]].first_load
        while at != NONE:
            upper = graph.patches[at].upper
            if not reached[upper] and graph.bodies[upper].state == FROZEN:
                reached[upper] = True
                found[size] = upper
                size += 1
            at = graph.patches[at].next_load
        at = graph.bodies[found[done]].first_support
        while at != NONE:
            lower = graph.patches[at].lower
            if lower != GROUND and not reached[lower] and is_in_doubt(graph.bodies, lower):
                reached[lower] = True
                found[size] = lower
                size += 1
            at = graph.patches[at].next_support
        done += 1
    return found[:size]


@compiled
def around(graph: Graph, roots: IntArray, hops: int) -> IntArray:
    """Return ``roots`` and the frozen bodies within ``hops`` contacts of them, shape (k,)."""
    bodies, patches = graph.bodies, graph.patches
    reached = np.zeros(len(bodies), np.bool_)
    found = np.empty(len(bodies), np.int64)
    size = 0
    for root in roots:
        if not reached[root]:
            reached[root] = True
            found[size] = root
            size += 1
    done = 0
    for _ in range(hops):
        border = size
        while done < border:
            for upwards in range(2):
                at = bodies[found[done]].first_load if upwards else bodies[found[done]].first_support
                while at != NONE:
                    patch = patches[at]
                    other = patch.upper if upwards else patch.lower
                    at = patch.next_load if upwards else patch.next_support
                    if other != GROUND and not reached[other] and bodies[other].state == FROZEN:
                        reached[other] = True
                        found[size] = other
                        size += 1
            done += 1
    return found[:size]


def empty_graph() -> Graph:
    """Return a graph without bodies and patches."""
    return Graph(np.zeros(0, BODY), np.zeros(0, PATCH), np.zeros(1, np.int64), np.zeros(1, np.int64))


def _longer(table: Any, rows: int, used: IntArray | slice) -> Any:
    """Return a table with ``rows`` rows and a copy of the ``used`` rows. All other rows are zero."""
    longer = np.zeros(rows, table.dtype)
    longer[used] = table[used]
    return longer


def grown(graph: Graph, bodies: int, spare: int) -> Graph:
    """Return the graph with at least ``bodies`` rows of bodies and at least ``spare`` free patches.

    The size of a table at least doubles, so that growth costs O(1) per row in the long run.
    """
    body_rows, patch_rows, free, changed = graph
    if bodies <= len(body_rows) and spare <= free[0]:
        return graph
    if bodies > len(body_rows):
        old = len(body_rows)
        body_rows = _longer(body_rows, max(bodies, 2 * old, 64), slice(old))
        body_rows["first_support"][old:] = body_rows["first_load"][old:] = NONE
        changed = _longer(changed, 1 + len(body_rows), slice(len(changed)))
    if spare > free[0]:
        old, listed = len(patch_rows), free[1 : 1 + free[0]]
        added = max(spare, old, 256)
        is_used = np.ones(old, np.bool_)
        is_used[listed] = False
        patch_rows = _longer(patch_rows, old + added, np.flatnonzero(is_used))
        free = np.zeros(1 + len(patch_rows), np.int64)
        free[0] = len(listed) + added
        free[1 : 1 + free[0]] = np.concatenate([listed, np.arange(old, old + added)])
    return Graph(body_rows, patch_rows, free, changed)
