"""The bricks of a scene that are in place at its end."""

from __future__ import annotations

from scenarios.model import Brick, Pull, Remove, Scene


def final_bricks(scene: Scene) -> list[tuple[int, Brick]]:
    """Return index and planned pose of each brick that the scene neither removes nor pulls out."""
    taken = {action.brick for action in scene.actions if isinstance(action, Remove | Pull)}
    return [(index, brick) for index, brick in enumerate(scene.bricks) if index not in taken]
