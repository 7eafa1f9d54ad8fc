"""The content of an imported file: bricks, fixed bodies, gravity, friction, and notes on changes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from scenarios.model import Brick, World


class ImportRefusedError(ValueError):
    """Error for a file that the import cannot turn into a scene; the message names the cause and the fix."""


class ExportRefusedError(ValueError):
    """Error for a format that cannot hold a body, or whose package is missing; the message names the fix."""


@dataclass(frozen=True, slots=True)
class Imported:
    """The content of an imported file."""

    name: str
    world: World
    bricks: tuple[Brick, ...]
    names: tuple[str, ...]
    """Name of each brick in the file."""
    notes: tuple[str, ...] = ()
    """Notes on the elements that the import left out or changed, in words."""


def with_common_friction(world: World, bricks: Sequence[Brick]) -> tuple[World, tuple[Brick, ...]]:
    """Remove coefficients of friction that equal the world's coefficient from bricks and fixed bodies.

    The result has the same friction, because a body without its own coefficient has the world's coefficient. A scene
    with a single coefficient also runs on engines that accept one coefficient only. The function changes nothing unless
    the bricks' most frequent own coefficient (the first in a tie) is the world's coefficient.
    """
    counted = Counter(brick.friction for brick in bricks if brick.friction is not None)
    if not counted or counted.most_common(1)[0][0] != world.friction:
        return world, tuple(bricks)
    return (
        replace(world, fixed=tuple(_without(world.friction, world.fixed))),
        tuple(_without(world.friction, bricks)),
    )


def _without(friction: float, bricks: Iterable[Brick]) -> Iterable[Brick]:
    return (replace(brick, friction=None) if brick.friction == friction else brick for brick in bricks)
