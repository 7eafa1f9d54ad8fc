"""Placement noise: seed 0 is exact, every other seed perturbs each pose.

A draw has three normal deviates, for x, y and yaw (turn about z), cut at three standard deviations. The standard
deviation is 0.3 mm in x and in y, times the scene's ``size``, and 0.3 deg in yaw. A draw depends only on

- the scene's variant,
- the seed,
- the brick's index,
- the number of earlier draws for this brick.

The module computes each draw from a hash through the inverse of the normal distribution, so that every machine draws
the same numbers.

If a draw pushes a brick into a neighbour or a fixed box, the module draws again. Therefore noise opens the joint
between neighbours that touch, and seed 0 alone closes this joint exactly. In a row of touching bricks the shifts add
up, and a brick may need more than three standard deviations to find room. Therefore the standard deviation of the shift
grows with the number of draws. A brick that fits exactly between two fixed walls has no room for noise: every seed
except 0 raises ``NoRoomError``.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Sequence
from dataclasses import replace
from statistics import NormalDist

import numpy as np

from scenarios.geometry import BoolArray, Boxes, overlap_in_plan, side_by_side, turned
from scenarios.model import Brick, Place, Scene

SHIFT = 0.3e-3
"""Standard deviation [m] of the shift in x and in y, for a scene of size 1."""
TURN = math.radians(0.3)
"""Standard deviation [rad] of the yaw."""
CUT = 3.0
"""Greatest absolute value of a deviate [standard deviations]."""
_DRAWS = 500
"""Number of draws after which placement fails, because between planks 2 mm apart the first draw nearly always succeeds.
"""
_WIDENED = 25
"""Number of draws after which the standard deviation of the shift grows by ``SHIFT`` again."""


class NoRoomError(ValueError):
    """Error for a brick without room for placement noise beside its neighbours; the message names the fix."""


def with_placement_noise(scene: Scene, seed: int) -> Scene:
    """Return the scene with placement noise; the unchanged scene for seed 0.

    The bricks of a ``Place`` action move as one rigid group, which turns about its centroid. In a planar scene the
    group moves along x only. The function draws again if the group, seen from above, would overlap

    - an earlier brick of a level of the group, or
    - a brick or a fixed box beside a brick of the group in the plan, unless the scene is poured.

    Raises:
        ValueError: if the seed is negative.
        NoRoomError: if a brick has no room beside its neighbours.
    """
    if seed < 0:
        raise ValueError(f"seed must be 0 (exact) or positive, got {seed}: give 0 or a positive whole number")
    if seed == 0:
        return scene
    laid: list[Brick] = []
    actions = []
    for action in scene.actions:
        if isinstance(action, Place):
            action = replace(action, bricks=_perturbed(scene, seed, action.bricks, laid))
            laid.extend(action.bricks)
        actions.append(action)
    return replace(scene, actions=tuple(actions))


def _perturbed(scene: Scene, seed: int, group: Sequence[Brick], laid: Sequence[Brick]) -> tuple[Brick, ...]:
    others = Boxes.of([*laid, *scene.world.fixed])
    must_not_overlap = _beside(scene, group, laid)
    for draw in range(_DRAWS):
        dx, dy, turn = deviates(scene.variant, seed, len(laid), draw)
        shift = scene.size * SHIFT * (1 + draw // _WIDENED)
        moved = (
            _moved(group, dx * shift, 0.0, 0.0) if scene.planar else _moved(group, dx * shift, dy * shift, turn * TURN)
        )
        if not (overlap_in_plan(Boxes.of(moved), others) & must_not_overlap).any():
            return moved
    raise NoRoomError(
        f"{scene.variant}, seed {seed}: brick {len(laid)} has no room for placement noise beside its neighbours; use "
        f"seed 0, or leave more than {2 * CUT * SHIFT * scene.size * 1e3:.2g} mm between planned bricks"
    )


def _beside(scene: Scene, group: Sequence[Brick], laid: Sequence[Brick]) -> BoolArray:
    """Return the mask (m, n) of the ``laid`` bricks and fixed boxes that each brick of the group must not overlap.

    The mask is True for

    - laid bricks of the group's levels;
    - laid bricks and fixed boxes beside the group's brick in the plan.

    The second case does not apply to a poured scene, because poured bricks do not lie in their planned places.
    """
    levels = {brick.level for brick in group}
    same_level = [brick.level in levels for brick in laid] + [False] * len(scene.world.fixed)
    must_not_overlap = np.tile(np.array(same_level, bool), (len(group), 1))
    if not scene.poured:
        planned = [*scene.bricks[: len(laid)], *scene.world.fixed]
        must_not_overlap |= side_by_side(Boxes.of(group), Boxes.of(planned))
    return must_not_overlap


def deviates(variant: str, seed: int, brick: int, draw: int = 0) -> tuple[float, float, float]:
    """Return three independent standard normal deviates, cut at ``CUT``, for a brick of a scene and a seed.

    Args:
        variant: id of the scene's variant.
        seed: seed of the placement noise.
        brick: index of the brick in the order of placement, from 0.
        draw: number of earlier draws for this brick.
    """
    digest = hashlib.blake2b(f"{variant}/{seed}/{brick}/{draw}".encode(), digest_size=24).digest()
    first, second, third = (_deviate(digest[start : start + 8]) for start in (0, 8, 16))
    return first, second, third


def _deviate(random: bytes) -> float:
    """Return the quantile of the cut normal distribution that eight random bytes select."""
    normal = NormalDist()
    tail = normal.cdf(-CUT)
    fraction = (int.from_bytes(random, "little") + 0.5) / 2**64
    return normal.inv_cdf(tail + (1 - 2 * tail) * fraction)


def _moved(group: Sequence[Brick], dx: float, dy: float, turn: float) -> tuple[Brick, ...]:
    """Return the group shifted by dx and dy [m] and turned about z through its centroid by ``turn`` [rad]."""
    x0 = sum(brick.position[0] for brick in group) / len(group)
    y0 = sum(brick.position[1] for brick in group) / len(group)
    cos, sin = math.cos(turn), math.sin(turn)
    moved = []
    for brick in group:
        x, y, z = brick.position
        position = (
            x0 + dx + cos * (x - x0) - sin * (y - y0),
            y0 + dy + sin * (x - x0) + cos * (y - y0),
            z,
        )
        moved.append(replace(brick, position=position, quaternion=turned(brick.quaternion, turn)))
    return tuple(moved)
