"""The map from forces at the corners of contact patches to forces and moments on bodies.

A unit force d at a corner acts on the second body as d, and on the first body as -d. The moment of the force about a
body's centre of mass is the cross product of the arm and the force on the body. The arm is the vector from the centre
to the corner, over ``length``. The transposed map takes the velocities of the bodies to the relative velocity of the
two surfaces at each corner.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.sparse import csc_array

from scenarios.geometry import FloatArray
from scenarios.statics.contact_patch import GROUND, Patch


class Corners:
    """The corners of all patches, with forces over the mean weight, arms over ``length``, and positions in m."""

    def __init__(self, centers: FloatArray, weights: FloatArray, patches: Sequence[Patch], length: float) -> None:
        corners = [len(patch.points) for patch in patches]
        self.points = np.concatenate([np.empty((0, 3)), *(patch.points for patch in patches)])
        """Positions [m], shape (p, 3)."""
        self.normals = np.repeat(np.array([patch.normal for patch in patches]).reshape(-1, 3), corners, axis=0)
        """Unit normals from the first body to the second, shape (p, 3)."""
        self.first = np.repeat(np.array([patch.first for patch in patches], np.int64), corners)
        self.second = np.repeat(np.array([patch.second for patch in patches], np.int64), corners)
        self.friction_ratios = np.repeat(np.array([patch.friction_ratio for patch in patches], np.float64), corners)
        """Ratio of the coefficient of friction at each corner to the pile's, shape (p,)."""
        self.tangents = _tangents(self.normals)
        """Two unit vectors perpendicular to each normal and to each other, shape (2, p, 3)."""
        self.unit = float(np.linalg.norm(weights, axis=1).mean())
        """The mean weight [N]."""
        self.bodies = len(centers)
        self.load = np.hstack([weights / self.unit, np.zeros_like(weights)]).ravel()
        """Weights as forces and moments on the bodies, over the mean weight, shape (6 n,)."""
        self.centers, self.length = centers, length
        """Centres of mass [m], shape (n, 3), and the length unit [m]."""

    def coefficients(self, friction: float) -> float | FloatArray:
        """Return the coefficient of friction at each corner, shape (p, 1), or a single number for all corners."""
        if (self.friction_ratios == 1.0).all():
            return friction
        coefficients: FloatArray = friction * self.friction_ratios[:, None]
        return coefficients

    def wrenches(self, directions: FloatArray) -> csc_array:
        """Return the matrix (6 n, p k) whose columns are the forces and moments of each direction.

        Args:
            directions: k forces at each corner, shape (p, k, 3).
        """
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


def patches_among(present: Sequence[int], patches: Sequence[Patch]) -> list[Patch]:
    """Return the patches among the bodies ``present``; the patches contain the bodies' places in ``present``."""
    place = {body: index for index, body in enumerate(present)} | {GROUND: GROUND}
    return [
        patch._replace(first=place[patch.first], second=place[patch.second])
        for patch in patches
        if patch.first in place and patch.second in place
    ]


def _tangents(normals: FloatArray) -> FloatArray:
    """Return two unit vectors perpendicular to each normal (p, 3) and to each other, shape (2, p, 3)."""
    least = np.eye(3)[np.abs(normals).argmin(axis=1)]
    first = np.cross(least, normals)
    first /= np.linalg.norm(first, axis=1)[:, None]
    return np.array([first, np.cross(normals, first)])
