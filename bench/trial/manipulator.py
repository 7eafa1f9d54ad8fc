"""The manipulator, which holds, strikes, presses and pulls bricks as a user does."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from adapters.base import Simulation
from bench.trial.measure import FloatArray
from scenarios.model import Press, Pull, Vector


class Listener(Protocol):
    """Receiver of the user's actions; ``PlainFrames`` and ``SteeredFrames`` are listeners."""

    def disturb(self, bodies: Sequence[int]) -> None:
        """Receive the bodies that the user has begun to hold."""

    def release(self, bodies: Sequence[int]) -> None:
        """Receive the bodies that the user has released."""

    def turn_gravity(self, gravity: Vector) -> None:
        """Receive the new gravity [m/s2]."""


@dataclass(slots=True)
class _Pulling:
    """A pull in progress."""

    until: float
    """End of the pull [s]."""
    velocity: FloatArray
    """Horizontal velocity that the user intends [m/s], shape (2,)."""
    speed: FloatArray
    """Horizontal velocity that the latest impulse gave to the brick [m/s], shape (2,). The difference from the intended
    velocity compensates the loss by friction."""
    position: FloatArray
    """Horizontal position of the brick at the latest impulse [m], shape (2,)."""


class Manipulator:
    """Manipulator of the bricks of one simulation; the listener receives the bodies that the user holds or releases."""

    def __init__(self, simulation: Simulation, listener: Listener | None) -> None:
        self._simulation = simulation
        self._listener = listener
        self._held: set[int] = set()
        self.pulls: dict[int, _Pulling] = {}
        """Pulls in progress, by body."""
        self.presses: dict[int, float] = {}
        """End of each press in progress [s], by body."""

    def hold(self, body: int) -> None:
        """Hold a body, so that the extension keeps the body live and judges the bodies above it again."""
        if body not in self._held:
            self._held.add(body)
            if self._listener is not None:
                self._listener.disturb((body,))

    def push(self, body: int, impulse: Vector) -> None:
        """Strike a body with an ``impulse`` [N s] and release the body."""
        self._simulation.push(body, impulse)
        self._let_go(body)

    def press(self, body: int, action: Press) -> None:
        """Start to press on a body with the force of ``action``."""
        self._simulation.apply_force(body, action.force)
        self.presses[body] = action.until

    def press_on(self, time: float) -> None:
        """End the presses that are over at ``time`` [s], and release their bodies."""
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
        """Start to pull a body with the velocity of ``action``, and to carry its weight if the action says so."""
        if action.is_carried:
            weight = self._simulation.bricks[body].mass * np.array(self._simulation.world.gravity)
            x, y, z = (-weight).tolist()
            self._simulation.apply_force(body, (x, y, z))
        wanted = np.array(action.velocity)
        self.pulls[body] = _Pulling(action.until, wanted, wanted, self._place(body))

    def pull_on(self, time: float) -> list[int]:
        """Continue the pulls for the frame that starts at ``time`` [s]; remove and return the bodies of ended pulls.

        In each frame a pulled brick receives one impulse. The impulse increases if the brick moved less than intended
        in the frame before.
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
        """Return the horizontal position of a body [m], shape (2,)."""
        bodies, position, _ = self._simulation.poses()
        place: FloatArray = position[bodies == body][0, :2].copy()
        return place
