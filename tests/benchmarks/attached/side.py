"""The planks of ``tests.benchmarks.attach_cost``, and what both of its worlds do."""

from __future__ import annotations

import time
from abc import ABC, abstractmethod

from stability_core import StabilityExtension

SIZE, MASS = (0.117, 0.0234, 0.0078), 0.0119
"""Edges [m] and mass [kg] of a plank."""
FROZEN = 100
"""Number of frozen planks."""
FRAME_S = 1 / 60
FRICTION = 0.45
PARKED = (3.5, 0.0, SIZE[2] / 2)
"""Place at which the loose plank freezes first [m]."""
ABOVE = (0.0, 0.0, 1.5 * SIZE[2] + 5e-4)
"""Place from which the loose plank falls on the first plank of the grid [m]."""
PARKED_IN_PLANE = (-1.0, 0.0, SIZE[2] / 2)
"""As ``PARKED``, in a planar engine."""


def place(index: int) -> tuple[float, float, float]:
    """Return the place of a plank in a grid on the ground [m]."""
    row, column = divmod(index, 20)
    return 0.15 * column, 0.05 * row, SIZE[2] / 2


def place_in_plane(index: int) -> tuple[float, float, float]:
    """Return the place of a plank in a row on the ground of a planar engine [m]."""
    return 0.15 * index, 0.0, SIZE[2] / 2


class Side(ABC):
    """One of two worlds that take turns."""

    extension: StabilityExtension
    falling: int

    def build(self) -> None:
        """Freeze the planks of the grid."""
        self.frames(60)
        assert len(self.extension.frozen) == FROZEN + 1, len(self.extension.frozen)

    def frames(self, count: int) -> None:
        """Play some frames."""
        for _ in range(count):
            self.frame()

    def frame(self) -> int:
        """Play a frame; return its CPU time [ns]."""
        start = time.thread_time_ns()
        self.step()
        self.extension.update(FRAME_S)
        return time.thread_time_ns() - start

    def is_quiet(self) -> bool:
        """Return True if the loose plank is frozen."""
        return self.extension.why(self.falling).startswith("frozen")

    @abstractmethod
    def step(self) -> None:
        """Make the engine's steps of a frame."""

    @abstractmethod
    def drop(self) -> None:
        """Let the loose plank fall on the first plank of the grid."""
