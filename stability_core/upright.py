"""Upright coordinates, in which gravity points down the z axis. The kernels compute in these coordinates.

The port uses the coordinates of its world. ``Upright`` turns points, normals, centres, velocities and forces to
upright coordinates. For gravity (0, 0, -g) both systems are the same.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stability_core.compiled import compiled
from stability_core.port import Contacts, FloatArray, Masses


def rotation_to_upright(up: FloatArray) -> FloatArray:
    """Return the rotation, shape (3, 3), that turns the unit vector ``up`` to z."""
    aside = np.eye(3)[0 if abs(up[0]) < 0.9 else 1]
    x = aside - (aside @ up) * up
    x /= np.linalg.norm(x)
    return np.array([x, np.cross(up, x), up])


@compiled
def turned(points: FloatArray, axes: FloatArray) -> FloatArray:
    """Return the coordinates of points (k, 3) along three unit vectors, the rows of ``axes`` (3, 3)."""
    result = np.empty_like(points)
    for i in range(len(points)):
        for k in range(3):
            result[i, k] = points[i, 0] * axes[k, 0] + points[i, 1] * axes[k, 1] + points[i, 2] * axes[k, 2]
    return result


def checked_gravity(gravity: Sequence[float]) -> tuple[float, float, float]:
    """Check gravity [m/s2], and return its three components.

    Raises:
        ValueError: if gravity is not a finite vector, or zero.
    """
    vector = np.asarray(gravity, np.float64)
    if not (vector.shape == (3,) and np.isfinite(vector).all() and vector.any()):
        raise ValueError(
            f"gravity must be three finite numbers [m/s2], not all zero, got {gravity}: pass a vector such as "
            "(0.0, 0.0, -9.81)"
        )
    x, y, z = vector.tolist()
    return x, y, z


class Upright:
    """A gravity vector, and the rotation from world coordinates to upright coordinates."""

    def __init__(self, gravity: tuple[float, float, float]) -> None:
        """Derive the upright coordinates.

        Args:
            gravity: gravity vector [m/s2], finite and not zero.
        """
        vector = np.array(gravity)
        self.gravity = gravity
        self.strength = float(np.linalg.norm(vector))
        self.up = -vector / self.strength
        self.is_world = gravity[0] == gravity[1] == 0.0 and gravity[2] < 0.0
        """True if upright coordinates are the coordinates of the world."""
        self.rotation = np.eye(3) if self.is_world else rotation_to_upright(self.up)

    def differs(self, gravity: tuple[float, float, float], tilt: float, share: float) -> bool:
        """Return True if ``gravity`` differs by more than ``tilt`` [rad] in direction or ``share`` in strength."""
        vector = np.array(gravity)
        angle = np.arctan2(np.linalg.norm(np.cross(vector, self.up)), -(vector @ self.up))
        return bool(angle > tilt or abs(np.linalg.norm(vector) / self.strength - 1.0) > share)

    def turn_contacts(self, contacts: Contacts) -> Contacts:
        """Return contacts of the world in upright coordinates."""
        if self.is_world:
            return contacts
        return Contacts(
            contacts.body_a,
            contacts.body_b,
            self._turn(contacts.point),
            self._turn(contacts.normal),
            contacts.separation,
            self._turn(contacts.relative_velocity),
            contacts.friction,
            None if contacts.force is None else self._turn(contacts.force),
        )

    def turn_masses(self, masses: Masses) -> Masses:
        """Return masses of the world in upright coordinates."""
        if self.is_world:
            return masses
        return Masses(masses.body, masses.mass, self._turn(masses.center_of_mass), masses.removed)

    def _turn(self, vectors: FloatArray) -> FloatArray:
        result: FloatArray = turned(np.array(vectors, np.float64, order="C"), self.rotation)
        return result
