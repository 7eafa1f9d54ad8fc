"""Count which bodies the core froze and unfroze, how often, and how long a body stayed live."""

from __future__ import annotations

from collections.abc import Iterable


class SleepStats:
    """Takes the core's changes, frame by frame."""

    def __init__(self) -> None:
        self._live_since: dict[int, float] = {}
        self._ever_frozen: set[int] = set()
        self._longest_live_s = 0.0
        self.wakes = 0
        self.refreezes = 0

    def see(self, begin: float, end: float, bodies: Iterable[int], frozen: Iterable[int], woken: Iterable[int]) -> None:
        """Take one frame.

        Args:
            begin: start of the frame [s]; a body seen for the first time was released then.
            end: end of the frame [s], when the core froze and unfroze.
            bodies: all bodies in the world.
            frozen: bodies that the core froze in this frame.
            woken: bodies that the core unfroze in this frame.
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
        """Return the longest time [s] that one body stayed live, including bodies that still are."""
        return max([self._longest_live_s, *(now - since for since in self._live_since.values())])
