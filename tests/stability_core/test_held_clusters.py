"""Forces of a cluster count as known only for the same bodies under the same loads, to the last bit."""

from __future__ import annotations

import numpy as np
import pytest

from stability_core.equilibrium.held_clusters import HeldClusters, is_held_already, no_held_clusters, note_held
from stability_core.port import FloatArray

BODIES, CONTACTS, RATIOS = 4, 5, 3
MEMBERS, MINE = np.array([1, 2]), np.array([0, 3])


@pytest.fixture
def load() -> FloatArray:
    return np.random.default_rng(1).normal(size=(RATIOS, BODIES, 6))


@pytest.fixture
def held(load: FloatArray) -> HeldClusters:
    """Bodies 1 and 2 form a cluster that contacts 0 and 3 hold."""
    table = no_held_clusters(BODIES, CONTACTS, RATIOS)
    note_held(table, 1, MEMBERS, load, MINE, np.ones((RATIOS, len(MINE), 3)))
    return table


def test_the_forces_of_a_held_cluster_are_kept(held, load):
    assert is_held_already(held, 1, MEMBERS, load)
    assert (held.force[:, MINE] == 1.0).all()


def test_no_cluster_is_known_before_it_was_held(load):
    assert not is_held_already(no_held_clusters(BODIES, CONTACTS, RATIOS), 1, MEMBERS, load)


@pytest.mark.parametrize("ratio", range(RATIOS))
@pytest.mark.parametrize("body", MEMBERS)
@pytest.mark.parametrize("component", range(6))
def test_the_least_change_of_a_load_counts(held, load, ratio, body, component):
    load[ratio, body, component] = np.nextafter(load[ratio, body, component], np.inf)
    assert not is_held_already(held, 1, MEMBERS, load)


def test_the_load_of_another_cluster_does_not_count(held, load):
    load[:, [0, 3]] += 1.0
    assert is_held_already(held, 1, MEMBERS, load)


@pytest.mark.parametrize("members", [[1], [1, 2, 3], [1, 3]])
def test_a_cluster_of_other_bodies_is_loaded_again(held, load, members):
    assert not is_held_already(held, 1, np.array(members), load)


def test_a_part_of_a_union_is_loaded_again(held, load):
    """A union of bodies 1, 2 and 3 was held after the pair: the kept forces belong to the union."""
    note_held(held, 1, np.array([1, 2, 3]), load, np.array([0, 3, 4]), np.zeros((RATIOS, 3, 3)))
    assert not is_held_already(held, 1, MEMBERS, load)
    assert is_held_already(held, 1, np.array([1, 2, 3]), load)
