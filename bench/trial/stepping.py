"""Play timed frames: the step of the engine, then the update of the extension, split into read-back, core and port."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from time import perf_counter

from adapters.base import Simulation
from adapters.shared.refusals import check_weldable
from bench.studies.policies import BENCH_POLICIES
from bench.trial.timed_port import CountedPort, TimedPort
from bench.welding import WeldChange, WeldExtension
from scenarios.model import Vector
from stability_core import Change, StabilityExtension


@dataclass(frozen=True, slots=True)
class FrameTimes:
    """Times of the parts of one frame [s]."""

    engine: float
    """Time of the engine's step, and of its detection of contacts of a new prebuilt stack [s]."""
    readback: float = 0.0
    """Time in which the port reads contacts and masses [s]."""
    core: float = 0.0
    """Time of the extension without port calls [s]."""
    port: float = 0.0
    """Time in which the port freezes, unfreezes, joins and parts bodies [s]."""
    bridge: float | None = None
    """Time of the transfer to an engine in a separate process and back [s]; None for an engine in this process."""

    @property
    def total(self) -> float:
        """Time of the whole frame [s] without the bridge, for comparisons with engines in this process."""
        return self.engine + self.readback + self.core + self.port


@dataclass(frozen=True, slots=True)
class Steering:
    """Input and changes of the extension in one frame, including the adoption of prebuilt stacks before the step."""

    contacts: int
    """Number of contact points that the extension read."""
    frozen: Sequence[int]
    """Bodies that the core froze."""
    woken: Sequence[int]
    """Bodies that the core unfroze."""
    reasons: Sequence[str]
    """Reason for unfreezing each body in ``woken``."""
    instructions: int | None = None
    """Number of instructions of the core without port calls; None without a count."""
    joined: int | None = None
    """Number of pairs that the extension joined; None for a policy that joins nothing."""
    parted: int | None = None
    """Number of pairs that the extension parted; None for a policy that joins nothing."""

    @property
    def summary(self) -> str:
        """Distinct reasons, with the count of each reason."""
        return "; ".join(f"{count} {reason}" for reason, count in Counter(self.reasons).items())


class PlainFrames:
    """Frames of the engine alone. The class uses no port, so that the engine need not record contacts."""

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation

    def play(self) -> tuple[FrameTimes, None]:
        """Play one frame and return its times."""
        begin = perf_counter()
        self._simulation.step(self._simulation.info.frame_s)
        return _without_bridge(FrameTimes(perf_counter() - begin), self._simulation), None

    def disturb(self, bodies: Sequence[int]) -> None:
        """Do nothing, because there is no extension."""

    def release(self, bodies: Sequence[int]) -> None:
        """Do nothing, because there is no extension."""

    def turn_gravity(self, gravity: Vector) -> None:
        """Do nothing, because there is no extension."""


class SteeredFrames:
    """Frames of the engine with an extension: the stability extension, or joints."""

    def __init__(
        self,
        simulation: Simulation,
        policy: str,
        count: Callable[[], int] | None = None,
    ) -> None:
        """Attach the extension.

        Args:
            simulation: a world.
            policy: name of a policy of the core, or of a policy that joins bodies.
            count: function that returns the number of instructions of this thread so far; None to count none. A policy
                that joins bodies counts none.

        Raises:
            NotImplementedError: if the policy joins bodies, and the engine does not.
        """
        self._simulation = simulation
        load = BENCH_POLICIES[policy].weld
        self._count = count = None if load else count  # the count is that of the core
        self._counted = None if count is None else CountedPort(simulation.port, count)
        self._port = TimedPort(self._counted or simulation.port)
        gravity = simulation.world.gravity
        self._extension: StabilityExtension | WeldExtension
        if load is None:
            self._extension = StabilityExtension(self._port, policy=policy, gravity=gravity)
        else:
            check_weldable(simulation.engine, simulation.capabilities)
            self._extension = WeldExtension(self._port, load, gravity)
        self._before: list[tuple[FrameTimes, Steering]] = []  # adoptions of prebuilt stacks since the last step

    def adopt(self, bodies: Sequence[int]) -> tuple[int, ...]:
        """Make the extension judge a prebuilt stack before the next step; return the bodies that the extension froze.

        The times and changes count for the next frame.
        """
        self._before.append(self._timed(self._simulation.find_contacts, lambda: self._extension.adopt(bodies)))
        return tuple(self._before[-1][1].frozen)

    def play(self) -> tuple[FrameTimes, Steering]:
        """Play one frame; return its times and the changes of the extension."""
        frame_s = self._simulation.info.frame_s
        times, steering = self._timed(lambda: self._simulation.step(frame_s), lambda: self._extension.update(frame_s))
        played = _without_bridge(times, self._simulation), steering
        parts, self._before = [*self._before, played], []
        if len(parts) == 1:
            return played
        return _total([times for times, _ in parts]), _together([steering for _, steering in parts])

    def _timed(
        self, engine: Callable[[], None], core: Callable[[], Change | WeldChange]
    ) -> tuple[FrameTimes, Steering]:
        """Call the engine, then the extension; return the times of both and the changes of the extension."""
        port = self._port
        port.reset()
        begin = perf_counter()
        engine()
        done = perf_counter()
        change, instructions = self._with_instructions(core)
        core_s = perf_counter() - done - port.readback_s - port.steering_s
        times = FrameTimes(done - begin, port.readback_s, core_s, port.steering_s)
        if isinstance(change, WeldChange):
            return times, Steering(port.contact_points, (), (), (), None, len(change.joined), len(change.parted))
        reasons = [change.reasons[body] for body in change.woken]
        return times, Steering(port.contact_points, change.frozen, change.woken, reasons, instructions)

    def _with_instructions(self, core: Callable[[], Change | WeldChange]) -> tuple[Change | WeldChange, int | None]:
        """Call the core; return its changes and its number of instructions without port calls (None if not counted)."""
        if self._count is None or self._counted is None:
            return core(), None
        self._counted.reset()
        begin = self._count()
        change = core()
        return change, self._count() - begin - self._counted.instructions

    def disturb(self, bodies: Sequence[int]) -> None:
        """Report to the extension the bodies that the user has begun to hold."""
        self._extension.disturb(bodies)

    def release(self, bodies: Sequence[int]) -> None:
        """Report to the extension the bodies that the user has released."""
        self._extension.release(bodies)

    def turn_gravity(self, gravity: Vector) -> None:
        """Set the gravity of the extension [m/s2]."""
        self._extension.gravity = gravity


def _without_bridge(times: FrameTimes, simulation: Simulation) -> FrameTimes:
    """Split the engine's time into step and bridge if a separate process of the engine reports the time of the step."""
    own = simulation.own_step_s
    return times if own is None else replace(times, engine=own, bridge=times.engine - own)


def _total(times: Sequence[FrameTimes]) -> FrameTimes:
    return FrameTimes(
        sum(one.engine for one in times),
        sum(one.readback for one in times),
        sum(one.core for one in times),
        sum(one.port for one in times),
        times[-1].bridge,
    )


def _together(parts: Sequence[Steering]) -> Steering:
    return Steering(
        sum(part.contacts for part in parts),
        [body for part in parts for body in part.frozen],
        [body for part in parts for body in part.woken],
        [reason for part in parts for reason in part.reasons],
        _sum([part.instructions for part in parts]),
        _sum([part.joined for part in parts]),
        _sum([part.parted for part in parts]),
    )


def _sum(counts: Sequence[int | None]) -> int | None:
    """Return the sum of counts, None if a count is unknown."""
    known = [count for count in counts if count is not None]
    return sum(known) if len(known) == len(counts) else None
