"""Prebuilt stacks: any scene of statics with all bricks in place when the simulation starts.

``at_once`` merges all ``Place`` actions into one ``Place`` action at time 0 with height 0. Bricks keep their planned
poses, and touch their neighbours without a gap. Removals keep their time after the last placement. The function
distinguishes three cases:

1. The scene must fall at level k during the placements: the prebuilt stack is the first k levels. The stack must fall
   within ``WITHIN`` times ``falling.fall_time``, so that a stack that freezes first and falls later counts as a false
   stand.
2. The scene must fall after a removal: the prebuilt stack is all levels. The stack must stand until the removal.
3. The scene must stand: the prebuilt stack is all levels. The stack must stand for ``STANDS_S``. Then the scene removes
   one more brick, and the stack must fall.

``at_once_below`` takes the first k - 1 levels of a scene of case 1, and treats this stack as case 3. Therefore every
scene also tests a later fall: a body that a policy freezes before the first step must fall later. The prebuilt scenes
of cases 1 and 3 form a pair if their original scenes form a pair.

In case 3 the scene removes the first brick, level by level from the lowest, for which two conditions hold:

- Without the brick, exact statics finds no equilibrium, under both ridge conventions.
- The loss of the brick is visible. A brick above loses all its support, or the removed brick is tall: at least ``TALL``
  times as high as the least edge of a brick above.

If no brick meets both conditions (flat planks with two supports each), the stack stands on pedestals, and the scene
removes a pedestal.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import islice

import numpy as np

from scenarios.geometry import Boxes
from scenarios.model import Action, Brick, Expectation, Place, Remove, Scene
from scenarios.planks import GAP
from scenarios.scenario import AT_ONCE, AT_ONCE_BELOW
from scenarios.scenes.shared.pedestals import lifted, pedestals
from scenarios.statics.contact_patch import GROUND, Patch, Ridge, contact_patches
from scenarios.statics.falling import fall_time
from scenarios.statics.truth import equilibrium_among

STANDS_S = 3.0
"""Time [s] for which a prebuilt stack must stand: several times the time of a fall in any engine."""
WITHIN = 3.0
"""Ratio of the allowed time of a fall to ``fall_time``, because engines may tip a stack about a softer edge, and show
the fall a frame later."""
TALL = 3.0
"""Least ratio of a support's height to the least edge of the brick on it at which the loss of the support is visible:
when one end of the brick has sunk to the ground, the brick's centre has sunk by 1.5 times its least edge."""
RIDGES: tuple[Ridge, ...] = ("bisector", "face")
"""Conventions of the normal of a ridge; a scene removes a brick only if the rest falls under both conventions."""
_UPWARD = 0.1
"""Vertical component of the unit normal from which a contact counts as a support; a contact below counts as a ridge."""


def at_once(scene: Scene) -> Scene:
    """Return the prebuilt variant of a scene.

    Raises:
        ValueError: if the scene is dynamic or has no known answer, or if no removal of a brick makes the stack fall.
    """
    _check(scene)
    scene = closed(scene)
    level = _level_of_fall(scene)
    if level is not None:
        return _falling(scene, [brick for brick in scene.bricks if brick.level <= level])
    merged = _merged(scene, AT_ONCE)
    return replace(merged, pair="") if scene.expectation.outcome == "fall" else _robbed(merged)


def at_once_below(scene: Scene) -> Scene:
    """Return the prebuilt variant of the levels below the level at which a scene must fall.

    Raises:
        ValueError: as ``at_once``; or if the scene does not fall during its placements, or falls at the first level.
    """
    _check(scene)
    scene = closed(scene)
    level = _level_of_fall(scene)
    if level is None or level == 1:
        raise ValueError(
            f"built = 'at_once_below' needs a scene that falls above level 1 during its placements, but "
            f"{scene.variant} does not: use built = 'at_once'"
        )
    bricks = tuple(brick for brick in scene.bricks if brick.level < level)
    return _robbed(replace(_merged(scene, AT_ONCE_BELOW), actions=(Place(0.0, bricks, 0.0),)))


