"""Load a stack from zero prestress, layer by layer from the top down.

``loading`` displaces all bodies at once and factorises one matrix of all bodies. This module loads one cluster of
bodies after another, at the sum of the clusters' costs. Bodies that touch sideways form a cluster, because the bodies
may hold each other. The supports of a cluster do not give way. The contact forces of the cluster are loads of the
clusters below.

Proof: if contacts hold every cluster, the forces of all clusters lie in the Coulomb cones, balance all loads, and arise
without prestress. The contacts of lower layers behave as if they were far stiffer than the contacts of higher layers.

If contacts do not hold a cluster, a body on the cluster may hold the cluster, for example a counterweight. The module
then joins the cluster with the clusters on it, up to ``MOST_TOGETHER`` bodies. If contacts do not hold the joined
cluster either, the bodies of the first cluster are loose. The clusters below then bear the forces of a known
equilibrium in place of the forces of the loose bodies.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stability_core.compiled import compiled
from stability_core.equilibrium.compliance import COULOMB, Case, contact_law
from stability_core.equilibrium.envelope import envelope_of, numbering
from stability_core.equilibrium.held_clusters import HeldClusters, is_held_already, no_held_clusters, note_held
from stability_core.equilibrium.loading import NO_ROUNDS, SENSITIVE, STIFFNESSES, displace_step_by_step
from stability_core.equilibrium.problem import Problem, add_wrench, along_contacts
from stability_core.port import BoolArray, FloatArray, IntArray

SIDEWAYS = 0.17
"""Greatest vertical component of a unit normal at which a contact joins bodies sideways. The value is a slope of ten
degrees, because normals err by less (see ``compliance.NORMAL_NOISE``)."""
ALL_HELD, CYCLE = -1, -2
"""Results of a sweep other than a cluster:

- ALL_HELD: contacts hold all clusters that are not loose;
- CYCLE: the clusters without loads lie on each other in a cycle.
"""
MOST_TOGETHER = 12
"""Greatest number of bodies of a cluster together with the clusters on it, because loading more bodies at once costs as
much as ``loading``."""
MOST_IN_CYCLE = 50
"""Greatest number of bodies in a cycle that the module loads together, which limits the cost. The bodies of a larger
cycle count as loose."""
LIGHTER = 0.5
"""Least ratio of a body's load to its weight in a cluster that contacts hold. Below this ratio, the body would hang on
the bodies above."""


class Layers(NamedTuple):
    """The clusters of a problem, with the upper and the lower body of each contact."""

    cluster: IntArray
    """Cluster of each body: the least index of its bodies, shape (n,)."""
    upper: IntArray
    """Upper body of each contact by the normal, negative for a fixed body, shape (m,)."""
    lower: IntArray
    """Lower body of each contact, negative for a fixed body, shape (m,)."""


@compiled
def _clusters(problem: Problem) -> IntArray:
    """Return the cluster of each body, shape (n,): the bodies that sideways contacts join, directly or indirectly."""
    label = np.arange(len(problem.load))
    grows = True
    while grows:
        grows = False
        for c in range(len(problem.normal)):
            a, b = problem.body_a[c], problem.body_b[c]
            if a >= 0 and b >= 0 and abs(problem.normal[c, 2]) <= SIDEWAYS and label[a] != label[b]:
                label[a] = label[b] = min(label[a], label[b])
                grows = True
    return label


@compiled
def _layers_of(problem: Problem) -> Layers:
    upper, lower = problem.body_b.copy(), problem.body_a.copy()
    for c in range(len(upper)):
        if problem.normal[c, 2] < 0.0:
            upper[c], lower[c] = lower[c], upper[c]
    return Layers(_clusters(problem), upper, lower)


@compiled
def _grouped(label: IntArray, n: int) -> tuple[IntArray, IntArray]:
    """Return the start of each label's items in a list, shape (n + 1,), and the list of items, sorted by ``label``."""
    start = np.zeros(n + 1, np.int64)
    for i in range(len(label)):
        start[label[i] + 1] += 1
    for k in range(n):
        start[k + 1] += start[k]
    items, at = np.empty(len(label), np.int64), start.copy()
    for i in range(len(label)):
        items[at[label[i]]] = i
        at[label[i]] += 1
    return start, items


@compiled
def _owners(layers: Layers) -> IntArray:
    """Return the cluster of each contact, shape (m,): the cluster of the upper body, or of the only free body."""
    owner = np.empty(len(layers.upper), np.int64)
    for c in range(len(owner)):
        body = layers.upper[c] if layers.upper[c] >= 0 else layers.lower[c]  # without an upper body: wall or ceiling
        owner[c] = layers.cluster[body]
    return owner


