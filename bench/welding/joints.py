"""Choice of the pairs to join: a forest that connects each group, and some loops."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence

from bench.welding.settings import DEGREE

Pair = tuple[int, int]
"""Two bodies, the smaller id first."""


def new_joints(candidates: Sequence[Pair], joined: Iterable[Pair]) -> list[Pair]:
    """Return the candidates to join.

    The function first chooses every candidate that connects two groups. All other candidates close a loop. The function
    chooses a candidate that closes a loop if both bodies have fewer than ``DEGREE`` joints.

    Args:
        candidates: pairs that may be joined, in the order of their preference.
        joined: pairs that are joined.
    """
    group: dict[int, int] = {}
    degree: Counter[int] = Counter()
    for a, b in joined:
        degree.update((a, b))
        group[_root(group, a)] = _root(group, b)
    chosen: list[Pair] = []
    loops: list[Pair] = []
    for pair in candidates:
        root_a, root_b = (_root(group, body) for body in pair)
        if root_a == root_b:
            loops.append(pair)
            continue
        group[root_a] = root_b
        degree.update(pair)
        chosen.append(pair)
    for pair in loops:
        if max(degree[body] for body in pair) < DEGREE:
            degree.update(pair)
            chosen.append(pair)
    return chosen


def _root(group: dict[int, int], body: int) -> int:
    """Return the body that represents the group of ``body``, and shorten the path to this body."""
    root = body
    while group.setdefault(root, root) != root:
        root = group[root]
    while group[body] != root:
        group[body], body = root, group[body]
    return root