def is_static(scene: Scene) -> bool:
    """Return whether statics alone decides a scene, because the scene only places and removes bricks."""
    return not scene.poured and all(isinstance(action, Place | Remove) for action in scene.actions)


def _check(scene: Scene) -> None:
    if not is_static(scene):
        raise ValueError(
            f"a prebuilt scene may only place and remove bricks, but {scene.variant} also pours or moves bricks: use "
            "built = 'one_by_one'"
        )
    if scene.expectation.outcome == "study":
        raise ValueError(
            f"a prebuilt scene needs a known answer, but {scene.variant} has no known answer "
            f"({scene.expectation.theory}): use built = 'one_by_one'"
        )


def closed(scene: Scene) -> Scene:
    """Return the scene with closed ridges.

    A plan leaves a gap between planks that lean against each other.
    """
    corners = Boxes.of(scene.bricks).corners
    shift = np.zeros((len(scene.bricks), 3))
    for patch in contact_patches(scene.bricks):
        if patch.first != GROUND and abs(patch.normal[2]) < _UPWARD:
            apart = (corners[patch.second] @ patch.normal).min() - (corners[patch.first] @ patch.normal).max()
            shift[patch.first] += max(0.0, apart) / 2 * patch.normal
            shift[patch.second] -= max(0.0, apart) / 2 * patch.normal
    bricks = iter(
        replace(brick, position=(brick.position[0] + x, brick.position[1] + y, brick.position[2] + z))
        for brick, (x, y, z) in zip(scene.bricks, shift.tolist(), strict=True)
    )
    return replace(
        scene,
        actions=tuple(
            replace(action, bricks=tuple(islice(bricks, len(action.bricks)))) if isinstance(action, Place) else action
            for action in scene.actions
        ),
    )


def _level_of_fall(scene: Scene) -> int | None:
    """Return the level at which a scene must fall during the placements; None for any other scene."""
    return scene.expectation.level if scene.expectation.not_before_s == 0.0 else None


def _merged(scene: Scene, built: str) -> Scene:
    """Return the scene with all bricks placed at time 0, without a gap, and with its removals."""
    last = max(action.time for action in scene.actions if isinstance(action, Place))
    removals = [Remove(a.time - last, a.brick) for a in scene.actions if isinstance(a, Remove)]
    expectation = scene.expectation
    return replace(
        scene,
        variant=f"{scene.variant}-built{built}",
        parameters={**scene.parameters, "built": built},
        actions=(Place(0.0, scene.bricks, 0.0), *removals),
        expectation=replace(expectation, not_before_s=max(0.0, expectation.not_before_s - last)),
        pair=f"{scene.pair or scene.variant}-at_once",
    )


def _falling(scene: Scene, bricks: Sequence[Brick]) -> Scene:
    """Return the scene with ``bricks`` as a prebuilt stack that must fall at once."""
    seconds = fall_time(bricks, scene.world)
    within = round(WITHIN * seconds, 3)
    theory = f"{scene.expectation.theory}; within {within:.2f} s, because its mechanism takes {seconds:.2f} s from rest"
    merged = _merged(scene, AT_ONCE)
    return replace(
        merged,
        actions=(Place(0.0, tuple(bricks), 0.0),),
        expectation=replace(merged.expectation, theory=theory, within_s=within),
        watch_s=max(scene.watch_s, within),
    )


