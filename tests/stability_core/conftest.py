"""A world without physics: what touches what, and how it moves, is said by the test."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np
import pytest

from stability_core import GROUND, Contacts, Masses

UP = (0.0, 0.0, 1.0)
STILL = (0.0, 0.0, 0.0)


@dataclass
class Touch:
    lower: int
    upper: int
    points: Sequence[Sequence[float]]
    normal: Sequence[float] = UP
    friction: float = 0.45
    separation: float = 0.0
    velocity: Sequence[float] = STILL
    force: Sequence[float] | None = None
    """On the upper body at each point [N]; None if the engine does not report it."""


@dataclass
class FakePort:
    """Contacts and masses by hand; remembers every batch of sleep and wake."""

    mass: dict[int, float] = field(default_factory=dict)
    center: dict[int, Sequence[float]] = field(default_factory=dict)
    touches: list[Touch] = field(default_factory=list)
    frozen: set[int] = field(default_factory=set)
    batches: list[tuple[str, list[int]]] = field(default_factory=list)
    removed: list[int] = field(default_factory=list)
    show_frozen: bool = False
    """Whether masses() lists frozen bodies too, as a port may."""

    def add(self, body: int, center: Sequence[float], mass: float = 1.0) -> None:
        self.mass[body], self.center[body] = mass, center

    def touch(self, upper: int, lower: int, points: Sequence[Sequence[float]], **more: object) -> None:
        self.touches.append(Touch(lower, upper, points, **more))  # type: ignore[arg-type]

    def lay(self, upper: int, lower: int, x: Sequence[float], y: Sequence[float], z: float, **more: object) -> None:
        """A level rectangular contact area."""
        self.touch(upper, lower, [(i, j, z) for i in x for j in y], **more)

    def remove(self, body: int) -> None:
        del self.mass[body], self.center[body]
        self.touches = [touch for touch in self.touches if body not in (touch.lower, touch.upper)]
        self.frozen.discard(body)
        self.removed.append(body)

    def contacts(self) -> Contacts:
        rows = [
            (touch, point)
            for touch in self.touches
            if not {touch.lower, touch.upper} <= self.frozen | {GROUND}
            for point in touch.points
        ]
        if not rows:
            return Contacts.empty()
        return Contacts(
            np.array([touch.lower for touch, _ in rows]),
            np.array([touch.upper for touch, _ in rows]),
            np.array([point for _, point in rows], float),
            np.array([touch.normal for touch, _ in rows], float),
            np.array([touch.separation for touch, _ in rows], float),
            np.array([touch.velocity for touch, _ in rows], float),
            np.array([touch.friction for touch, _ in rows], float),
            self._forces([touch for touch, _ in rows]),
        )

    @staticmethod
    def _forces(rows: Sequence[Touch]) -> np.ndarray | None:
        if all(touch.force is None for touch in rows):
            return None
        return np.array([touch.force or STILL for touch in rows], float)

    def masses(self) -> Masses:
        live = sorted(self.mass.keys() - (set() if self.show_frozen else self.frozen))
        removed, self.removed = self.removed, []
        return Masses(
            np.array(live, np.int64),
            np.array([self.mass[body] for body in live], float),
            np.array([self.center[body] for body in live], float).reshape(-1, 3),
            removed,
        )

    def sleep(self, bodies: Iterable[int]) -> None:
        self.batches.append(("sleep", list(bodies)))
        self.frozen.update(bodies)

    def wake(self, bodies: Iterable[int]) -> None:
        self.batches.append(("wake", list(bodies)))
        self.frozen.difference_update(bodies)


@pytest.fixture
def port() -> FakePort:
    return FakePort()
