"""Exact statics of the ideal geometry: the judge of the suite, written apart from the core that it judges.

``equilibrium`` tells whether bricks as planned can rest, ``first_fall`` at which level a scene must come down. Bricks
are rigid, faces flat, heights exact; friction is Coulomb's. A real drop has energy that statics does not know: an
answer holds in an engine only at some distance from the limit.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import zip_longest

import numpy as np

from scenarios.contact_patch import GROUND, Patch, Ridge, contact_patches
from scenarios.force_balance import Statics, solve_balance
from scenarios.model import Brick, Place, Pull, Push, Remove, Scene, World


class UndecidedError(ArithmeticError):
    """Neither pyramid could prove anything: the pile is too close to its limit."""


def equilibrium(
    bricks: Sequence[Brick], world: World, *, walls: Sequence[Brick] = (), ridge: Ridge = "bisector"
) -> Statics:
    """Whether bricks in their planned poses can rest.

    The verdict is free of scale: it is the same for planks of 8 mm and blocks of 8 m, of wood or of lead.

    Args:
        bricks: at least one; they must touch, not overlap (see ``contact_patch.TOUCH``).
        world: friction and gravity; a slope is gravity that is tilted.
        walls: boxes that never move, beside those of the world.
        ridge: the normal where two parallel edges meet (see ``contact_patch``).

    Raises:
        ValueError: if there is no brick or no gravity, an edge, a mass or friction is not what it must be, a number is
            not finite, or bricks overlap.
    """
    walls = [*world.fixed, *walls]
    _check(bricks, walls, world)
    return _judge(bricks, contact_patches(bricks, walls, ridge=ridge), world)


def first_fall(scene: Scene, *, ridge: Ridge = "bisector") -> int | None:
    """The level at which a scene, built action by action, first finds no equilibrium; None if it always stands.

    After a removal it is the highest level that was placed so far. What happens at one time is judged as one.

    Raises:
        UndecidedError: if a state of the scene is in doubt.
        ValueError: if the scene pushes or pulls bricks, for which statics has no answer, or lays one where another,
            since removed, was planned: they would overlap.
    """
    _check(scene.bricks, scene.world.fixed, scene.world)
    patches = contact_patches(scene.bricks, scene.world.fixed, ridge=ridge)
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
            case Push() | Pull():
                raise ValueError(f"{scene.variant} pushes a brick: statics cannot tell what a push or pull does")
        if not present or (then is not None and then.time == action.time):
            continue
        statics = _judge([scene.bricks[index] for index in present], _among(present, patches), scene.world)
        if statics.verdict == "doubt":
            raise UndecidedError(f"{scene.variant}: with {placed} bricks laid it is too close to its limit to tell")
        if not statics.stable:
            return level
    return None


def _among(present: Sequence[int], patches: Sequence[Patch]) -> list[Patch]:
    """The patches between those present, naming them by their places in ``present``."""
    place = {brick: index for index, brick in enumerate(present)} | {GROUND: GROUND}
    return [
        patch._replace(first=place[patch.first], second=place[patch.second])
        for patch in patches
        if patch.first in place and patch.second in place
    ]


def _judge(bricks: Sequence[Brick], patches: Sequence[Patch], world: World) -> Statics:
    weights = np.outer([brick.mass for brick in bricks], world.gravity)
    length = float(np.mean([max(brick.size) for brick in bricks]))
    return solve_balance(np.array([brick.position for brick in bricks]), weights, patches, world.friction, length)


def _check(bricks: Sequence[Brick], walls: Sequence[Brick], world: World) -> None:
    if not bricks:
        raise ValueError("there must be at least one brick")
    for index, brick in enumerate([*bricks, *walls]):
        if not np.isfinite([*brick.size, brick.mass, *brick.position, *brick.quaternion]).all():
            raise ValueError(f"brick {index} is not finite: {brick}")
        if min(*brick.size, brick.mass) <= 0:
            raise ValueError(f"brick {index} must have positive edges and mass, got {brick.size} m, {brick.mass} kg")
    if not (np.isfinite(world.gravity).all() and any(world.gravity)):
        raise ValueError(f"gravity must be finite and not zero, or nothing rests and nothing falls: {world.gravity}")
    if not (np.isfinite(world.friction) and world.friction >= 0):
        raise ValueError(f"friction must be finite and not negative, got {world.friction}")
