"""The states of a scene: the bricks in place after all actions of each time."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import zip_longest
from typing import NamedTuple

from scenarios.model import Place, Remove, Scene


class State(NamedTuple):
    """The bricks in place, at rest in their planned poses."""

    present: tuple[int, ...]
    """Indices of the bricks in place, in the order of placement."""
    placed: int
    """Number of bricks placed so far."""
    level: int
    """Highest level placed so far."""
    time: float
    """Time [s] of the last action."""


def scene_states(scene: Scene) -> Iterator[State]:
    """Yield the states of a scene that only places and removes bricks, without states that have no brick.

    Raises:
        ValueError: if the scene pushes, pulls, presses, drives or tilts bricks, for which statics has no answer.
    """
    present: list[int] = []
    placed = level = 0
    for action, then in zip_longest(scene.actions, scene.actions[1:]):
        match action:
            case Place(bricks=bricks):
                present += range(placed, placed + len(bricks))
                placed += len(bricks)
                level = max(level, *(brick.level for brick in bricks))
            case Remove(brick=brick):
                present.remove(brick)
            case _:
                raise ValueError(
                    f"statics decides only scenes that place and remove bricks, but {scene.variant} has the "
                    f"action {type(action).__name__}: give the scene the outcome 'study'"
                )
        if present and (then is None or then.time != action.time):
            yield State(tuple(present), placed, level, action.time)