@compiled
def _contacts_above(layers: Layers) -> IntArray:
    """Return the number of contacts of other clusters that lie on each cluster, shape (n,)."""
    number = np.zeros(len(layers.cluster), np.int64)
    for c in range(len(layers.upper)):
        upper, lower = layers.upper[c], layers.lower[c]
        if upper >= 0 and lower >= 0 and layers.cluster[upper] != layers.cluster[lower]:
            number[layers.cluster[lower]] += 1
    return number


@compiled
def _part(problem: Problem, members: IntArray, mine: IntArray, index: IntArray) -> Problem:
    """Return the problem of the ``members`` (k,) with the contacts ``mine`` (j,) and all other bodies fixed.

    ``index`` (n,) holds -1 for every body before and after the call.
    """
    j = len(mine)
    for i in range(len(members)):
        index[members[i]] = i
    body_a, body_b = np.empty(j, np.int64), np.empty(j, np.int64)
    for at in range(j):
        a, b = problem.body_a[mine[at]], problem.body_b[mine[at]]
        body_a[at] = index[a] if a >= 0 else -1
        body_b[at] = index[b] if b >= 0 else -1
    index[members] = -1
    return Problem(
        body_a,
        body_b,
        problem.lever_a[mine],
        problem.lever_b[mine],
        problem.normal[mine],
        problem.friction[mine],
        problem.load[members],
        problem.slack[members],
    )


@compiled
def _weighs_enough(own: FloatArray, load: FloatArray, members: IntArray) -> bool:
    for body in members:
        weight, now = 0.0, 0.0
        for k in range(3):
            weight += own[body, k] ** 2
            now += load[body, k] ** 2
        if not now >= LIGHTER**2 * weight:
            return False
    return True


@compiled
def _load(part: Problem, members: IntArray, load: FloatArray, force: FloatArray) -> bool:
    """Load one cluster for each of ``STIFFNESSES``, and return True if contacts hold the cluster each time.

    The result is also False if a body would hang on the bodies above (see ``LIGHTER``).

    Args:
        part: the problem of the cluster, k bodies and j contacts.
        members: the bodies of the cluster, shape (k,).
        load: loads of all bodies for each ratio of stiffnesses, shape (3, n, 6).
        force: output, the contact forces for each ratio, shape (3, j, 3).
    """
    k, j = len(members), len(part.normal)
    place = numbering(part.body_a, part.body_b, k)
    envelope = envelope_of(part.body_a, part.body_b, place, 6)
    u, v, tangent, bound = np.zeros((k, 6)), np.empty((j, 3)), np.empty((j, 3, 3)), np.full(j, COULOMB)
    for case in range(len(STIFFNESSES)):
        if not _weighs_enough(part.load, load[case][members], np.arange(k)):
            return False
        unit = 0.0
        for i in range(k):
            for h in range(3):
                unit += abs(load[case, members[i], h]) / k
        scaled = Problem(
            part.body_a,
            part.body_b,
            part.lever_a,
            part.lever_b,
            part.normal,
            part.friction,
            load[case][members] / unit,
            part.slack / unit,
        )
        loaded = Case(scaled, STIFFNESSES[case], bound, place, envelope)
        sensitivity = displace_step_by_step(loaded, u, NO_ROUNDS)  # starts from the solution of the last case
        if not sensitivity.max() <= SENSITIVE:
            return False
        along_contacts(scaled, u, v)
        contact_law(loaded, v, force[case], tangent)
        force[case] *= unit
    return True


@compiled
def _press(
    problem: Problem,
    layers: Layers,
    mine: IntArray,
    force: FloatArray,
    load: FloatArray,
    waits_for: IntArray,
    ready: IntArray,
    size: int,
) -> int:
    """Add the forces (3, j, 3) of the contacts ``mine`` to the loads (3, n, 6) of the clusters below.

    The function also adds the clusters that now have all their loads to the ``size`` clusters in ``ready``. Return the
    new number of clusters in ``ready``.
    """
    for at in range(len(mine)):
        c = mine[at]
        below, above = layers.lower[c], layers.upper[c]
        if below < 0 or above < 0 or layers.cluster[below] == layers.cluster[above]:
            continue
        for case in range(len(load)):
            if problem.body_a[c] == below:
                add_wrench(load[case, below], 1.0, force[case, at], problem.lever_a[c], 1.0)
            else:
                add_wrench(load[case, below], -1.0, force[case, at], problem.lever_b[c], 1.0)
        waits_for[layers.cluster[below]] -= 1
        if waits_for[layers.cluster[below]] == 0:
            ready[size] = layers.cluster[below]
            size += 1
    return size


