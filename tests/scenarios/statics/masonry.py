"""Piles for tests of statics, as contact patches: arches, balls, logs, bricks that touch side by side."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from scenarios.model import Brick
from scenarios.planks import LENGTH, lean
from scenarios.statics.contact_patch import GROUND, Patch, contact_patches

DOWN = np.array([0.0, 0.0, -9.81])


class Pile(NamedTuple):
    """The arguments that ``solve_balance``, ``load_from_zero``, ``strong_stability`` and ``judge`` share."""

    centers: np.ndarray
    weights: np.ndarray
    patches: list[Patch]
    friction: float
    length: float


def of_bricks(bricks: Sequence[Brick], friction: float, *, walls: Sequence[Brick] = (), tilt: float = 0.0) -> Pile:
    """Bricks and the ground, and walls that never move.

    Args:
        bricks: what may fall.
        friction: Coulomb coefficient.
        walls: boxes that never move.
        tilt: by how much [rad] the horizontal normals are off, about the y axis; positive turns +x toward -z.
    """
    turn = np.array([[math.cos(tilt), 0, math.sin(tilt)], [0, 1, 0], [-math.sin(tilt), 0, math.cos(tilt)]])
    patches = [
        patch if abs(patch.normal[2]) > 0.1 else patch._replace(normal=turn @ patch.normal)
        for patch in contact_patches(bricks, walls)
    ]
    weights = np.outer([brick.mass for brick in bricks], DOWN)
    length = float(np.mean([max(brick.size) for brick in bricks]))
    return Pile(np.array([brick.position for brick in bricks]), weights, patches, friction, length)


# -- bricks ------------------------------------------------------------------------------------------------------------

BRICK = (0.1, 0.06, 0.03)
"""Edges [m]."""
TABLE = Brick((0.4, 0.06, 0.1), 1.0, (-0.2, 0.0, 0.05))
"""Its edge is at x = 0, its upper face at z = 0.1 m."""


def on_table(x: float, mass: float = 0.1) -> Brick:
    """A brick on the table, with its centre at x [m]."""
    return Brick(BRICK, mass, (x, 0.0, TABLE.size[2] + BRICK[2] / 2))


def overhang(beyond: float, *, neighbour: float = 10.0) -> list[Brick]:
    """A brick whose centre is ``beyond`` [m] the table's edge, and a neighbour [kg] that touches its inner end."""
    return [on_table(beyond), on_table(beyond - BRICK[0], neighbour)]


def load_at_the_tip(beyond: float, mass: float) -> Brick:
    """A cube of 10 mm at the outer end of the brick of ``overhang``."""
    return Brick((0.01, 0.01, 0.01), mass, (beyond + 0.045, 0.0, TABLE.size[2] + BRICK[2] + 0.005))


def inverted_v(theta: float, x: float = 0.0) -> list[Brick]:
    """Two planks that lean against each other at ``theta`` [rad] from the ground."""
    spread = LENGTH * math.cos(theta)
    return [lean(x - spread, theta=theta, toward=1, level=1), lean(x + spread, theta=theta, toward=-1, level=1)]


def jammed_rod(degrees: float) -> tuple[Brick, list[Brick]]:
    """A rod between two walls, at an angle to the horizontal, that touches them with an edge each."""
    length, thickness, angle = 0.1, 0.005, math.radians(degrees)
    half_gap = (length * math.cos(angle) + thickness * math.sin(angle)) / 2
    turn = (math.cos(angle / 2), 0.0, -math.sin(angle / 2), 0.0)
    walls = [Brick((0.1, 0.1, 0.4), 1.0, (side * (half_gap + 0.05), 0.0, 0.2)) for side in (-1, 1)]
    return Brick((length, 0.02, thickness), 0.1, (0.0, 0.0, 0.2), turn), walls


def tight_courses(random: np.random.Generator) -> list[Brick]:
    """A pedestal and one to three courses of bricks on it, whose sides touch; nine of ten need no side or must fall."""
    length, depth, height = 0.06, 0.03, 0.02
    low, high = np.array([-0.5, 0.5]) * random.uniform(0.08, 0.2)
    bricks = [Brick((high - low, depth, 0.1), 1.0, (0.0, 0.0, 0.05))]
    for course in range(int(random.integers(1, 4))):
        count = int(random.integers(2, 5))
        lengths = np.where(random.random(count) < 0.7, length, random.uniform(0.5, 1.5, count) * length)
        first, last = low - 0.6 * length, high + 0.6 * length - lengths.sum()
        slack = random.uniform(-0.3, 0.3) * length
        left = random.uniform(first, last) if last > first else (low + high - lengths.sum()) / 2 + slack
        low, x = left, left
        for brick in lengths:
            density = 500.0 * 10 ** random.uniform(-1, 1) if random.random() < 0.5 else 500.0
            size = (float(brick), depth, height)
            place = (float(x + brick / 2), 0.0, 0.1 + (course + 0.5) * height)
            bricks.append(Brick(size, density * math.prod(size), place))
            x += brick
        high = x
    return bricks


