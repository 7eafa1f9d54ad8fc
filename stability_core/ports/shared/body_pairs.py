"""Selection of the pairs of an engine that contain certain bodies.

The cost grows with the number of these bodies.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator
from typing import TypeAlias, TypeVar

Item = TypeVar("Item")
"""Type of the engine's record of a pair."""
IdsOf: TypeAlias = Callable[[Item], tuple[int | None, int | None]]
"""Function that returns the ids a and b of an engine's pair; None for an unknown body, such as a body that has left."""


def pairs_of(
    bodies: Collection[int],
    count: int,
    every: Callable[[], Iterable[Item]],
    of_body: Callable[[int], Iterable[Item]],
    ids_of: IdsOf[Item],
) -> Iterator[tuple[int, int, Item]]:
    """Yield bodies a and b, and the pair, for every pair that contains one of ``bodies``, without duplicates.

    The function skips pairs with an unknown body. If ``bodies`` are more than half of the world's bodies, the function
    reads all pairs in one call of the engine. Otherwise the function reads the pairs of each body.

    Args:
        bodies: ids of the bodies, in a container with fast membership tests.
        count: number of bodies of the world.
        every: returns all pairs of the engine.
        of_body: returns the pairs of one body.
        ids_of: returns bodies a and b of a pair; None for an unknown body.
    """
    if 2 * len(bodies) > count:
        for item in every():
            a, b = ids_of(item)
            if a is not None and b is not None and (a in bodies or b in bodies):
                yield a, b, item
        return
    for body in bodies:
        for item in of_body(body):
            a, b = ids_of(item)
            if a is None or b is None:
                continue
            other = b if a == body else a
            if other < body or other not in bodies:  # skip the second occurrence of a pair of two of the bodies
                yield a, b, item
