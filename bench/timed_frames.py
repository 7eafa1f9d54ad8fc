"""Plays frames, each timed: the engine's step, then the extension's update, split into read-back, core and port."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from time import perf_counter

from adapters.base import Simulation
from bench.timed_port import TimedPort
from stability_core import StabilityExtension


@dataclass(frozen=True, slots=True)
class FrameTimes:
    """Times of one frame [s]."""

    engine: float
    readback: float = 0.0
    core: float = 0.0
    port: float = 0.0

    @property
    def total(self) -> float:
        """Time of the whole frame [s]."""
        return self.engine + self.readback + self.core + self.port


@dataclass(frozen=True, slots=True)
class Steering:
    """What the core read and did in one frame."""

    contacts: int
    """Contact points read."""
    frozen: Sequence[int]
    woken: Sequence[int]
    reasons: Sequence[str]
    """Why, for each of ``woken``."""

    @property
    def told(self) -> str:
        """The reasons and how often each was given."""
        return "; ".join(f"{count} {reason}" for reason, count in Counter(self.reasons).items())


class PlainFrames:
    """Frames of the engine alone; its port is never asked for, so that it need not record what only the core reads."""

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation

    def play(self) -> tuple[FrameTimes, None]:
        """One frame: how long it took."""
        begin = perf_counter()
        self._simulation.step(self._simulation.info.frame_s)
        return FrameTimes(perf_counter() - begin), None

    def disturb(self, bodies: Sequence[int]) -> None:
        """There is no extension that must know what a user holds."""

    def release(self, bodies: Sequence[int]) -> None:
        """There is no extension that must know what a user lets go."""


class SteeredFrames:
    """Frames of the engine with the stability extension."""

    def __init__(self, simulation: Simulation, policy: str) -> None:
        self._simulation = simulation
        self._port = TimedPort(simulation.port)
        self._extension = StabilityExtension(self._port, policy=policy, gravity=simulation.world.gravity)

    def play(self) -> tuple[FrameTimes, Steering]:
        """One frame: how long it took, and what the core did."""
        port, frame_s = self._port, self._simulation.info.frame_s
        port.reset()
        begin = perf_counter()
        self._simulation.step(frame_s)
        stepped = perf_counter()
        change = self._extension.update(frame_s)
        updated = perf_counter()
        core_s = updated - stepped - port.readback_s - port.steering_s
        times = FrameTimes(stepped - begin, port.readback_s, core_s, port.steering_s)
        return times, Steering(
            port.contact_points, change.frozen, change.woken, [change.reasons[body] for body in change.woken]
        )

    def disturb(self, bodies: Sequence[int]) -> None:
        """Tell the extension that a user holds ``bodies``."""
        self._extension.disturb(bodies)

    def release(self, bodies: Sequence[int]) -> None:
        """Tell the extension that the user let ``bodies`` go."""
        self._extension.release(bodies)