# -- arches, balls and logs --------------------------------------------------------------------------------------------


def arch(voussoirs: int, thickness: float, friction: float, *, embrace: float = 180.0, is_planar: bool = False) -> Pile:
    """An arch of equal voussoirs on the ground, of unit weight each and mean radius 1 m.

    Args:
        voussoirs: how many.
        thickness: over the mean radius; the depth is the same.
        friction: Coulomb coefficient.
        embrace: angle [deg] of the whole arch; a semicircle by default.
        is_planar: True for joints of two corners, in the plane of the arch, instead of four.
    """
    inner, outer, whole = 1 - thickness / 2, 1 + thickness / 2, math.radians(embrace)
    width = whole / voussoirs
    joints = math.pi / 2 + whole / 2 - width * np.arange(voussoirs + 1)
    centroid = 2 / 3 * (outer**3 - inner**3) / (outer**2 - inner**2) * math.sin(width / 2) / (width / 2)
    middles = joints[:-1] - width / 2
    centers = centroid * np.column_stack([np.cos(middles), np.zeros(voussoirs), np.sin(middles)])
    sides = [0.0] if is_planar else [-thickness / 2, thickness / 2]
    patches = []
    for index, angle in enumerate(joints):
        out, onward = np.array([[math.cos(angle), 0, math.sin(angle)], [math.sin(angle), 0, -math.cos(angle)]])
        points = np.array([radius * out + [0, y, 0] for radius in (inner, outer) for y in sides])
        if index == 0:
            patches.append(Patch(GROUND, 0, points, onward))
        elif index == voussoirs:
            patches.append(Patch(GROUND, voussoirs - 1, points, -onward))
        else:
            patches.append(Patch(index - 1, index, points, onward))
    return Pile(centers, np.tile([0.0, 0.0, -1.0], (voussoirs, 1)), patches, friction, max(thickness, width))


def balls(gap: float, friction: float) -> Pile:
    """Three balls of 1 m and unit weight on the ground, ``gap`` [m] apart, and a fourth that lies on them."""
    apart = 1 + gap
    low = np.array([[0, 0, 0.5], [apart, 0, 0.5], [apart / 2, apart * math.sqrt(3) / 2, 0.5]])
    top = low.mean(axis=0) + np.array([0, 0, math.sqrt(1 - apart**2 / 3)])
    patches = [Patch(GROUND, index, ball - [[0, 0, 0.5]], -DOWN / 9.81) for index, ball in enumerate(low)]
    patches += [Patch(index, 3, (top + ball)[None] / 2, top - ball) for index, ball in enumerate(low)]
    return Pile(np.vstack([low, top]), np.tile([0.0, 0.0, -1.0], (4, 1)), patches, friction, 1.0)


def logs(rows: int, gap: float, friction: float) -> Pile:
    """Rows of logs of 1 m across, ``gap`` [m] apart, each row one log shorter and in the furrows of the one below."""
    apart = 1 + gap
    rise = math.sqrt(1 - apart**2 / 4)
    places = [(row, column) for row in range(rows) for column in range(rows - row)]
    centers = np.array([[apart * (column + row / 2), 0.0, 0.5 + rise * row] for row, column in places])
    ends = np.array([[0.0, -1.5, 0.0], [0.0, 1.5, 0.0]])
    patches = []
    for index, (row, column) in enumerate(places):
        if row == 0:
            patches.append(Patch(GROUND, index, centers[index] - [0, 0, 0.5] + ends, -DOWN / 9.81))
            continue
        for below in (places.index((row - 1, column)), places.index((row - 1, column + 1))):
            normal = centers[index] - centers[below]
            patches.append(Patch(below, index, (centers[index] + centers[below]) / 2 + ends, normal))
    return Pile(centers, np.tile([0.0, 0.0, -1.0], (len(centers), 1)), patches, friction, 1.0)
