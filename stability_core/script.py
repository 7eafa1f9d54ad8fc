"""A scripted world that exercises the whole core: the script builds, strikes and undermines a stack.

One run of the script compiles all kernels of a policy, or reads them from Numba's cache.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple, Protocol

import numpy as np

from stability_core.port import GROUND, Contacts, Masses

_FRAME_S = 1 / 60
_RESTING_FRAMES = 90
"""Number of frames in a part of the script: 1.5 s, because a body in doubt freezes after ``doubt_s`` = 1 s."""
_HALF = 0.05
"""Half the edge of the cubes [m]."""
_UP, _ASIDE = (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)
_STILL = (0.0, 0.0, 0.0)
_DEEP = (-_HALF, _HALF)
_FAST = (0.0, 0.0, -5.0)
_PUSH = (20.0, 0.0, 0.0)
"""Force [N] at each of four points of a side contact. Friction holds less, because the cube weighs 9.81 N."""
_TILTED = (0.5, 0.0, -9.81)


class _Touch(NamedTuple):
    lower: int
    upper: int
    points: Sequence[tuple[float, float, float]]
    normal: tuple[float, float, float] = _UP
    velocity: tuple[float, float, float] = _STILL


def _area(lower: int, upper: int, x: tuple[float, float], z: float) -> _Touch:
    return _Touch(lower, upper, [(i, j, z) for i in x for j in _DEEP])


def _side(first: int, second: int, x: float) -> _Touch:
    return _Touch(first, second, [(x, y, z) for y in _DEEP for z in (0.5, 0.6)], _ASIDE)


_CUBES = {
    0: (0.0, 0.0, 0.05),  # two cubes on the ground, one across both, one on top
    1: (0.12, 0.0, 0.05),
    2: (0.06, 0.0, 0.15),
    3: (0.06, 0.0, 0.25),
    4: (0.95, 0.0, 0.08),  # two cubes that lean on each other
    5: (1.05, 0.0, 0.08),
    6: (2.00, 0.0, 0.55),  # a cube on the ground's edge, and a cube beside it that only friction holds
    7: (2.10, 0.0, 0.55),
    8: (3.0, 0.0, 0.05),  # a ball
    9: (0.1, 0.0, 0.35),  # a cube that appears later in the script, and overloads an edge of cube 3
}
_LATE = 9
_TOUCHES = (
    _area(GROUND, 0, _DEEP, 0.0),
    _area(GROUND, 1, (0.07, 0.17), 0.0),
    _area(0, 2, (0.01, 0.05), 0.1),
    _area(1, 2, (0.07, 0.11), 0.1),
    _area(2, 3, (0.01, 0.11), 0.2),
    _Touch(GROUND, 4, [(0.93, y, 0.0) for y in _DEEP]),
    _Touch(GROUND, 5, [(1.07, y, 0.0) for y in _DEEP]),
    _Touch(4, 5, [(1.0, y, 0.15) for y in _DEEP], _ASIDE),
    _area(GROUND, 6, (1.95, 2.05), 0.5),
    _area(GROUND, 7, (2.05, 2.09), 0.5),
    _side(6, 7, 2.05),
    _Touch(GROUND, 8, [(3.0, 0.0, 0.0)]),
    _area(3, 9, (0.10, 0.11), 0.3),
)


class ScriptedPort:
    """Port of the scripted world, with bodies at rest that obey ``sleep`` and ``wake``."""

    def __init__(self) -> None:
        self.bodies = {body: center for body, center in _CUBES.items() if body != _LATE}
        self.velocity = self.push = _STILL
        self._frozen: set[int] = set()
        self._removed: list[int] = []

    def take_away(self, body: int) -> None:
        """Remove a body, so that the bodies on it unfreeze."""
        del self.bodies[body]
        self._frozen.discard(body)
        self._removed.append(body)

    def contacts(self) -> Contacts:
        """Return the contacts of live bodies."""
        rows = [(touch, point) for touch in _TOUCHES if self._is_seen(touch) for point in touch.points]
        count = len(rows)
        return Contacts(
            np.array([touch.lower for touch, _ in rows], np.int64),
            np.array([touch.upper for touch, _ in rows], np.int64),
            np.array([point for _, point in rows]).reshape(-1, 3),
            np.array([touch.normal for touch, _ in rows]).reshape(-1, 3),
            np.zeros(count),
            np.tile(self.velocity, (count, 1)),
            np.full(count, 0.6),
            np.array([self.push if touch.normal == _ASIDE else _STILL for touch, _ in rows]).reshape(-1, 3),
        )

    def masses(self) -> Masses:
        """Return the live bodies, with a mass of 1 kg each, and the bodies removed since the last call."""
        live = sorted(self.bodies.keys() - self._frozen)
        removed, self._removed = self._removed, []
        centers = np.array([self.bodies[body] for body in live]).reshape(-1, 3)
        return Masses(np.array(live, np.int64), np.ones(len(live)), centers, removed)

    def sleep(self, bodies: Sequence[int]) -> None:
        """Freeze bodies."""
        self._frozen.update(bodies)

    def wake(self, bodies: Sequence[int]) -> None:
        """Unfreeze bodies."""
        self._frozen.difference_update(bodies)

    def _is_seen(self, touch: _Touch) -> bool:
        pair = {touch.lower, touch.upper} - {GROUND}
        return pair <= self.bodies.keys() and not pair <= self._frozen


class ScriptedExtension(Protocol):
    """The methods of ``StabilityExtension`` that the script uses."""

    gravity: tuple[float, float, float]

    def update(self, dt: float) -> object:
        """Read the world after a step."""

    def adopt(self, bodies: Iterable[int] | None = None) -> object:
        """Judge bodies at once."""

    def disturb(self, bodies: Iterable[int]) -> None:
        """Hold bodies."""

    def release(self, bodies: Iterable[int]) -> None:
        """Release bodies."""


def play_script(extension: ScriptedExtension, port: ScriptedPort) -> None:
    """Play the script: let ``extension`` adopt, freeze, hold, release and unfreeze the bodies of ``port``."""

    def rest() -> None:
        for _ in range(_RESTING_FRAMES):
            extension.update(_FRAME_S)

    extension.adopt([0, 1])
    rest()
    port.bodies[_LATE] = _CUBES[_LATE]
    rest()
    port.velocity = _FAST  # live bodies strike their neighbours
    rest()
    port.velocity = _STILL
    extension.disturb([2])
    rest()
    extension.release([2])
    rest()
    port.take_away(1)
    rest()
    extension.gravity = _TILTED
    rest()
    port.push = _PUSH  # a live cube pushes a frozen cube away
    rest()
