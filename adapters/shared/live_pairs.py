"""Selection of the contacts that touch a live body, so that the cost of reading depends on the live bodies only."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import TypeVar

import numpy as np

from adapters.shared.bodies import Bodies
from stability_core.port import GROUND, Contacts

Item = TypeVar("Item")
"""Type of the engine's record of a pair."""

IdsOf = Callable[[Item], tuple[int | None, int | None]]
"""Function that returns the ids a and b of an engine's pair; None for a body removed after the latest step."""


def of_live(contacts: Contacts, bodies: Bodies) -> Contacts:
    """Return the contacts that touch a live body and no removed body."""
    live, there = bodies.live, bodies.bricks
    kept = [
        (a in live or b in live) and (a in there or a <= GROUND) and (b in there or b <= GROUND)
        for a, b in zip(contacts.body_a.tolist(), contacts.body_b.tolist(), strict=True)
    ]
    return contacts if all(kept) else contacts.chosen(np.array(kept, np.bool_))


def pairs_with_live(items: Iterable[Item], ids_of: IdsOf[Item], bodies: Bodies) -> Iterator[tuple[int, int, Item]]:
    """Yield bodies a and b, and the pair, for each of the engine's pairs that touches a live body."""
    live = bodies.live
    for item in items:
        a, b = ids_of(item)
        if a is not None and b is not None and (a in live or b in live):
            yield a, b, item


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
    live = bodies.live
    if 2 * len(live) > len(bodies.bricks):
        yield from pairs_with_live(every(), ids_of, bodies)
        return
    for body in live:
        for item in of_body(body):
            a, b = ids_of(item)
            if a is None or b is None:
                continue
            other = b if a == body else a
            if other < body or other not in live:  # skip the second occurrence of a pair of live bodies
                yield a, b, item
