"""Selection of the contacts that touch a live body, so that the cost of reading depends on the live bodies only."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

import numpy as np

from adapters.shared.bodies import Bodies
from stability_core.port import GROUND, Contacts
from stability_core.ports.shared.body_pairs import IdsOf, Item, pairs_of


def of_live(contacts: Contacts, bodies: Bodies) -> Contacts:
    """Return the contacts that touch a live body and no removed body."""
    live, there = bodies.live, bodies.bricks
    kept = [
        (a in live or b in live) and (a in there or a <= GROUND) and (b in there or b <= GROUND)
        for a, b in zip(contacts.body_a.tolist(), contacts.body_b.tolist(), strict=True)
    ]
    return contacts if all(kept) else contacts.chosen(np.array(kept, np.bool_))


def live_pairs(
    bodies: Bodies, every: Callable[[], Iterable[Item]], of_body: Callable[[int], Iterable[Item]], ids_of: IdsOf[Item]
) -> Iterator[tuple[int, int, Item]]:
    """Yield bodies a and b, and the pair, for every pair that touches a live body, without duplicates.

    If most bodies are live, the function reads all pairs in one call of the engine, otherwise the pairs of each live
    body.

    Args:
        bodies: the bodies of the world.
        every: returns all pairs of the engine.
        of_body: returns the pairs of one body.
        ids_of: returns bodies a and b of a pair.
    """
    yield from pairs_of(bodies.live, len(bodies.bricks), every, of_body, ids_of)


def contact_pairs(contacts: Contacts) -> list[tuple[int, int]]:
    """Return the pair of each contact, the smaller id first."""
    ids = np.sort(np.stack((contacts.body_a, contacts.body_b), axis=1), axis=1)
    return [(a, b) for a, b in ids.tolist()]
