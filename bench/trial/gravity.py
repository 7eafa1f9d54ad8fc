"""Gravity on tilting ground: simulation and extension receive the new vector in the same frame."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from adapters.base import Simulation
from scenarios.model import Tilt, Vector


@dataclass(slots=True)
class TurningGravity:
    """Executor of the tilts of a scene, which turns gravity instead of the ground."""

    simulation: Simulation
    notify: Callable[[Vector], None]
    """Function that receives every new gravity [m/s2]."""
    tilts: list[tuple[Tilt, Vector]] = field(default_factory=list)
    """Tilts in progress, each with the gravity at its start [m/s2]."""

    def begin(self, tilt: Tilt) -> None:
        """Start a tilt from the gravity that earlier tilts have reached."""
        self.turn_on(tilt.time)
        self.tilts.append((tilt, self.simulation.world.gravity))

    def turn_on(self, time: float) -> None:
        """Set gravity for the frame that starts at ``time`` [s], and remove completed tilts."""
        for tilt, start in self.tilts:
            angle = math.radians(tilt.speed) * min(time - tilt.time, tilt.seconds)
            gravity = turned(start, tilt.axis, -angle)
            self.simulation.set_gravity(gravity)
            self.notify(gravity)
        self.tilts = [(tilt, start) for tilt, start in self.tilts if time < tilt.until]


def turned(vector: Vector, axis: tuple[float, float], angle: float) -> Vector:
    """Rotate ``vector`` by ``angle`` [rad] about the horizontal ``axis`` (x, y), by the right-hand rule.

    The function uses Rodrigues' formula.
    """
    k = np.array([*axis, 0.0]) / math.hypot(*axis)
    v = np.array(vector)
    x, y, z = (v * math.cos(angle) + np.cross(k, v) * math.sin(angle) + k * (k @ v) * (1 - math.cos(angle))).tolist()
    return x, y, z
