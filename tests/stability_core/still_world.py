"""A world that nothing moves: planks are laid, taken, held and let go at random, and the core freezes what it would.

What must fall stays where it is, live: the core is never helped by an engine that lets it fall.
"""

from __future__ import annotations

import numpy as np

from stability_core import GROUND, Contacts, Masses
from tests.stability_core.piles import DEPTH, LENGTH, MASS, THICKNESS, overlap

ROW = tuple[int, int, np.ndarray, np.ndarray]
"""Lower body, upper body, point [m], unit normal from lower to upper."""


class StillWorld:
    """A port to planks that lie on each other in layers, and to Vs that lean on the ground."""

    def __init__(self, random: np.random.Generator, friction: float) -> None:
        self.random, self.friction = random, friction
        self.center: dict[int, np.ndarray] = {}
        self.mass: dict[int, float] = {}
        self.shape: dict[int, tuple[np.ndarray, float]] = {}
        """Outline in plan (4, 2) [m] and top [m] of the planks that lie flat."""
        self.rows: list[ROW] = []
        self.frozen: set[int] = set()
        self.removed: list[int] = []
        self.next = 0

    def lay(self) -> None:
        """Lay a plank on the highest that is below it, at random; half of them touch a neighbour's end."""
        x, y = self.random.uniform(-1.0, 1.0, 2) * LENGTH
        yaw = float(self.random.choice([0.0, 0.5 * np.pi, self.random.uniform(0, np.pi)]))
        beside = None
        if self.shape and self.random.random() < 0.5:
            beside = int(self.random.choice(list(self.shape)))
            outline = self.shape[beside][0]
            along = (outline[1] - outline[0]) / np.linalg.norm(outline[1] - outline[0])
            yaw = float(np.arctan2(along[1], along[0]))
            x, y = self.center[beside][:2] + along * LENGTH * self.random.choice([-1.0, 1.0])
        turn = np.array([[np.cos(yaw), np.sin(yaw)], [-np.sin(yaw), np.cos(yaw)]])
        outline = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * (LENGTH / 2, DEPTH / 2) @ turn + (x, y)
        shared = {other: overlap(outline, below) for other, (below, _) in self.shape.items()}
        shared = {other: area for other, area in shared.items() if len(area) > 2 and np.ptp(area, axis=0).min() > 1e-4}
        bottom = max((self.shape[other][1] for other in shared), default=0.0)
        body = self.add((x, y, bottom + THICKNESS / 2), MASS * self.random.uniform(0.3, 3.0))
        self.shape[body] = (outline, bottom + THICKNESS)
        for other, area in shared.items():
            if self.shape[other][1] == bottom:
                self.touch(other, body, [(*corner, bottom) for corner in area], (0.0, 0.0, 1.0))
        if bottom == 0.0:
            self.touch(GROUND, body, [(*corner, 0.0) for corner in outline], (0.0, 0.0, 1.0))
        if beside is not None and self.shape[beside][1] == bottom + THICKNESS:
            toward = np.array([x, y, 0.0]) - np.append(self.center[beside][:2], 0.0)
            toward /= np.linalg.norm(toward)
            across = np.array([-toward[1], toward[0], 0.0]) * DEPTH / 2
            middle = (self.center[beside] + self.center[body]) / 2
            corners = [middle + s * across + (0, 0, z) for s in (-1, 1) for z in (-THICKNESS / 2, THICKNESS / 2)]
            self.touch(beside, body, corners, toward)

    def lean(self) -> None:
        """An inverted V on the ground, at random."""
        theta, (x, y) = self.random.uniform(np.radians(45), np.radians(85)), self.random.uniform(2.0, 6.0, 2) * LENGTH
        spread, ridge = LENGTH * np.cos(theta), LENGTH * np.sin(theta)
        ends = (y - DEPTH / 2, y + DEPTH / 2)
        pair = [self.add((x + side * spread / 2, y, ridge / 2), MASS) for side in (-1.0, 1.0)]
        for body, side in zip(pair, (-1.0, 1.0), strict=True):
            self.touch(GROUND, body, [(x + side * spread, end, 0.0) for end in ends], (0.0, 0.0, 1.0))
        self.touch(pair[0], pair[1], [(x, end, ridge) for end in ends], (1.0, 0.0, 0.0))

    def add(self, center, mass: float) -> int:
        body, self.next = self.next, self.next + 1
        self.center[body], self.mass[body] = np.array(center), mass
        return body

    def touch(self, lower: int, upper: int, points, normal) -> None:
        self.rows.extend((lower, upper, np.array(point), np.array(normal)) for point in points)

    def take(self, body: int) -> None:
        del self.center[body], self.mass[body]
        self.shape.pop(body, None)
        self.rows = [row for row in self.rows if body not in row[:2]]
        self.frozen.discard(body)
        self.removed.append(body)

    def snapshot(self, bodies: set[int]) -> tuple[Contacts, Masses]:
        """The ``bodies``, and the contacts between them and with the ground."""
        among = bodies | {GROUND}
        return self._contacts([row for row in self.rows if row[0] in among and row[1] in among]), self._masses(bodies)

    def contacts(self) -> Contacts:
        still = self.frozen | {GROUND}
        return self._contacts([row for row in self.rows if not {row[0], row[1]} <= still])

    def masses(self) -> Masses:
        removed, self.removed = self.removed, []
        return self._masses(self.center.keys() - self.frozen, removed)

    def sleep(self, bodies) -> None:
        self.frozen.update(bodies)

    def wake(self, bodies) -> None:
        self.frozen.difference_update(bodies)

    def _contacts(self, rows: list[ROW]) -> Contacts:
        if not rows:
            return Contacts.empty()
        lower, upper, point, normal = zip(*rows, strict=True)
        n = len(rows)
        return Contacts(
            np.array(lower),
            np.array(upper),
            np.array(point),
            np.array(normal),
            np.zeros(n),
            np.zeros((n, 3)),
            np.full(n, self.friction),
        )

    def _masses(self, bodies, removed=()) -> Masses:
        ids = sorted(bodies)
        return Masses(
            np.array(ids, np.int64),
            np.array([self.mass[body] for body in ids], float),
            np.array([self.center[body] for body in ids], float).reshape(-1, 3),
            removed,
        )
