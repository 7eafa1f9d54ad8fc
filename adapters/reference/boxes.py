"""The boxes of a reference engine's world, as arrays: poses, velocities, masses and states."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from adapters.shared.contact_completion import fixed_id
from scenarios.model import Brick, Quaternion, Vector
from stability_core.port import GROUND, IntArray

ABSENT, FIXED, MOVED, LIVE = range(4)
"""States of a row: no box; a fixed or frozen box; a box that the host moves; a live box."""

StateArray = npt.NDArray[np.int8]


class BoxArrays:
    """Arrays with a row for each box. The row of a body, of the ground or of a fixed box is its id plus ``first``."""

    def __init__(self, fixed: int) -> None:
        """Create arrays without boxes, for a world with ``fixed`` fixed boxes and the ground."""
        self.first = -fixed_id(fixed - 1) if fixed else -GROUND
        self.count = self.first
        """Number of rows in use."""
        rows = self.first + 64
        self.position = np.zeros((rows, 3))
        """Centres [m]."""
        self.quaternion = np.zeros((rows, 4))
        """Rotations (w, x, y, z)."""
        self.velocity = np.zeros((rows, 3))
        """Velocities of the centres [m/s]."""
        self.spin = np.zeros((rows, 3))
        """Angular velocities [rad/s], in the world's frame."""
        self.half = np.ones((rows, 3))
        """Half edges [m]."""
        self.mass = np.ones(rows)
        """Masses [kg]."""
        self.inertia = np.ones((rows, 3))
        """Principal moments of inertia [kg m2]."""
        self.force = np.zeros((rows, 3))
        """Steady forces of the host [N]."""
        self.state = np.zeros(rows, np.int8)
        """State of each row: ``ABSENT``, ``FIXED``, ``MOVED`` or ``LIVE``."""

    def rows(self, bodies: IntArray) -> IntArray:
        """Return the rows (k,) of ids (k,)."""
        rows: IntArray = bodies + self.first
        return rows

    def add(self, body: int, brick: Brick, state: int) -> None:
        """Add a box at rest. The id must be higher than all earlier ids of bodies."""
        row = body + self.first
        if row >= len(self.state):
            self._double()
        self.count = max(self.count, row + 1)
        x, y, z = brick.size
        self.position[row], self.quaternion[row] = brick.position, brick.quaternion
        self.velocity[row], self.spin[row], self.force[row] = 0.0, 0.0, 0.0
        self.half[row] = x / 2, y / 2, z / 2
        self.mass[row] = brick.mass
        self.inertia[row] = np.array([y * y + z * z, x * x + z * z, x * x + y * y]) * brick.mass / 12
        self.state[row] = state

    def set_state(self, body: int, state: int) -> None:
        """Set the state of a box, stop the box, and delete its steady force."""
        row = body + self.first
        self.state[row] = state
        self.velocity[row], self.spin[row], self.force[row] = 0.0, 0.0, 0.0

    def place(self, body: int, position: Vector, quaternion: Quaternion) -> None:
        """Set the pose of a box, and stop the box. A steady force remains."""
        row = body + self.first
        self.position[row], self.quaternion[row] = position, quaternion
        self.velocity[row], self.spin[row] = 0.0, 0.0

    def remove(self, body: int) -> None:
        """Remove a box."""
        self.state[body + self.first] = ABSENT

    def is_finite(self) -> bool:
        """Return whether the poses and velocities of all boxes, also of removed boxes, are finite."""
        arrays = self.position, self.quaternion, self.velocity, self.spin
        return all(bool(np.isfinite(array[: self.count]).all()) for array in arrays)

    def _double(self) -> None:
        for name in ("position", "quaternion", "velocity", "spin", "half", "mass", "inertia", "force", "state"):
            array = getattr(self, name)
            setattr(self, name, np.concatenate([array, np.zeros_like(array)]))
