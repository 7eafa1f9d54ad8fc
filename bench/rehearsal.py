"""Compiles the core before anything is timed: a scripted stack is built, frozen and undermined, without any engine."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stability_core import StabilityExtension
from stability_core.port import GROUND, Contacts, Masses

_FRAME_S = 1 / 60
_RESTING_FRAMES = 30
"""Enough for every body to freeze."""
_HALF = 0.05
"""Half the edge of the cubes [m]."""
_STACK = {0: (0.0, 1), 1: (0.12, 1), 2: (0.06, 2), 3: (0.06, 3)}
"""x [m] and level of each cube: two on the ground, one across both, one on top."""
_PAIRS = ((GROUND, 0), (GROUND, 1), (0, 2), (1, 2), (2, 3))
_LEANING_PAIRS = ((GROUND, 4, 0.3, 0.0, (0.0, 0.0, 1.0)), (0, 4, 0.34, 0.08, (-0.6, 0.0, 0.8)))
"""A fifth cube that stands on an edge and leans: its contacts' x and z [m], and their normals."""
_LEANING_CENTER = (0.32, 0.0, 0.06)


class _ScriptedPort:
    """Cubes at rest that obey sleep and wake, and one of which is taken away."""

    def __init__(self) -> None:
        self._centers = {body: (x, 0.0, (2 * level - 1) * _HALF) for body, (x, level) in _STACK.items()}
        self._centers[4] = _LEANING_CENTER
        self._frozen: set[int] = set()
        self._removed: list[int] = []

    def take_away(self, body: int) -> None:
        """Remove a body, so that what rests on it must wake."""
        del self._centers[body]
        self._frozen.discard(body)
        self._removed.append(body)

    def contacts(self) -> Contacts:
        """Four corners of each pair of cubes, and the edges of the leaning one."""
        rows = [
            (a, b, (x + dx, dy, z), (0.0, 0.0, 1.0))
            for a, b in _PAIRS
            for x, z in self._patch(a, b)
            for dx, dy in _CORNERS
        ]
        rows += [(a, b, (x, dy, z), n) for a, b, x, z, n in _LEANING_PAIRS for dy in (-_HALF, _HALF)]
        kept = [row for row in rows if self._is_live(row[0]) or self._is_live(row[1])]
        kept = [row for row in kept if all(body == GROUND or body in self._centers for body in row[:2])]
        if not kept:
            return Contacts.empty()
        a, b, points, normals = zip(*kept, strict=True)
        count = len(kept)
        return Contacts(
            np.array(a, np.int64),
            np.array(b, np.int64),
            np.array(points),
            np.array(normals),
            np.zeros(count),
            np.zeros((count, 3)),
            np.full(count, 0.45),
        )

    def masses(self) -> Masses:
        """One kilogram a live cube."""
        live = [body for body in self._centers if self._is_live(body)]
        removed, self._removed = self._removed, []
        centers = np.array([self._centers[body] for body in live]).reshape(-1, 3)
        return Masses(np.array(live, np.int64), np.ones(len(live)), centers, removed)

    def sleep(self, bodies: Sequence[int]) -> None:
        """Freeze."""
        self._frozen.update(bodies)

    def wake(self, bodies: Sequence[int]) -> None:
        """Let live."""
        self._frozen.difference_update(bodies)

    def _is_live(self, body: int) -> bool:
        return body in self._centers and body not in self._frozen

    def _patch(self, lower: int, upper: int) -> list[tuple[float, float]]:
        """Middle x and height z [m] of the contact between two cubes; none once one has been taken away."""
        if upper not in self._centers or (lower != GROUND and lower not in self._centers):
            return []
        x, _, z = self._centers[upper]
        below = x if lower == GROUND else self._centers[lower][0]
        return [((x + below) / 2, z - _HALF)]


_CORNERS = ((-0.02, -_HALF), (0.02, -_HALF), (0.02, _HALF), (-0.02, _HALF))


def rehearse(policy: str) -> None:
    """Run every part of the core once under ``policy``, so that it is compiled or read from the cache."""
    port = _ScriptedPort()
    extension = StabilityExtension(port, policy=policy)
    for _ in range(_RESTING_FRAMES):
        extension.update(_FRAME_S)
    port.take_away(1)
    for _ in range(_RESTING_FRAMES):
        extension.update(_FRAME_S)