@compiled
def _sweep(
    problem: Problem, layers: Layers, held: HeldClusters, known: FloatArray, loose: BoolArray, waits_for: IntArray
) -> int:
    """Load the clusters from the top down, and return ALL_HELD, CYCLE, or the first cluster that contacts do not hold.

    Args:
        problem: n bodies and m contacts.
        layers: the clusters.
        held: clusters that contacts held in earlier sweeps, which the sweep uses and completes.
        known: forces with which loose bodies press, shape (m, 3).
        loose: mask of the loose bodies, shape (n,).
        waits_for: output, number of contacts with unknown forces above each cluster, shape (n,).
    """
    n = len(problem.load)
    cluster, index = layers.cluster, np.full(n, -1, np.int64)
    of_body, bodies = _grouped(cluster, n)
    of_contact, contacts = _grouped(_owners(layers), n)
    load = np.empty((len(STIFFNESSES), n, 6))
    load[:] = problem.load
    waits_for[:], ready = _contacts_above(layers), np.empty(n, np.int64)
    left, size = 0, 0
    for root in range(n):
        left += cluster[root] == root
        if cluster[root] == root and waits_for[root] == 0:
            ready[size] = root
            size += 1
    while size > 0:
        size -= 1
        root = ready[size]
        members = bodies[of_body[root] : of_body[root + 1]]
        mine = contacts[of_contact[root] : of_contact[root + 1]]
        force = np.empty((len(STIFFNESSES), len(mine), 3))
        if loose[root]:
            force[:] = known[mine]
        elif is_held_already(held, root, members, load):
            force[:] = held.force[:, mine]
        elif _load(_part(problem, members, mine, index), members, load, force):
            note_held(held, root, members, load, mine, force)
        else:
            return int(root)
        size = _press(problem, layers, mine, force, load, waits_for, ready, size)
        left -= 1
    return ALL_HELD if left == 0 else CYCLE


@compiled
def _join(layers: Layers, root: int) -> bool:
    """Join a cluster with the clusters on it, and return True.

    Without clusters on it, or for more than ``MOST_TOGETHER`` bodies, the function joins nothing, and returns False.
    """
    cluster = layers.cluster
    joined = cluster.copy()
    for c in range(len(layers.upper)):
        upper, lower = layers.upper[c], layers.lower[c]
        if upper >= 0 and lower >= 0 and cluster[lower] == root and cluster[upper] != root:
            joined[cluster == cluster[upper]] = root
    size = np.count_nonzero(joined == root)
    if size == np.count_nonzero(cluster == root) or size > MOST_TOGETHER:
        return False
    least = np.flatnonzero(joined == root)[0]
    for body in range(len(cluster)):
        cluster[body] = least if joined[body] == root else joined[body]
    return True


@compiled
def _join_cycle(layers: Layers, waits_for: IntArray) -> int:
    """Join the clusters of a cycle, in which each cluster lies on another cluster, and return the union.

    A walk finds the cycle. The walk starts at a cluster that waits for loads. Each step leads to a waiting cluster on
    the present cluster. The walk ends at the first cluster that occurs twice.
    """
    cluster = layers.cluster
    seen = np.zeros(len(cluster), np.int64)  # number of the step at which the walk met a cluster
    walk = np.empty(len(cluster) + 1, np.int64)
    here, steps = 0, 0
    while cluster[here] != here or waits_for[here] <= 0:
        here += 1
    while seen[here] == 0:
        walk[steps] = here
        steps += 1
        seen[here] = steps
        for c in range(len(layers.upper)):
            upper, lower = layers.upper[c], layers.lower[c]
            if upper < 0 or lower < 0 or cluster[lower] != here or cluster[upper] == here:
                continue
            if waits_for[cluster[upper]] > 0:
                here = cluster[upper]
                break
    least = walk[seen[here] - 1 : steps].min()
    for body in range(len(cluster)):
        if seen[cluster[body]] >= seen[here]:
            cluster[body] = least
    return int(least)


@compiled
def loose_in_layers(problem: Problem, force: FloatArray) -> BoolArray:
    """Return the mask (n,) of the bodies that loading in layers fails to hold for at least one of ``STIFFNESSES``.

    All bodies of a cycle larger than ``MOST_IN_CYCLE`` count as loose.

    Args:
        problem: n bodies, each with a weight, and m contacts.
        force: forces of an equilibrium with the full friction, with which loose bodies press, shape (m, 3).
    """
    layers = _layers_of(problem)
    n = len(layers.cluster)
    loose, waits_for = np.zeros(n, np.bool_), np.empty(n, np.int64)
    held = no_held_clusters(n, len(problem.normal), len(STIFFNESSES))
    before, first = layers.cluster.copy(), 0  # clusters before the last unions, and the cluster without hold
    is_joined = False
    while True:
        root = _sweep(problem, layers, held, force, loose, waits_for)
        if root == ALL_HELD:
            return loose
        if root == CYCLE:
            root = _join_cycle(layers, waits_for)
            loose[layers.cluster == root] = np.count_nonzero(layers.cluster == root) > MOST_IN_CYCLE
            is_joined = False
            continue
        if not is_joined or layers.cluster[first] != root:
            before[:], first = layers.cluster, root
        is_joined = _join(layers, root)
        if not is_joined:
            layers.cluster[:] = before
            loose[before == first] = True
