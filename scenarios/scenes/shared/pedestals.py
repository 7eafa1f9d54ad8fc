"""Pedestals below the bricks of the lowest level, so that a brick without its pedestal falls visibly."""

from __future__ import annotations

from dataclasses import replace

from scenarios.model import Brick, Scene, Vector
from scenarios.planks import THICKNESS

PEDESTAL = 6 * THICKNESS
"""Height of a pedestal [m], which lets a standard plank without its pedestal tilt by more than 15 degrees."""


def pedestals(scene: Scene, narrower: float) -> tuple[Brick, ...]:
    """Return the upright pedestals below the bricks of the lowest level.

    Args:
        scene: the scene without pedestals.
        narrower: difference [m] between the edges of a brick and of its pedestal, in x and y. Pedestals must not touch
            even if their bricks do, because a brick that has moved by a micrometre would rest on its neighbour's
            pedestal.
    """
    return tuple(_pedestal(brick, narrower) for brick in scene.bricks if brick.level == 1)


def lifted(brick: Brick) -> Brick:
    """Return a brick raised by the height of a pedestal, with a level higher by one."""
    x, y, z = brick.position
    return replace(brick, position=(x, y, z + PEDESTAL), level=brick.level + 1)


def _pedestal(brick: Brick, narrower: float) -> Brick:
    (length, width, thickness), (x, y, _) = brick.size, brick.position
    size: Vector = (length - narrower, width - narrower, PEDESTAL)
    return replace(brick, size=size, mass=brick.mass * PEDESTAL / thickness, position=(x, y, PEDESTAL / 2))
