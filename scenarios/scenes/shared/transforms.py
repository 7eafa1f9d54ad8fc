"""Transforms of a whole scene that preserve its statics: changes of size, mass and direction.

``resized`` changes the size of a scene of statics by a factor L. Gravity stays the same.

- Lengths change by L: bricks, gaps, fixed boxes, the release height of bricks, and placement noise.
- Masses change by L^3, because the density stays the same.
- Times change by max(1, sqrt(L)): times of placements and removals, limits of falls, and ``watch_s``.
"""

from __future__ import annotations

import math
from dataclasses import replace

from scenarios.geometry import turned
from scenarios.model import Action, Brick, Place, Remove, Scene, pace_of
from scenarios.parameters import short
from scenarios.scenario import SIZE
from scenarios.scenes.shared.prebuilt import is_static
from scenarios.solids import enlarged, reweighted


def transformed(brick: Brick, size: float, mass: float, yaw: float) -> Brick:
    """Return a brick with lengths times ``size`` and mass times ``mass``, turned about the z axis by ``yaw`` [deg]."""
    x, y, z = brick.position
    turn = math.radians(yaw)
    cos, sin = math.cos(turn), math.sin(turn)
    return replace(
        reweighted(enlarged(brick, size), mass),
        position=((cos * x - sin * y) * size, (sin * x + cos * y) * size, z * size),
        quaternion=turned(brick.quaternion, turn),
    )


def resized(scene: Scene, size: object) -> Scene:
    """Return a scene of statics with all lengths times ``size``.

    Raises:
        ValueError: if ``size`` is out of range, or not 1 for a dynamic scene.
    """
    factor = SIZE.check("size", size)
    if factor == 1.0:
        return replace(scene, parameters={**scene.parameters, "size": factor})
    if not is_static(scene):
        raise ValueError(
            f"parameter 'size' applies only to scenes that place and remove bricks, but {scene.variant} also "
            "pours or moves bricks: leave out 'size'"
        )
    suffix = f"-size{short(factor)}"
    pace = pace_of(factor)
    expectation, within = scene.expectation, scene.expectation.within_s
    changed = f"all lengths times {factor:g}, all times of the scene times {pace:.3g}"
    return replace(
        scene,
        variant=scene.variant + suffix,
        parameters={**scene.parameters, "size": factor},
        world=replace(scene.world, fixed=tuple(_enlarged(box, factor) for box in scene.world.fixed)),
        actions=tuple(_resized_action(action, factor, pace) for action in scene.actions),
        expectation=replace(
            expectation,
            theory=f"{expectation.theory}; {changed}",
            not_before_s=expectation.not_before_s * pace,
            within_s=None if within is None else within * pace,
        ),
        look_for=f"{scene.look_for}; {changed}",
        pair=scene.pair and scene.pair + suffix,
        watch_s=scene.watch_s * pace,
        size=factor,
    )


def _enlarged(brick: Brick, size: float) -> Brick:
    return transformed(brick, size, size**3, 0.0)


def _resized_action(action: Action, size: float, pace: float) -> Action:
    if isinstance(action, Place):
        bricks = tuple(_enlarged(brick, size) for brick in action.bricks)
        return Place(action.time * pace, bricks, action.height * size)
    if isinstance(action, Remove):
        return replace(action, time=action.time * pace)
    raise ValueError(
        "parameter 'size' applies only to the actions Place and Remove, got the action "
        f"{type(action).__name__}: leave out 'size'"
    )
