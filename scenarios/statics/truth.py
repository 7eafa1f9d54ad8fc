"""Exact statics of the ideal geometry: the judge of the suite, independent of ``stability_core``.

``equilibrium`` decides whether bricks in their planned poses can rest. ``first_fall`` finds the level at which a scene
must fall. Bricks are rigid convex bodies with exact dimensions, and friction obeys Coulomb's law. A verdict holds in an
engine only at some distance from the limit, because statics ignores the energy of a real drop.

The first applicable criterion decides:

1. ``normal forces`` alone hold all bodies: stable, and rest is the only solution (proof in ``force_balance``).
2. ``vertical forces`` at load-bearing contacts hold all bodies: stable.
3. No forces in the Coulomb ``cone`` hold all bodies: unstable, with a mechanism as proof. If no proof exists, the
   verdict is doubt.
4. ``loading`` from zero reaches no equilibrium: doubt, because the pile needs prestress that nothing supplies.
5. Forces exist with ``LESS_FRICTION`` times the friction too, but with this friction loading reaches no equilibrium:
   doubt.
6. All other cases: stable.

Therefore a pile that must fall may be in doubt instead of unstable, but no pile that needs prestress is stable.
Criterion 5 does not apply if ``LESS_FRICTION`` times the friction allows no forces at all. Therefore the limits of a V
and of an arch are sharp.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from scenarios.geometry import FloatArray
from scenarios.model import Brick, Scene, World
from scenarios.solids import check_solid
from scenarios.statics.contact_patch import Patch, Ridge, contact_patches
from scenarios.statics.contact_wrenches import patches_among
from scenarios.statics.force_balance import Statics, solve_balance
from scenarios.statics.loading import Loading, load_from_zero
from scenarios.statics.pile import gyration_of, pile_of_bricks
from scenarios.statics.scene_states import scene_states

LESS_FRICTION = 0.9
"""Share of the friction with which a pile that needs friction must stand as well. The reason is that two of 709 kinds
of tight courses stood in the loading from zero, but fell in two engines. With this share, one of these two kinds does
not stand."""


class UndecidedError(ArithmeticError):
    """Error for a pile in doubt; the message gives the reason and the fix."""


def equilibrium(
    bricks: Sequence[Brick], world: World, *, walls: Sequence[Brick] = (), ridge: Ridge = "bisector"
) -> Statics:
    """Judge whether bricks in their planned poses can rest.

    The verdict depends neither on scale nor on density: planks of 8 mm and blocks of 8 m, of wood or of lead, have the
    same verdict.

    Args:
        bricks: at least one brick; bricks may touch, but must not overlap (see ``contact_patch.TOUCH``).
        world: friction, gravity and fixed bodies. Tilted gravity stands for a slope.
        walls: bodies that never move, in addition to ``world.fixed``.
        ridge: the normal where two parallel edges meet (see ``contact_patch``).

    Raises:
        ValueError: if ``bricks`` is empty, gravity is zero, a number is out of range or not finite, or bodies overlap.
    """
    walls = [*world.fixed, *walls]
    check_pile(bricks, walls, world)
    return _judge(bricks, contact_patches(bricks, walls, ridge=ridge), world, walls)


def equilibrium_among(
    present: Sequence[int], bricks: Sequence[Brick], patches: Sequence[Patch], world: World
) -> Statics:
    """Judge whether the bricks ``present`` of a plan can rest without its other bricks; see ``equilibrium``.

    Args:
        present: indices of the bricks that are in place.
        bricks: all bricks of the plan.
        patches: contact patches of all bricks and of ``world.fixed``, from ``contact_patch.contact_patches``.
        world: friction, gravity and fixed bodies, the same fixed bodies as for ``patches``.
    """
    return _judge([bricks[index] for index in present], patches_among(present, patches), world, world.fixed)


def first_fall(scene: Scene, *, ridge: Ridge = "bisector") -> int | None:
    """Return the level at which a scene first has no equilibrium; None if the scene stands in every state.

    The function judges the scene after all actions of each time. After a removal, the level is the highest level placed
    so far.

    Raises:
        UndecidedError: if a state of the scene is in doubt.
        ValueError: if the scene pushes, pulls, presses, drives or tilts bricks, because statics has no answer for these
            actions; if a number is out of range; or if the planned poses of two bricks overlap, even if the two bricks
            are never in place together.
    """
    check_pile(scene.bricks, scene.world.fixed, scene.world)
    patches = contact_patches(scene.bricks, scene.world.fixed, ridge=ridge)
    for present, placed, level, _ in scene_states(scene):
        statics = equilibrium_among(present, scene.bricks, patches, scene.world)
        if statics.verdict == "doubt":
            raise UndecidedError(
                f"{scene.variant}: statics must decide every state of the scene, but is in doubt after {placed} placed "
                f"{'brick' if placed == 1 else 'bricks'} ({statics.why}): change the scene, or give the scene the "
                "outcome 'study'"
            )
        if not statics.stable:
            return level
    return None


def judge(
    centers: FloatArray,
    weights: FloatArray,
    patches: Sequence[Patch],
    friction: float,
    length: float,
    *,
    gyration: FloatArray | None = None,
    loading: Loading | None = None,
) -> Statics:
    """Judge whether bodies of any shape can rest, by their contacts; see ``equilibrium``.

    Args:
        centers: centres of mass [m], shape (n, 3).
        weights: weight vectors [N], shape (n, 3); masses are in proportion.
        patches: contact patches.
        friction: Coulomb coefficient of a pair with the friction ratio 1 (``Patch.friction_ratio``).
        length: length unit [m] of the moments: a typical edge.
        gyration: inertia over mass [m2], shape (n, 3, 3); by default the result of ``ball_gyration``.
        loading: the result of ``load_from_zero`` for the same arguments; by default the function computes this result
            if necessary.
    """
    statics = solve_balance(centers, weights, patches, friction, length)
    if not (statics.verdict == "doubt" and statics.balanced):
        return statics
    loading = loading or load_from_zero(centers, weights, patches, friction, length, gyration=gyration)
    if loading.verdict != "stands":
        return replace(statics, by="loading", why=f"needs prestress: loaded from zero, {loading.why}")
    less = LESS_FRICTION * friction
    if solve_balance(centers, weights, patches, less, length).balanced:
        loading = load_from_zero(centers, weights, patches, less, length, gyration=gyration)
        if loading.verdict != "stands":
            return replace(statics, by="loading", why=f"needs prestress with {less:.3g} of friction: {loading.why}")
    return replace(statics, verdict="stable", by="loading", why="")


def _judge(bricks: Sequence[Brick], patches: Sequence[Patch], world: World, walls: Sequence[Brick]) -> Statics:
    return judge(*pile_of_bricks(bricks, patches, world, walls), gyration=gyration_of(bricks))


def check_pile(bricks: Sequence[Brick], walls: Sequence[Brick], world: World) -> None:
    """Raise ``ValueError`` unless bricks, walls and world are valid; the message names the fault."""
    if not bricks:
        raise ValueError("bricks must contain at least one brick to judge, got no brick: pass the bricks in place")
    for index, brick in enumerate([*bricks, *walls]):
        name = f"brick {index}" if index < len(bricks) else f"wall {index - len(bricks)}"
        if not np.isfinite([*brick.size, brick.mass, *brick.position, *brick.quaternion]).all():
            raise ValueError(f"{name} must have finite numbers only, got {brick}: replace NaN and inf by numbers")
        if min(*brick.size, brick.mass) <= 0:
            raise ValueError(
                f"{name} must have positive edges and mass, got {brick.size} m and {brick.mass} kg: give "
                "numbers above 0"
            )
        check_solid(brick)
    if not (np.isfinite(world.gravity).all() and any(world.gravity)):
        raise ValueError(
            f"gravity must be finite and not zero, got {world.gravity} m/s2: give a vector such as (0, 0, -9.81)"
        )
    if not (np.isfinite(world.friction) and world.friction >= 0):
        raise ValueError(
            f"the world's coefficient of friction must be finite and not negative, got {world.friction}: give 0 or a "
            "positive number"
        )
