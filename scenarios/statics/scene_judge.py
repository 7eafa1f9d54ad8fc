"""The judge's verdict on a scene: stands, falls or doubt, with margins and proof.

The verdict follows from exact statics (``truth``) of every state of the scene, under both conventions for the normal at
a ridge. For a scene that stands, the module also computes the margins of the last state:

- load: the greatest additional force along gravity at the centre of mass of each brick (``brick_margins``);
- tilt: the greatest turn of gravity that each brick withstands, in the weakest of eight directions;
- friction: the least coefficient of friction for which forces exist.

A margin is a statement about equilibrium. A stack that needs prestress may fall before its margin.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from scenarios.geometry import FloatArray
from scenarios.model import Scene
from scenarios.statics.brick_margins import brick_margins
from scenarios.statics.contact_patch import Patch, Ridge, contact_patches
from scenarios.statics.contact_wrenches import patches_among
from scenarios.statics.force_balance import Statics, solve_balance
from scenarios.statics.pile import Pile, pile_of_bricks
from scenarios.statics.scene_states import State, scene_states
from scenarios.statics.truth import check_pile, equilibrium_among

RIDGES: tuple[Ridge, ...] = ("bisector", "face")
FRICTION_STEP = 1e-3
"""Precision of the least friction, as a share of the scene's friction."""
NOTHING = 1e-6
"""Force below which a contact carries nothing, as a share of the weight of all bricks, because the solver leaves
1e-9."""


@dataclass(frozen=True, slots=True)
class SceneMargins:
    """Margins of a scene that stands, in its last state."""

    load_n: FloatArray
    """Greatest additional load on each brick in place [N], shape (n,); infinite without a limit."""
    tilt_deg: FloatArray
    """Greatest tilt of gravity that each brick in place withstands [deg], shape (n,)."""
    friction: float
    """Least coefficient of friction for which forces exist; all pairs keep their ratios."""


@dataclass(frozen=True, slots=True)
class PairForce:
    """Force between two bodies, from one of the possible sets of forces that hold the scene."""

    first: int
    """Index of the body from which the normal points; ``GROUND`` for the ground and fixed bodies."""
    second: int
    force: tuple[float, float, float]
    """Force on the second body [N]."""
    friction_used: float
    """Greatest ratio of the tangential to the normal force at a corner."""


@dataclass(frozen=True, slots=True)
class Judgement:
    """The judge's verdict on a scene, with margins and proof."""

    verdict: Literal["stands", "falls", "doubt"]
    why: str
    """The criterion that decides, or the reason of the doubt, in words."""
    state: State | None
    """The state that falls or is in doubt, or the last state of a scene that stands; None without any state."""
    margins: SceneMargins | None
    """Margins of a scene that stands; else None."""
    forces: tuple[PairForce, ...]
    """Forces that hold the last state of a scene that stands; else empty."""
    mechanism: FloatArray
    """Virtual velocity of each brick in place of a scene that falls, shape (n, 6): linear, then angular times the
    length unit, at most 1 in any component. Else of shape (0, 6)."""


def judge_scene(scene: Scene) -> Judgement:
    """Judge whether a scene stands.

    Raises:
        ValueError: if bricks overlap, or a number is out of range; the message names the fault and the fix.
    """
    check_pile(scene.bricks, scene.world.fixed, scene.world)
    conventions = _conventions(scene)
    state = None
    try:
        for state in scene_states(scene):
            found = [equilibrium_among(state.present, scene.bricks, patches, scene.world) for patches in conventions]
            if any(statics.verdict != "stable" for statics in found):
                return _not_standing(state, found)
    except ValueError as error:
        return Judgement("doubt", str(error), state, None, (), np.empty((0, 6)))
    if state is None:
        return Judgement("doubt", "no brick is ever in place", None, None, (), np.empty((0, 6)))
    piles = [_pile(scene, state, patches) for patches in conventions]
    why = f"held by {found[0].by}" if found[0].by != "loading" else "held when loaded from zero, with friction"
    return Judgement("stands", why, state, _margins(piles), _pair_forces(found[0]), np.empty((0, 6)))


def _conventions(scene: Scene) -> list[list[Patch]]:
    """Return the patches of a scene for each convention for ridges; one list if both conventions agree."""
    bisector, face = (contact_patches(scene.bricks, scene.world.fixed, ridge=ridge) for ridge in RIDGES)
    is_equal = all((one.normal == other.normal).all() for one, other in zip(bisector, face, strict=True))
    return [bisector] if is_equal else [bisector, face]


def _not_standing(state: State, found: Sequence[Statics]) -> Judgement:
    verdicts = {statics.verdict for statics in found}
    if verdicts == {"unstable"}:
        why = "no forces inside the friction cones hold it: the mechanism moves without resistance"
        return Judgement("falls", why, state, None, (), found[0].mechanism)
    if "stable" in verdicts:
        why = "the answer depends on the normal at a ridge, which is a convention"
    else:
        why = next(statics.why for statics in found if statics.verdict == "doubt")
    return Judgement("doubt", why, state, None, (), np.empty((0, 6)))


def _pile(scene: Scene, state: State, patches: Sequence[Patch]) -> Pile:
    bricks = [scene.bricks[index] for index in state.present]
    return pile_of_bricks(bricks, patches_among(state.present, patches), scene.world)


def _margins(piles: Sequence[Pile]) -> SceneMargins:
    """Return the margins over the conventions for ridges: least loads and tilts, and the greatest friction."""
    margins = [brick_margins(*pile) for pile in piles]
    return SceneMargins(
        np.min([one.load_n for one in margins], axis=0),
        np.min([one.tilt_deg for one in margins], axis=0),
        max(_least_friction(pile) for pile in piles),
    )


def _least_friction(pile: Pile) -> float:
    """Find the least coefficient of friction for which forces exist, by bisection; 0 if pressure alone suffices."""
    low, high = 0.0, pile.friction
    if solve_balance(*pile._replace(friction=0.0)).balanced:
        return 0.0
    while high - low > FRICTION_STEP * pile.friction:
        middle = (low + high) / 2
        if solve_balance(*pile._replace(friction=middle)).balanced:
            high = middle
        else:
            low = middle
    return high


def _pair_forces(statics: Statics) -> tuple[PairForce, ...]:
    normal = np.einsum("pd,pd->p", statics.forces, statics.normals)
    across = np.linalg.norm(statics.forces - normal[:, None] * statics.normals, axis=1)
    least = NOTHING * float(np.abs(normal).sum())
    used = np.where(normal > least, across / np.where(normal > least, normal, 1.0), 0.0)
    pairs: dict[tuple[int, int], list[int]] = {}
    for corner, bodies in enumerate(statics.bodies):
        pairs.setdefault(bodies, []).append(corner)
    forces = []
    for (first, second), corners in pairs.items():
        x, y, z = statics.forces[corners].sum(axis=0).tolist()
        if math.hypot(x, y, z) > least:
            forces.append(PairForce(first, second, (x, y, z), float(used[corners].max())))
    return tuple(forces)
