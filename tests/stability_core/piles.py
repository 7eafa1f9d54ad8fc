"""Random piles as statics sees them: bodies, and the points at which they touch."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stability_core import GROUND, Contacts, Masses

LENGTH, DEPTH, THICKNESS = 0.117, 0.0234, 0.0078
MASS = 0.0119
UP = (0.0, 0.0, 1.0)
ACROSS = (-DEPTH / 2, DEPTH / 2)


class Pile:
    """Bodies and contacts, added one after the other."""

    def __init__(self, friction: float) -> None:
        self.friction = friction
        self.mass, self.center, self.rows = [], [], []

    def add(self, center: Sequence[float], mass: float) -> int:
        self.mass.append(mass)
        self.center.append(center)
        return len(self.mass) - 1

    def touch(self, upper: int, lower: int, points: Sequence[Sequence[float]], normal: Sequence[float] = UP) -> None:
        self.rows.extend((lower, upper, point, normal) for point in points)

    def world(self, turn: np.ndarray) -> tuple[Contacts, Masses]:
        """As the core takes it, the whole world turned."""
        lower, upper, point, normal = zip(*self.rows, strict=True)
        n = len(lower)
        return (
            Contacts(
                np.array(lower),
                np.array(upper),
                np.array(point) @ turn.T,
                np.array(normal) @ turn.T,
                np.zeros(n),
                np.zeros((n, 3)),
                np.full(n, self.friction),
            ),
            Masses(np.arange(len(self.mass)), np.array(self.mass), np.array(self.center) @ turn.T),
        )


def overlap(subject: np.ndarray, clip: np.ndarray) -> np.ndarray:
    """What two convex polygons share, shape (k, 2) (Sutherland and Hodgman)."""
    shape = list(subject)
    for a, b in zip(clip, np.roll(clip, -1, axis=0), strict=True):
        normal = np.array([a[1] - b[1], b[0] - a[0]])
        before, shape = shape, []
        for p, q in zip(before, before[1:] + before[:1], strict=True):
            inside_p, inside_q = normal @ (p - a), normal @ (q - a)
            if inside_p >= 0:
                shape.append(p)
            if inside_p * inside_q < 0:
                shape.append(p + (q - p) * (inside_p / (inside_p - inside_q)))
    return np.array(shape).reshape(-1, 2)


def level_pile(random: np.random.Generator, widest: float = 0.5) -> Pile:
    """3 to 12 yawed planks let go one after the other: each comes to lie on the highest that is below it.

    Their centres scatter by up to ``widest`` lengths either way.
    """
    pile, shapes, tops = Pile(random.uniform(0.1, 0.8)), [], []
    spread = random.uniform(0.05, widest)
    for body in range(random.integers(3, 13)):
        x, y = random.uniform(-spread, spread, 2) * LENGTH
        yaw = random.choice([random.uniform(0, np.pi), 0.5 * np.pi * random.integers(2)])
        turn = np.array([[np.cos(yaw), np.sin(yaw)], [-np.sin(yaw), np.cos(yaw)]])
        shape = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * (LENGTH / 2, DEPTH / 2) @ turn + (x, y)
        shared = [overlap(shape, other) for other in shapes]
        bottom = max([top for top, area in zip(tops, shared, strict=True) if len(area) > 2], default=0.0)
        pile.add((x, y, bottom + THICKNESS / 2), MASS * random.uniform(0.8, 1.2))
        if bottom == 0.0:
            pile.touch(body, GROUND, [(*corner, 0.0) for corner in shape])
        for other, area in enumerate(shared):
            if bottom > 0.0 and tops[other] == bottom and len(area) > 2:
                pile.touch(body, other, [(*corner, bottom) for corner in area])
        shapes.append(shape)
        tops.append(bottom + THICKNESS)
    return pile


def jostled_pile(random: np.random.Generator) -> Pile:
    """A level pile in which some planks also press against each other sideways."""
    pile = level_pile(random)
    for _ in range(3):
        a, b = random.choice(len(pile.mass), 2, replace=False)
        azimuth = random.uniform(0, 2 * np.pi)
        middle = (np.array(pile.center[a]) + np.array(pile.center[b])) / 2 + random.normal(0, THICKNESS / 2, 3)
        pile.touch(b, a, [middle], (np.cos(azimuth), np.sin(azimuth), 0.0))
    return pile


def roofed_pair(random: np.random.Generator) -> Pile:
    """Two inverted Vs, and a roof plank somewhere above them."""
    pile = Pile(random.uniform(0.1, 0.8))
    theta = random.uniform(np.radians(50), np.radians(85))
    across = (-DEPTH / 2, DEPTH / 2)
    spread, edge = LENGTH * np.cos(theta), THICKNESS * np.sin(theta)
    ridge, top = LENGTH * np.sin(theta), LENGTH * np.sin(theta) + THICKNESS * np.cos(theta)
    pitch = 2 * spread + random.uniform(0.01, 0.04)
    roof_at = pitch / 2 + random.uniform(-0.05, 0.05)
    edges = []
    for middle in (0.0, pitch):
        for side in (1.0, -1.0):
            foot = middle - side * spread
            body = pile.add((foot + side * (spread - edge) / 2, 0.0, top / 2), MASS)
            pile.touch(body, GROUND, [(foot, y, 0.0) for y in across])
            edges.append((body, middle - side * edge))
        pile.touch(body, body - 1, [(middle, y, ridge) for y in across], (1.0, 0.0, 0.0))
    roof = pile.add((roof_at, 0.0, top + THICKNESS / 2), MASS * random.uniform(0.5, 3.0))
    for body, x in edges:
        if abs(x - roof_at) < LENGTH / 2:
            pile.touch(roof, body, [(x, y, top) for y in across])
    return pile


def leaned_on_tower(random: np.random.Generator) -> Pile:
    """A tower of planks against whose top lean others, each on its short edge: 3 to 12 planks in all.

    A plank leans squarely against the long edge of the tower's top, or askew against one of its corners.
    """
    pile = Pile(random.uniform(0.1, 0.8))
    planks = int(random.integers(3, 13))
    leaning = int(random.integers(1, min(planks, 5)))
    height, spread = (planks - leaning) * THICKNESS, random.uniform(0.0, 0.2)
    least = random.uniform(np.radians(20), np.radians(70))
    x = y = 0.0
    below = None
    for level in range(planks - leaning):
        x, y = (x, y) + random.uniform(-spread, spread, 2) * (LENGTH, DEPTH)
        shape = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * (LENGTH / 2, DEPTH / 2) + (x, y)
        area = shape if below is None else overlap(shape, below)
        pile.add((x, y, (level + 0.5) * THICKNESS), MASS * random.uniform(0.8, 1.2))
        pile.touch(level, level - 1 if level else GROUND, [(*corner, level * THICKNESS) for corner in area])
        below = shape
    for _ in range(leaning):
        side = random.choice([-1.0, 1.0])
        askew = random.random() < 0.3
        azimuth = np.pi / 2 * side + (random.uniform(-0.7, 0.7) if askew else 0.0)
        along, across = np.array([np.cos(azimuth), np.sin(azimuth)]), np.array([-np.sin(azimuth), np.cos(azimuth)])
        at = np.array([x + LENGTH / 2 * (random.choice([-1, 1]) if askew else random.uniform(-0.9, 0.9)), y])
        at[1] -= side * DEPTH / 2
        lean_at(pile, planks - leaning - 1, at, height, along, across, least, random, askew=askew)
    return pile


def lean_at(
    pile: Pile,
    lower: int,
    at: np.ndarray,
    height: float,
    along: np.ndarray,
    across: np.ndarray,
    least: float,
    random: np.random.Generator,
    *,
    askew: bool,
) -> None:
    """A plank that stands on the ground and leans towards ``along`` against ``lower``, at ``at`` and ``height``.

    Its angle [rad] from the ground is at least ``least``.
    """
    theta = random.uniform(max(least, np.arcsin(height / LENGTH) + 0.02), np.radians(85))
    shift = random.uniform(-0.4, 0.4) * DEPTH if askew else 0.0
    foot = at - along * height / np.tan(theta) - across * shift
    rising = np.array([*(along * np.cos(theta)), np.sin(theta)])
    outward = np.array([*(-along * np.sin(theta)), np.cos(theta)])
    body = pile.add(np.array([*foot, 0.0]) + rising * LENGTH / 2 + outward * THICKNESS / 2, MASS)
    pile.touch(body, GROUND, [(*(foot + across * side), 0.0) for side in ACROSS])
    touching = [(*at, height)] if askew else [(*(at + across * side), height) for side in ACROSS]
    pile.touch(body, lower, touching, outward)


def laden_pair(random: np.random.Generator) -> Pile:
    """Two inverted Vs under a roof, and up to seven yawed planks stacked on that."""
    pile = roofed_pair(random)
    roof = len(pile.mass) - 1
    x, y, z = pile.center[roof]
    shape = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * (LENGTH / 2, DEPTH / 2)
    below, top, spread = shape + np.array([x, y]), z + THICKNESS / 2, random.uniform(0.0, 0.2)
    for _ in range(random.integers(0, 8)):
        x, y = (x, y) + random.uniform(-spread, spread, 2) * (LENGTH, DEPTH)
        yaw = random.uniform(-0.3, 0.3)
        turn = np.array([[np.cos(yaw), np.sin(yaw)], [-np.sin(yaw), np.cos(yaw)]])
        here = shape @ turn + (x, y)
        body = pile.add((x, y, top + THICKNESS / 2), MASS * random.uniform(0.8, 1.2))
        pile.touch(body, body - 1, [(*corner, top) for corner in overlap(here, below)])
        below, top = here, top + THICKNESS
    return pile
