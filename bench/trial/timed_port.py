"""Ports that measure the time or the instructions of their calls, so that the harness can exclude the calls."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from time import perf_counter
from typing import TypeVar

from bench.welding import Pair, WeldPort
from stability_core.port import Contacts, Masses

_Result = TypeVar("_Result")


class TimedPort:
    """Port that forwards every call to another port and sums the times of the calls since the last ``reset``."""

    __slots__ = ("_clock", "_port", "contact_points", "readback_s", "steering_s")

    def __init__(self, port: WeldPort, clock: Callable[[], float] = perf_counter) -> None:
        """Wrap a port.

        Args:
            port: the port that receives the calls.
            clock: function that returns the time [s].
        """
        self._port = port
        self._clock = clock
        self.reset()

    def reset(self) -> None:
        """Set all sums to zero, at the start of a frame."""
        self.readback_s = 0.0
        """Time in ``contacts`` and ``masses`` [s]."""
        self.steering_s = 0.0
        """Time in ``sleep``, ``wake``, ``join`` and ``part`` [s]."""
        self.contact_points = 0
        """Number of contact points read."""

    def contacts(self) -> Contacts:
        """Return every contact that touches a live body after the latest step."""
        begin = self._clock()
        contacts = self._port.contacts()
        self.readback_s += self._clock() - begin
        self.contact_points += len(contacts)
        return contacts

    def masses(self) -> Masses:
        """Return the live bodies as they are after the latest step."""
        begin = self._clock()
        masses = self._port.masses()
        self.readback_s += self._clock() - begin
        return masses

    def sleep(self, bodies: Sequence[int]) -> None:
        """Freeze bodies exactly where they are."""
        begin = self._clock()
        self._port.sleep(bodies)
        self.steering_s += self._clock() - begin

    def wake(self, bodies: Sequence[int]) -> None:
        """Return frozen bodies to the engine."""
        begin = self._clock()
        self._port.wake(bodies)
        self.steering_s += self._clock() - begin

    def join(self, pairs: Iterable[Pair]) -> None:
        """Join pairs of live bodies in their present relative poses."""
        begin = self._clock()
        self._port.join(pairs)
        self.steering_s += self._clock() - begin

    def part(self, pairs: Iterable[Pair]) -> None:
        """Part joined pairs."""
        begin = self._clock()
        self._port.part(pairs)
        self.steering_s += self._clock() - begin


class CountedPort:
    """Port that forwards every call to another port and sums the instructions of the calls since the last ``reset``."""

    __slots__ = ("_count", "_port", "instructions")

    def __init__(self, port: WeldPort, count: Callable[[], int]) -> None:
        """Wrap a port.

        Args:
            port: the port that receives the calls.
            count: function that returns the number of instructions of this thread so far.
        """
        self._port = port
        self._count = count
        self.reset()

    def reset(self) -> None:
        """Set the sum to zero, at the start of a frame."""
        self.instructions = 0
        """Number of instructions in calls of the port."""

    def contacts(self) -> Contacts:
        """Return every contact that touches a live body after the latest step."""
        return self._counted(self._port.contacts)

    def masses(self) -> Masses:
        """Return the live bodies as they are after the latest step."""
        return self._counted(self._port.masses)

    def sleep(self, bodies: Sequence[int]) -> None:
        """Freeze bodies exactly where they are."""
        self._counted(lambda: self._port.sleep(bodies))

    def wake(self, bodies: Sequence[int]) -> None:
        """Return frozen bodies to the engine."""
        self._counted(lambda: self._port.wake(bodies))

    def join(self, pairs: Iterable[Pair]) -> None:
        """Join pairs of live bodies in their present relative poses."""
        self._counted(lambda: self._port.join(pairs))

    def part(self, pairs: Iterable[Pair]) -> None:
        """Part joined pairs."""
        self._counted(lambda: self._port.part(pairs))

    def _counted(self, call: Callable[[], _Result]) -> _Result:
        begin = self._count()
        result = call()
        self.instructions += self._count() - begin
        return result