def _robbed(scene: Scene) -> Scene:
    """Return a scene whose prebuilt stack stands until the scene removes a load-bearing brick.

    Raises:
        ValueError: if no removal of a brick makes the stack fall.
    """
    taken = _load_bearing(scene)
    if taken is None:
        scene = _raised(scene)
        taken = _load_bearing(scene)
    if taken is None:
        raise ValueError(
            f"a prebuilt scene needs a brick whose removal makes the stack fall, but {scene.variant} has no brick "
            "of this kind: use built = 'one_by_one'"
        )
    time = scene.done_s + STANDS_S
    rest = _without(scene, {*_removed(scene), taken})
    theory = f"{scene.expectation.theory}; exact statics finds no equilibrium without brick {taken}"
    return replace(
        scene,
        actions=(*scene.actions, Remove(time, taken)),
        expectation=Expectation("fall", theory, scene.levels, time),
        look_for=f"the stack stands until brick {taken} is removed at {time:g} s, and then falls at once",
        watch_s=max(scene.watch_s, WITHIN * fall_time(rest, scene.world)),
    )


def _load_bearing(scene: Scene) -> int | None:
    """Return the index of the first brick, level by level, whose loss makes bricks fall visibly; else None."""
    gone = _removed(scene)
    bisector, face = (contact_patches(scene.bricks, scene.world.fixed, ridge=ridge) for ridge in RIDGES)
    conventions = [bisector] if _are_equal(bisector, face) else [bisector, face]
    heights = 2 * Boxes.of(scene.bricks).reach[:, 2]
    order = sorted(set(range(len(scene.bricks))) - gone, key=lambda index: scene.bricks[index].level)
    for index in order:
        borne = _seen_without(index, gone, scene.bricks, bisector, heights[index])
        if borne and all(_falls(scene, {*gone, index}, borne, patches) for patches in conventions):
            return index
    return None


def _seen_without(
    index: int, gone: set[int], bricks: Sequence[Brick], patches: Sequence[Patch], height: float
) -> list[int]:
    """Return the indices of the bricks that touch the brick ``index``, and whose fall without it would be visible."""
    present = [patch for patch in patches if not gone & {patch.first, patch.second}]
    touching = {*(p.second for p in present if p.first == index), *(p.first for p in present if p.second == index)}
    rest = [patch for patch in present if index not in (patch.first, patch.second)]
    supported = {p.second for p in rest if p.normal[2] > _UPWARD} | {p.first for p in rest if p.normal[2] < -_UPWARD}
    return sorted(
        brick
        for brick in touching
        if brick >= 0 and (brick not in supported or height >= TALL * min(bricks[brick].size))
    )


def _are_equal(first: Sequence[Patch], second: Sequence[Patch]) -> bool:
    """Return whether the patches of both ridge conventions have the same normals."""
    return all((one.normal == other.normal).all() for one, other in zip(first, second, strict=True))


def _falls(scene: Scene, gone: set[int], borne: Sequence[int], patches: Sequence[Patch]) -> bool:
    """Return whether a brick of ``borne`` moves without the bricks ``gone``."""
    kept = [index for index in range(len(scene.bricks)) if index not in gone]
    statics = equilibrium_among(kept, scene.bricks, patches, scene.world)
    speed = np.abs(statics.mechanism).max(axis=1)
    return statics.verdict == "unstable" and bool((speed[[kept.index(brick) for brick in borne]] > 0.0).any())


def _without(scene: Scene, gone: set[int]) -> list[Brick]:
    return [brick for index, brick in enumerate(scene.bricks) if index not in gone]


def _removed(scene: Scene) -> set[int]:
    return {action.brick for action in scene.actions if isinstance(action, Remove)}


def _raised(scene: Scene) -> Scene:
    """Return a prebuilt stack on pedestals.

    A scene with fixed bodies, or with leaning bricks at the lowest level, stays the same.
    """
    lowest = [brick for brick in scene.bricks if brick.level == 1]
    if scene.world.fixed or any(brick.quaternion[1:3] != (0.0, 0.0) for brick in lowest):
        return scene
    below = pedestals(scene, GAP)
    raised: list[Action] = [Place(0.0, (*below, *(lifted(brick) for brick in scene.bricks)), 0.0)]
    removals = [Remove(a.time, a.brick + len(below)) for a in scene.actions if isinstance(a, Remove)]
    return replace(scene, actions=(*raised, *removals))
