"""Structures in which friction decides, with known answers: overhangs beside a neighbour, arches, logs, spheres."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from stability_core import GROUND
from tests.stability_core.piles import UP, Pile

LONG, WIDE, HIGH = 0.1, 0.04, 0.02
"""Edges [m] of a brick."""
ENDS = (-WIDE / 2, WIDE / 2)


def tilted(normal: tuple[float, float, float], angle: float) -> tuple[float, float, float]:
    """A normal in the x-z plane, turned upward by ``angle`` [rad]."""
    x, _, z = normal
    return (x * np.cos(angle) - np.sign(x) * z * np.sin(angle), 0.0, z * np.cos(angle) + abs(x) * np.sin(angle))


def overhang(
    excess: float,
    friction: float = 0.45,
    *,
    outer: float = 0.0,
    at: float = LONG,
    neighbour: float = 10.0,
    side_tilt: float = 0.0,
    is_beside: bool = True,
) -> Pile:
    """A brick on a table, its centre ``excess`` [m] beyond the edge, its inner end against a heavy neighbour.

    The neighbour stands flush with the brick. The table's edge is x = 0 and its top z = 0.

    Args:
        excess: how far the brick's centre lies beyond the edge; negative if it lies over the table.
        friction: of all contacts.
        outer: mass [kg] of a block on the brick; 0 for none.
        at: where along x the block's centre lies, from the brick's inner end [m].
        neighbour: mass [kg] of the neighbour; the brick has 1 kg.
        side_tilt: angle [rad] by which the side contact's normal, from the neighbour to the brick, is turned upward.
        is_beside: False to leave the side contact out.
    """
    pile = Pile(friction)
    inner = excess - LONG / 2
    brick = pile.add((excess, 0.0, HIGH / 2), 1.0)
    pile.touch(brick, GROUND, [(x, y, 0.0) for x in (inner, min(0.0, inner + LONG)) for y in ENDS])
    beside = pile.add((inner - LONG / 2, 0.0, HIGH / 2), neighbour)
    pile.touch(beside, GROUND, [(x, y, 0.0) for x in (inner - LONG, inner) for y in ENDS])
    if is_beside:
        points = [(inner, y, z) for y in ENDS for z in (0.0, HIGH)]
        pile.touch(brick, beside, points, tilted((1.0, 0.0, 0.0), side_tilt))
    if outer:
        block = pile.add((inner + at, 0.0, 1.25 * HIGH), outer)
        corners = [(inner + at + x, y, HIGH) for x in (-HIGH / 4, HIGH / 4) for y in (-HIGH / 4, HIGH / 4)]
        pile.touch(block, brick, corners)
    return pile


def arch(voussoirs: int, thickness: float, friction: float, embrace: float = np.pi) -> Pile:
    """A circular arch of mean radius 1 m that springs from the ground, ``thickness`` [m] thick and 0.3 m deep.

    Args:
        voussoirs: their number.
        thickness: over the mean radius.
        friction: of all joints.
        embrace: the arch's angle [rad]; pi for a semicircle.
    """
    pile = Pile(friction)
    angles = np.linspace(np.pi / 2 + embrace / 2, np.pi / 2 - embrace / 2, voussoirs + 1)
    half = (angles[0] - angles[1]) / 2
    inner, outer = 1.0 - thickness / 2, 1.0 + thickness / 2
    center = 2 / 3 * (outer**3 - inner**3) / (outer**2 - inner**2) * np.sin(half) / half  # of an annular sector
    for first, last in pairwise(angles):
        middle = (first + last) / 2
        pile.add((center * np.cos(middle), 0.0, center * np.sin(middle)), (outer**2 - inner**2) * half)
    for joint, angle in enumerate(angles):
        before, after = joint - 1, joint
        corners = [(r * np.cos(angle), y, r * np.sin(angle)) for r in (inner, outer) for y in (-0.15, 0.15)]
        clockwise = (np.sin(angle), 0.0, -np.cos(angle))
        if joint == voussoirs:
            pile.touch(before, GROUND, corners, tuple(-np.array(clockwise)))
        else:
            pile.touch(after, before if joint else GROUND, corners, clockwise)
    return pile


def logs(gap: float, friction: float, noise: float = 0.0) -> Pile:
    """Two logs of radius 1 m on the ground, ``gap`` [radii] apart, and a third on them.

    Args:
        gap: between the surfaces of the lower ones.
        friction: of all contacts.
        noise: standard deviation [m] by which each contact point errs in every direction; drawn from seed 0.
    """
    random = np.random.default_rng(0)
    pile = Pile(friction)
    half = 1.0 + gap / 2
    rise = np.sqrt(4.0 - half**2)
    centers = [(-half, 0.0, 1.0), (half, 0.0, 1.0), (0.0, 0.0, 1.0 + rise)]
    for center in centers:
        pile.add(center, 1.0)
    for lower in (0, 1):
        pile.touch(lower, GROUND, _noisy([(centers[lower][0], y, 0.0) for y in (-2.0, 2.0)], noise, random))
        normal = (np.array(centers[2]) - centers[lower]) / 2
        points = [np.array(centers[lower]) + normal + np.array([0.0, y, 0.0]) for y in (-2.0, 2.0)]
        pile.touch(2, lower, _noisy(points, noise, random), tuple(normal))
    return pile


def spheres(gap: float, friction: float, noise: float = 0.0, seed: int = 0) -> Pile:
    """Three spheres of radius 1 m on the ground, ``gap`` [radii] apart, and a fourth on them; arguments as ``logs``."""
    random = np.random.default_rng(seed)
    pile = Pile(friction)
    side = 2.0 + gap
    out = side / np.sqrt(3.0)
    around = 2 * np.pi * np.arange(3) / 3
    centers = [np.array([out * np.cos(angle), out * np.sin(angle), 1.0]) for angle in around]
    centers.append(np.array([0.0, 0.0, 1.0 + np.sqrt(4.0 - out**2)]))
    for center in centers:
        pile.add(center, 1.0)
    for lower in range(3):
        pile.touch(lower, GROUND, _noisy([(*centers[lower][:2], 0.0)], noise, random))
        normal = (centers[3] - centers[lower]) / 2
        pile.touch(3, lower, _noisy([centers[lower] + normal], noise, random), tuple(normal))
    return pile


def _noisy(points, noise: float, random: np.random.Generator) -> list[np.ndarray]:
    return [np.array(point) + noise * random.normal(size=3) for point in points]


def rod_between_walls(angle: float, friction: float) -> Pile:
    """A rod of 0.1 m that is jammed between two walls, its right end higher by ``angle`` [rad]."""
    pile = Pile(friction)
    x, z = 0.05 * np.cos(angle), 0.05 * np.sin(angle)
    rod = pile.add((0.0, 0.0, 0.5), 1.0)
    pile.touch(rod, GROUND, [(-x, y, 0.5 - z) for y in ENDS], (1.0, 0.0, 0.0))
    pile.touch(rod, GROUND, [(x, y, 0.5 + z) for y in ENDS], (-1.0, 0.0, 0.0))
    return pile


def brick_between_walls(friction: float) -> Pile:
    """A brick in mid-air whose ends touch a wall each with all their faces."""
    pile = Pile(friction)
    brick = pile.add((0.0, 0.0, 0.5), 1.0)
    for side in (-1.0, 1.0):
        corners = [(side * LONG / 2, y, 0.5 + z) for y in ENDS for z in (-HIGH / 2, HIGH / 2)]
        pile.touch(brick, GROUND, corners, (-side, 0.0, 0.0))
    return pile


def inverted_v(theta: float, friction: float, pile: Pile | None = None, x: float = 0.0) -> Pile:
    """Two thin planks of 0.1 m that lean against each other at ``theta`` [rad], a horizontal force at the ridge."""
    pile = Pile(friction) if pile is None else pile
    spread, ridge = LONG * np.cos(theta), LONG * np.sin(theta)
    planks = []
    for side in (-1.0, 1.0):
        planks.append(pile.add((x + side * spread / 2, 0.0, ridge / 2), 0.1))
        pile.touch(planks[-1], GROUND, [(x + side * spread, y, 0.0) for y in ENDS], UP)
    pile.touch(planks[1], planks[0], [(x, y, ridge) for y in ENDS], (1.0, 0.0, 0.0))
    return pile
