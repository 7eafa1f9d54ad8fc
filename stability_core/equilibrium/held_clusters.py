"""Keep the forces of the clusters that contacts hold, so that the next sweep of ``layers`` need not load them again.

The forces of a cluster depend on nothing but its bodies and the loads on these bodies, because its supports do not give
way. Therefore the kept forces are those that loading would find again.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stability_core.compiled import compiled
from stability_core.port import FloatArray, IntArray


class HeldClusters(NamedTuple):
    """The latest cluster of each body that contacts held, with its loads and forces."""

    cluster: IntArray
    """Cluster of each body when contacts last held the body, or -1, shape (n,)."""
    size: IntArray
    """Number of bodies of each cluster when contacts last held the cluster, or 0, shape (n,)."""
    load: FloatArray
    """Load of each body for each ratio of stiffnesses, shape (ratios, n, 6)."""
    force: FloatArray
    """Force of each contact for each ratio of stiffnesses, shape (ratios, m, 3)."""


@compiled
def no_held_clusters(bodies: int, contacts: int, ratios: int) -> HeldClusters:
    """Return the table before the first sweep over ``bodies`` bodies and ``contacts`` contacts."""
    return HeldClusters(
        np.full(bodies, -1, np.int64),
        np.zeros(bodies, np.int64),
        np.empty((ratios, bodies, 6)),
        np.empty((ratios, contacts, 3)),
    )


@compiled
def is_held_already(held: HeldClusters, root: int, members: IntArray, load: FloatArray) -> bool:
    """Return True if contacts held the cluster ``root`` of the same ``members`` (k,) under the same loads.

    ``load`` (ratios, n, 6) are the present loads of all n bodies. Equal means equal to the last bit.
    """
    is_same = held.size[root] == len(members)
    for body in members:
        is_same &= held.cluster[body] == root
        for ratio in range(len(load)):
            for k in range(6):
                is_same &= held.load[ratio, body, k] == load[ratio, body, k]
    return bool(is_same)


@compiled
def note_held(
    held: HeldClusters, root: int, members: IntArray, load: FloatArray, mine: IntArray, force: FloatArray
) -> None:
    """Record that contacts hold a cluster.

    Args:
        held: the table.
        root: the cluster.
        members: the bodies of the cluster, shape (k,).
        load: loads of all bodies, shape (ratios, n, 6).
        mine: the contacts of the cluster, shape (j,).
        force: the forces of these contacts, shape (ratios, j, 3).
    """
    held.size[root] = len(members)
    held.cluster[members] = root
    held.load[:, members] = load[:, members]
    held.force[:, mine] = force
