"""Statistics of freezing: how often the core froze and unfroze bodies, and how long a body stayed live."""

from __future__ import annotations

from collections.abc import Iterable


class SleepStats:
    """Counter of the bodies that the core freezes and unfreezes, frame by frame."""

    def __init__(self) -> None:
        self._live_since: dict[int, float] = {}
        self._ever_frozen: set[int] = set()
        self._longest_live_s = 0.0
        self.wakes = 0
        """Number of times that the core unfroze a body."""
        self.refreezes = 0
        """Number of times that the core froze a body that it had frozen before."""

    def see(self, begin: float, end: float, bodies: Iterable[int], frozen: Iterable[int], woken: Iterable[int]) -> None:
        """Record one frame.

        Args:
            begin: start of the frame [s], which is the release time of new bodies.
            end: end of the frame [s], at which the core froze and unfroze bodies.
            bodies: ids of all bodies in the world.
            frozen: ids of the bodies that the core froze in this frame.
            woken: ids of the bodies that the core unfroze in this frame.
        """
        for body in bodies:
            if body not in self._live_since and body not in self._ever_frozen:
                self._live_since[body] = begin
        for body in frozen:
            self._longest_live_s = max(self._longest_live_s, end - self._live_since.pop(body, end))
            self.refreezes += body in self._ever_frozen
            self._ever_frozen.add(body)
        for body in woken:
            self._live_since[body] = end
            self.wakes += 1

    def longest_live_s(self, now: float) -> float:
        """Return the longest time for which a body stayed live without interruption [s].

        Bodies that are still live, or left the world while live, count up to the present time ``now`` [s].
        """
        return max([self._longest_live_s, *(now - since for since in self._live_since.values())])
