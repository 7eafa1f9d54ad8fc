"""A check that the time passed to ``update`` is the time of the engine's steps, from bodies in free flight.

A body without contacts moves by its velocity times the length of the frame. If it moves by another multiple in several
frames in a row, the host has stepped more or less often than it says.
"""

from __future__ import annotations

import numpy as np

from stability_core.port import BoolArray, FloatArray, IntArray

LEAST, MOST = 0.6, 1.5
"""Ratios of the way to the velocity times the length of the frame that count as right. The ratio is 1 up to gravity and
damping, and a wrong number of steps gives at most 1/2 or at least 2."""
FRAMES = 3
"""Number of frames in a row after which the check reports a wrong time, because a host may move a body by hand."""
SPEED = 0.2
"""Least speed [m/s] of a body in free flight."""
ALIKE = 0.2
"""Greatest relative difference of the ratios of consecutive frames."""


class FreeFlight:
    """The latest ratio of a body in free flight, and the number of frames in a row with that ratio."""

    def __init__(self) -> None:
        self._ratio, self._frames = 1.0, 0

    def fault(
        self, bodies: IntArray, flying: BoolArray, way: FloatArray, before: FloatArray, now: FloatArray, dt: float
    ) -> str | None:
        """Return a message if bodies in free flight contradict ``dt``.

        Args:
            bodies: ids, shape (n,).
            flying: bodies without contacts in this and the previous frame, shape (n,).
            way: ways since the previous update [m], shape (n, 3).
            before: velocities after the previous update [m/s], shape (n, 3).
            now: velocities [m/s], shape (n, 3).
            dt: time passed to ``update`` [s].
        """
        expected = (np.linalg.norm(before, axis=1) + np.linalg.norm(now, axis=1)) / 2 * dt
        fast = np.flatnonzero(flying & (expected > SPEED * dt))
        if not len(fast):
            self._frames = 0
            return None
        row = fast[0]
        ratio = float(np.linalg.norm(way[row]) / expected[row])
        alike = abs(ratio - self._ratio) <= ALIKE * max(ratio, self._ratio)
        self._frames = (self._frames + 1 if alike else 1) if not LEAST <= ratio <= MOST else 0
        self._ratio = ratio
        if self._frames < FRAMES:
            return None
        self._frames = 0
        return (
            f"body {bodies[row]} is in free flight and moved {ratio:.2g} times its velocity times dt = {dt:g} s, in "
            f"{FRAMES} frames in a row: call update() after the engine's steps, and pass the time of all steps since "
            "the previous update()"
        )
