"""Monitor a stack on tilting ground.

The monitor measures the slope of the ground at which a brick first moves, and the greatest slope that the engine's
contacts can hold.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from adapters.base import Simulation
from bench.trial.measure import EARLY_S, FloatArray
from bench.trial.own_contacts import OwnContacts, limit_slope
from scenarios.model import Scene, Tilt, Vector, World

MOVED = 0.01
"""Displacement during the tilt above which a brick has moved [thicknesses of the brick]."""
TURNED = math.radians(0.5)
"""Rotation during the tilt above which a brick has moved [rad]."""


class OnsetMonitor:
    """Monitor that records the slope at which a brick first moves."""

    def __init__(self, scene: Scene, simulation: Simulation, *, is_alone: bool) -> None:
        """Prepare to monitor.

        Args:
            scene: a scene with at least one ``Tilt``.
            simulation: the simulation of the scene.
            is_alone: True without an extension; the monitor reads the engine's own contacts only in this case.
        """
        self._scene, self._simulation = scene, simulation
        self._first: Tilt = next(action for action in scene.actions if isinstance(action, Tilt))
        self._contacts = OwnContacts() if is_alone else None
        if is_alone:
            _ = simulation.port  # makes the engine record contacts from the first step on
        self._rest: tuple[FloatArray, FloatArray] | None = None
        self.onset_deg: float | None = None
        """Slope of the ground in the first frame in which a brick had moved [deg]; None if none has moved."""

    def see(self, time: float, position: FloatArray, quaternion: FloatArray) -> None:
        """Record poses and contacts before the tilt; later, compare the poses with the recorded poses.

        Args:
            time: end of the frame [s].
            position: centres of the bricks [m], shape (n, 3); the array must not change later.
            quaternion: orientations of the bricks (w, x, y, z), shape (n, 4); the array must not change later.
        """
        if time <= self._first.time + EARLY_S:
            self._rest = position, quaternion
            if self._contacts is not None:
                self._contacts.see(self._simulation.port.contacts())
            return
        if self.onset_deg is not None or self._rest is None or len(position) != len(self._rest[0]):
            return
        thickness = np.array([min(brick.size) for brick in self._simulation.bricks.values()])
        moved = np.linalg.norm(position - self._rest[0], axis=1) > MOVED * thickness
        cosine = np.abs((quaternion * self._rest[1]).sum(axis=1))
        if moved.any() or (2 * np.arccos(np.minimum(1.0, cosine)) > TURNED).any():
            self.onset_deg = slope_deg(self._simulation.world.gravity)

    def fields(self) -> dict[str, Any]:
        """Return the fields for the record."""
        fields: dict[str, Any] = {"onset_deg": self.onset_deg}
        if self._contacts is not None and self._rest is not None:
            scene = self._scene
            patches = self._contacts.patches
            level = World(scene.world.friction, scene.world.gravity)
            fields["own_limit_deg"] = limit_slope(scene.bricks, level, self._first.axis, patches, self._rest[0])
            fields["ridge_deg"] = self._contacts.ridge_deg(scene.bricks)
        return fields


def slope_deg(gravity: Vector) -> float:
    """Return the angle between ``gravity`` and the downward vertical [deg]."""
    x, y, z = gravity
    return math.degrees(math.atan2(math.hypot(x, y), -z))
