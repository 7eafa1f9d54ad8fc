"""The choice of pairs: a forest that connects each group, and loops up to three joints a body."""

from collections import Counter
from itertools import combinations

from bench.welding.joints import new_joints
from bench.welding.settings import DEGREE


def test_a_forest_comes_first_and_loops_follow() -> None:
    ring = [(0, 1), (1, 2), (2, 3), (0, 3)]
    assert new_joints(ring, []) == ring
    assert new_joints([(0, 3), (0, 2)], [(0, 1), (1, 2)]) == [(0, 3), (0, 2)]


def test_a_body_that_connects_many_has_a_joint_to_each() -> None:
    star = [(0, other) for other in range(1, 9)]
    assert new_joints(star, []) == star


def test_loops_keep_to_the_greatest_degree() -> None:
    chosen = new_joints(list(combinations(range(10), 2)), [])
    degree = Counter(body for pair in chosen for body in pair)
    tree = [(0, other) for other in range(1, 10)]
    assert chosen[:9] == tree
    assert max(degree[body] for body in range(1, 10)) == DEGREE


def test_joints_that_exist_count() -> None:
    joined = [(0, 1), (0, 2), (0, 3)]
    assert new_joints([(1, 2)], joined) == [(1, 2)]
    assert new_joints([(0, 4)], joined) == [(0, 4)], "it connects a new body"
    assert new_joints([(0, 4)], [*joined, (3, 4)]) == [], "a loop, and body 0 has three joints"
