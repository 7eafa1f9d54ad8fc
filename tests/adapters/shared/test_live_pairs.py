"""The pairs of live bodies: each once, whether an engine is asked for all pairs or for those of each live body."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from adapters.shared.bodies import Bodies
from adapters.shared.live_pairs import live_pairs, of_live
from scenarios.model import Brick
from stability_core.port import GROUND, Contacts

COUNT = 8
PAIRS = [(GROUND, 0), (1, 0), (2, 1), (1, 3), (5, 4), (6, 5), (GROUND, 6), (7, 2)]
"""What an engine lists, in its own order and with its own first bodies."""


def bodies_with_live(live: set[int]) -> Bodies:
    bodies = Bodies()
    for _ in range(COUNT):
        bodies.add(bodies.new_id(), Brick((1.0, 1.0, 1.0), 2.0, (0.0, 0.0, 0.0)))
    for body in set(range(COUNT)) - live:
        bodies.freeze(body)
    return bodies


@pytest.mark.parametrize(
    "live",
    [
        set(combination)
        for n in (0, 1, 3, 6, 8)
        for combination in itertools.islice(itertools.combinations(range(COUNT), n), 9)
    ],
)
def test_every_pair_of_a_live_body_is_met_once(live: set[int]) -> None:
    bodies = bodies_with_live(live)
    asked: list[int] = []

    def of_body(body: int) -> list[tuple[int, int]]:
        asked.append(body)
        return [pair for pair in PAIRS if body in pair]

    found = list(live_pairs(bodies, lambda: PAIRS, of_body, lambda pair: pair))
    assert sorted(pair for _, _, pair in found) == sorted(pair for pair in PAIRS if live & set(pair))
    assert all((a, b) == pair for a, b, pair in found)
    assert asked == ([] if 2 * len(live) > COUNT else sorted(live)), "few live bodies are asked one by one"


@pytest.mark.parametrize("live", [{1}, set(range(1, COUNT))])
def test_a_removed_body_is_in_no_pair(live: set[int]) -> None:
    """An engine may name it until the next step: its id is None."""
    bodies = bodies_with_live(live)
    found = live_pairs(
        bodies,
        lambda: PAIRS,
        lambda body: [pair for pair in PAIRS if body in pair],
        lambda pair: tuple(None if body == 3 else body for body in pair),
    )
    assert (1, 3) not in {pair for _, _, pair in found}


def test_contacts_of_live_bodies_are_chosen() -> None:
    bodies = bodies_with_live({1, 3, 5})
    bodies.remove(3)
    a, b = np.array(PAIRS).T
    n = len(PAIRS)
    contacts = Contacts(a, b, np.zeros((n, 3)), np.zeros((n, 3)), np.zeros(n), np.zeros((n, 3)), np.zeros(n))
    chosen = of_live(contacts, bodies)
    assert list(zip(chosen.body_a.tolist(), chosen.body_b.tolist(), strict=True)) == [(1, 0), (2, 1), (5, 4), (6, 5)]
    every = bodies_with_live(set(range(COUNT)))
    assert of_live(contacts, every) is contacts
