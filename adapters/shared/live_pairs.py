"""Select the contacts that touch a live body, so that the cost of reading depends on the live bodies only."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import TypeVar

import numpy as np

from adapters.shared.bodies import Bodies
from stability_core.port import GROUND, Contacts

Item = TypeVar("Item")
"""One pair of the engine's own."""

IdsOf = Callable[[Item], tuple[int | None, int | None]]
"""From a pair of the engine's own to its bodies a and b; None for one that was removed since the step."""


def of_live(contacts: Contacts, bodies: Bodies) -> Contacts:
    """Return the contacts that touch a live body and no removed one."""
    live, there = bodies.live, bodies.bricks
    kept = [
        (a in live or b in live) and (a in there or a <= GROUND) and (b in there or b <= GROUND)
        for a, b in zip(contacts.body_a.tolist(), contacts.body_b.tolist(), strict=True)
    ]
    return contacts if all(kept) else contacts.chosen(np.array(kept, np.bool_))


def pairs_with_live(items: Iterable[Item], ids_of: IdsOf[Item], bodies: Bodies) -> Iterator[tuple[int, int, Item]]:
    """Return those of the engine's pairs that touch a live body, with their bodies a and b."""
    live = bodies.live
    for item in items:
        a, b = ids_of(item)
        if a is not None and b is not None and (a in live or b in live):
            yield a, b, item


def live_pairs(
    bodies: Bodies, every: Callable[[], Iterable[Item]], of_body: Callable[[int], Iterable[Item]], ids_of: IdsOf[Item]
) -> Iterator[tuple[int, int, Item]]:
    """Return every pair that touches a live body, each once, with its bodies a and b.

    While most bodies are live all pairs are read in one call of the engine, else those of each live body.

    Args:
        bodies: of the world.
        every: reads all pairs of the engine.
        of_body: reads the pairs of one body.
        ids_of: bodies a and b of a pair.
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
            if other < body or other not in live:  # a pair of live bodies occurs twice
                yield a, b, item
