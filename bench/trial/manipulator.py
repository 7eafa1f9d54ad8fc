"""Act on bricks as a user does: hold, strike, press and pull them; the listener receives which are held."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from adapters.base import Simulation
from bench.trial.measure import FloatArray
from scenarios.model import Press, Pull, Vector


class Listener(Protocol):
    """Receives the bodies that a user holds: the stability extension, or a stub."""

    def disturb(self, bodies: Sequence[int]) -> None:
        """Note that a user holds ``bodies``."""

    def release(self, bodies: Sequence[int]) -> None:
        """Note that the user released ``bodies``."""

    def turn_gravity(self, gravity: Vector) -> None:
        """Note that gravity [m/s2] has changed."""


@dataclass(slots=True)
class _Pulling:
    """A pull in progress."""

    until: float
    """End [s]."""
    velocity: FloatArray
    """Velocity wanted by the user [m/s], shape (2,)."""
    speed: FloatArray
    """Velocity given to the brick at the start of a frame [m/s], shape (2,): larger by the loss to friction."""
    position: FloatArray
    """Position of the brick a frame ago [m], shape (2,)."""


class Manipulator:
    """Acts on the bricks of one simulation."""

    def __init__(self, simulation: Simulation, listener: Listener | None) -> None:
        self._simulation = simulation
        self._listener = listener
        self._held: set[int] = set()
        self.pulls: dict[int, _Pulling] = {}
        """Pulls in progress, by body."""
        self.presses: dict[int, float] = {}
        """End [s] of each press in progress, by body."""

    def hold(self, body: int) -> None:
        """Hold a body: it stays live, and the bodies that rest on it are judged again."""
        if body not in self._held:
            self._held.add(body)
            if self._listener is not None:
                self._listener.disturb((body,))

    def push(self, body: int, impulse: Vector) -> None:
        """Strike a body with an ``impulse`` [N s] and release it."""
        self._simulation.push(body, impulse)
        self._let_go(body)

    def press(self, body: int, action: Press) -> None:
        """Start to press on a body."""
        self._simulation.apply_force(body, action.force)
        self.presses[body] = action.until

    def press_on(self, time: float) -> None:
        """Release the bodies whose press is over at ``time`` [s]."""
        for body in [body for body, until in self.presses.items() if time >= until]:
            del self.presses[body]
            self._simulation.apply_force(body, (0.0, 0.0, 0.0))
            self._let_go(body)

    def _let_go(self, body: int) -> None:
        if body in self._held:
            self._held.remove(body)
            if self._listener is not None:
                self._listener.release((body,))

    def pull(self, body: int, action: Pull) -> None:
        """Start to pull a body."""
        wanted = np.array(action.velocity)
        self.pulls[body] = _Pulling(action.until, wanted, wanted, self._place(body))

    def pull_on(self, time: float) -> list[int]:
        """Pull for one more frame, from ``time`` [s]; remove the bodies whose pull has ended, and return them.

        Each frame applies one impulse. Its strength grows if the brick stayed behind in the last frame.
        """
        frame_s = self._simulation.info.frame_s
        for body, pulling in self.pulls.items():
            position = self._place(body)
            pulling.speed = pulling.speed + pulling.velocity - (position - pulling.position) / frame_s
            pulling.position = position
            linear, _ = self._simulation.velocities()
            missing = pulling.speed - linear[list(self._simulation.bricks).index(body), :2]
            x, y = (self._simulation.bricks[body].mass * missing).tolist()
            self._simulation.push(body, (x, y, 0.0))
        ended = [body for body, pulling in self.pulls.items() if time >= pulling.until]
        for body in ended:
            self._simulation.remove(body)
            self._held.discard(body)
            del self.pulls[body]
        return ended

    def _place(self, body: int) -> FloatArray:
        """Return the position of a body in x and y [m], shape (2,)."""
        bodies, position, _ = self._simulation.poses()
        place: FloatArray = position[bodies == body][0, :2].copy()
        return place
