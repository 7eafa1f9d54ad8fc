"""The pile of a plan: centres of mass, weights, contact patches with their friction, and inertia."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from scenarios.geometry import Boxes, FloatArray, rotation
from scenarios.model import Brick, World
from scenarios.shapes import are_boxes
from scenarios.solids import friction_of, has_one_friction, moments_of, of_pair
from scenarios.statics.contact_patch import GROUND, Patch


class Pile(NamedTuple):
    """Bodies and their contacts: the common arguments of functions of statics, for example of ``truth.judge``."""

    centers: FloatArray
    """Centres of mass [m], shape (n, 3)."""
    weights: FloatArray
    """Weight vectors [N], shape (n, 3)."""
    patches: Sequence[Patch]
    friction: float
    """Coulomb coefficient of a pair with the friction ratio 1."""
    length: float
    """The length unit [m] in which moments count: the mean of the bricks' longest edges."""


def pile_of_bricks(
    bricks: Sequence[Brick], patches: Sequence[Patch], world: World, walls: Sequence[Brick] | None = None
) -> Pile:
    """Return the pile of bricks with their contact patches.

    Args:
        bricks: the bricks, in the order of the patches' indices.
        patches: contact patches of the bricks.
        world: friction, gravity, and the default of ``walls``.
        walls: the bodies that never move, in the order of ``Patch.wall``.
    """
    walls = world.fixed if walls is None else walls
    friction = world.friction
    if not has_one_friction([*bricks, *walls], world):
        coefficients = [_coefficient(patch, bricks, walls, world) for patch in patches]
        friction = max(coefficients, default=0.0)
        patches = [
            patch._replace(friction_ratio=coefficient / friction if friction else 1.0)
            for patch, coefficient in zip(patches, coefficients, strict=True)
        ]
    return Pile(
        centers=np.array([brick.position for brick in bricks], np.float64),
        weights=np.outer([brick.mass for brick in bricks], world.gravity),
        patches=patches,
        friction=friction,
        length=float(np.mean([max(brick.size) for brick in bricks])),
    )


def gyration_of(bricks: Sequence[Brick]) -> FloatArray:
    """Return the bricks' inertia over mass [m2] about the centres of mass, along the world's axes, shape (n, 3, 3)."""
    if are_boxes([brick.shape for brick in bricks]) and all(brick.moments is None for brick in bricks):
        return Boxes.of(bricks).gyration
    frames = rotation(np.array([brick.quaternion for brick in bricks], np.float64))
    squares = np.array([moments_of(brick) for brick in bricks]) / np.array([brick.mass for brick in bricks])[:, None]
    gyration: FloatArray = np.einsum("nij,nj,nkj->nik", frames, squares, frames)
    return gyration


def _coefficient(patch: Patch, bricks: Sequence[Brick], walls: Sequence[Brick], world: World) -> float:
    """Return the coefficient of friction of the two bodies at a patch."""
    second = friction_of(bricks[patch.second], world)
    if patch.first != GROUND:
        return of_pair(friction_of(bricks[patch.first], world), second)
    return of_pair(world.friction if patch.wall is None else friction_of(walls[patch.wall], world), second)
