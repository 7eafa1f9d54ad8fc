"""Map forces at the corners of contact patches to forces and moments on bodies.

A unit force d at a corner x pushes the second body by d and the first body by -d; its moment about the centre of mass c
of a body is ((x - c) / length) x d, up to the sign. The transposed map gives the relative velocity of the two surfaces
at each corner from the velocities of the bodies.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.sparse import csc_array

from scenarios.geometry import FloatArray
from scenarios.statics.contact_patch import GROUND, Patch


class Corners:
    """The corners of all patches, dimensionless: forces over the mean weight, lengths over ``length``."""

    def __init__(self, centers: FloatArray, weights: FloatArray, patches: Sequence[Patch], length: float) -> None:
        corners = [len(patch.points) for patch in patches]
        self.points = np.concatenate([np.empty((0, 3)), *(patch.points for patch in patches)])
        """Positions [m], shape (p, 3)."""
        self.normals = np.repeat(np.array([patch.normal for patch in patches]).reshape(-1, 3), corners, axis=0)
        """Unit normals from the first body to the second, shape (p, 3)."""
        self.first = np.repeat(np.array([patch.first for patch in patches], np.int64), corners)
        self.second = np.repeat(np.array([patch.second for patch in patches], np.int64), corners)
        self.tangents = _tangents(self.normals)
        """Two unit vectors across each normal, shape (2, p, 3)."""
        self.unit = float(np.linalg.norm(weights, axis=1).mean())
        """The mean weight [N]."""
        self.bodies = len(centers)
        self.load = np.hstack([weights / self.unit, np.zeros_like(weights)]).ravel()
        """Weights as forces and moments, shape (6 n,)."""
        self.centers, self.length = centers, length
        """Centres of mass [m], shape (n, 3), and the length unit [m]."""

    def wrenches(self, directions: FloatArray) -> csc_array:
        """Return the force and moment on every body, shape (6 n, p k), of a unit force along each (p, k, 3)."""
        p, k, _ = directions.shape
        rows, columns, values = [], [], []
        for body, sign in ((self.first, -1.0), (self.second, 1.0)):
            moving = np.flatnonzero(body != GROUND)
            arm = (self.points[moving] - self.centers[body[moving]]) / self.length
            force = sign * directions[moving]
            wrench = np.concatenate([force, np.cross(arm[:, None], force)], axis=2)
            shape = wrench.shape
            rows.append(np.broadcast_to(6 * body[moving, None, None] + np.arange(6), shape).ravel())
            columns.append(np.broadcast_to(k * moving[:, None, None] + np.arange(k)[:, None], shape).ravel())
            values.append(wrench.ravel())
        entries = np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
        return csc_array(entries, shape=(6 * self.bodies, p * k))


def _tangents(normals: FloatArray) -> FloatArray:
    """Return two unit vectors across each normal (p, 3), shape (2, p, 3)."""
    least = np.eye(3)[np.abs(normals).argmin(axis=1)]
    first = np.cross(least, normals)
    first /= np.linalg.norm(first, axis=1)[:, None]
    return np.array([first, np.cross(normals, first)])
