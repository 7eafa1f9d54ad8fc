"""The bricks that a scene neither removes nor pulls out."""

from __future__ import annotations

from scenarios.model import Brick, Pull, Remove, Scene


def final_bricks(scene: Scene) -> list[tuple[int, Brick]]:
    """Return each brick that the scene neither removes nor pulls out, with its index in the order of placement."""
    taken = {action.brick for action in scene.actions if isinstance(action, Remove | Pull)}
    return [(index, brick) for index, brick in enumerate(scene.bricks) if index not in taken]
