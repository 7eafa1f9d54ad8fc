"""Rigid bodies and Coulomb's law at their corners, in space or in a plane, for ``strong_stability``.

Each corner sticks, or slides in a sector of directions, or is open. The forces of a corner that sticks or slides lie in
a polyhedral cone. In the plane these cones are exact. In space these cones contain all forces of Coulomb's law:

- for a corner that sticks: the pyramid circumscribed about Coulomb's cone;
- for a corner that slides in a sector: the cone over a triangle in the plane f_n = 1. The triangle's sides are the
  chord of the sector's arc on Coulomb's circle, and the tangents to the circle at both ends of the arc.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from scenarios.geometry import FloatArray
from scenarios.statics.compliant_contacts import IntArray
from scenarios.statics.contact_patch import GROUND
from scenarios.statics.contact_wrenches import Corners

SECTORS = 8
"""Number of sectors of sliding directions in space. The friction of a corner that slides is cos(22.5 deg) = 0.92 to
1 / cos(22.5 deg) = 1.08 times mu f_n, and the friction of a corner that sticks is at most 1.08 mu f_n."""
_SAME = 1e-6
"""Difference of two coordinates, in length units, below which both coordinates count as equal."""


class RigidPile(NamedTuple):
    """A dimensionless pile: weights over the weight of the lightest body, lengths over the length unit.

    The shapes contain the numbers of bodies n, of their degrees of freedom d, of corners p and of tangents t. A pile in
    space has 2 tangents, a pile in a plane has 1.
    """

    masses: FloatArray
    """Masses and inertia, shape (d, d)."""
    weights: FloatArray
    """Weights as forces and moments, shape (d,)."""
    wrenches: FloatArray
    """Wrenches of unit forces along the normal and the tangents of each corner, shape (d, p, 1 + t)."""
    down: FloatArray
    """Map from accelerations to each body's acceleration along its weight, shape (n, d)."""


class Law(NamedTuple):
    """Coulomb's law at one corner."""

    generators: FloatArray
    """Forces with a normal component of 1 that span the cones of all modes, shape (g, 1 + t)."""
    modes: IntArray
    """Mode of each generator: 0 sticks, j slides in sector j; shape (g,)."""
    borders: FloatArray
    """Normals c of the borders of all sectors, shape (b, t): c . v >= 0 for a sliding velocity v in the sector."""
    sectors: IntArray
    """Number of the sector that each border bounds, from 1; shape (b,)."""


def spatial_pile(corners: Corners, gyration: FloatArray) -> RigidPile:
    """Return the pile in space.

    Args:
        corners: corners of the contact patches, with the bodies' loads.
        gyration: inertia over mass, in squares of the length unit, shape (n, 3, 3).
    """
    weights = corners.load.reshape(-1, 6)
    masses = np.linalg.norm(weights[:, :3], axis=1)
    size, scale = 6 * corners.bodies, 1.0 / masses.min()
    inertia = np.zeros((corners.bodies, 6, corners.bodies, 6))
    for body, (mass, squared) in enumerate(zip(masses, gyration, strict=True)):
        inertia[body, :3, body, :3], inertia[body, 3:, body, 3:] = mass * np.eye(3), mass * squared
    frames = np.stack([corners.normals, *corners.tangents], axis=1)
    wrenches = corners.wrenches(frames).toarray().reshape(size, -1, 3)
    down = np.zeros((corners.bodies, corners.bodies, 6))
    down[np.arange(corners.bodies), np.arange(corners.bodies)] = weights / masses[:, None]
    return RigidPile(
        scale * inertia.reshape(size, size), scale * weights.ravel(), wrenches, down.reshape(corners.bodies, size)
    )


def planar_pile(corners: Corners, spatial: RigidPile) -> RigidPile | None:
    """Return the pile in the x-z plane, or None if the pile is not its own mirror image in a plane y = const.

    Bodies behind each other, with the same x and z but different y, become one body. Corners behind each other become
    one corner.
    """
    points, centers = corners.points / corners.length, corners.centers / corners.length
    bodies = _groups(np.column_stack([centers[:, [0, 2]], spatial.weights.reshape(-1, 6)[:, [0, 2]]]))
    sides = np.append(bodies, GROUND)[[corners.first, corners.second]].T
    behind = _groups(np.column_stack([points[:, [0, 2]], corners.normals[:, [0, 2]], sides]))
    middle = centers[:, 1].mean()
    out = [corners.normals[:, 1], spatial.weights[1::6]]
    out += [_means(bodies, centers[:, 1] - middle), _means(behind, points[:, 1] - middle)]
    if np.abs(np.concatenate(out)).max() > _SAME:
        return None
    motion = np.zeros((len(bodies), 6, bodies.max() + 1, 3))
    for body, group in enumerate(bodies):
        motion[body, [0, 2, 4], group, [0, 1, 2]] = 1.0
    motion = motion.reshape(6 * len(bodies), -1)
    across = np.column_stack([corners.normals[:, 2], np.zeros(len(points)), -corners.normals[:, 0]])
    sliding = np.einsum("dpt,tpi,pi->dp", spatial.wrenches[..., 1:], corners.tangents, across)
    wrenches = np.stack([spatial.wrenches[..., 0], sliding], axis=2)[:, np.unique(behind, return_index=True)[1]]
    return RigidPile(
        masses=motion.T @ spatial.masses @ motion,
        weights=motion.T @ spatial.weights,
        wrenches=np.tensordot(motion.T, wrenches, 1),
        down=np.unique(spatial.down @ motion, axis=0),
    )


def _groups(rows: FloatArray) -> IntArray:
    """Return the number of each row's group, shape (m,); equal ``rows`` (m, q) form a group."""
    groups: IntArray = np.unique(np.round(rows / _SAME), axis=0, return_inverse=True)[1].reshape(-1)
    return groups


def _means(groups: IntArray, values: FloatArray) -> FloatArray:
    means: FloatArray = np.bincount(groups, values) / np.bincount(groups)
    return means


def law_in_plane(friction: float) -> Law:
    """Return Coulomb's exact law with one tangent."""
    generators = np.array([[1.0, friction], [1.0, -friction], [1.0, -friction], [1.0, friction]])
    return Law(generators, np.array([0, 0, 1, 2]), np.array([[1.0], [-1.0]]), np.array([1, 2]))


def law_in_space(friction: float) -> Law:
    """Return bounds of Coulomb's law with two tangents: see ``SECTORS``."""
    half = np.pi / SECTORS
    middles = 2 * half * np.arange(SECTORS)

    def along(angles: npt.NDArray[np.floating]) -> FloatArray:
        return np.column_stack([np.cos(angles), np.sin(angles)])

    outer = friction / np.cos(half)
    sticking = [outer * along(middles)]
    sliding = [-friction * along(middles - half), -outer * along(middles), -friction * along(middles + half)]
    tangential = np.concatenate(sticking + sliding)
    sectors = np.arange(1, SECTORS + 1)
    return Law(
        generators=np.column_stack([np.ones(len(tangential)), tangential]),
        modes=np.concatenate([np.zeros(SECTORS, np.int64), sectors, sectors, sectors]),
        borders=np.concatenate([along(middles - half + np.pi / 2), along(middles + half - np.pi / 2)]),
        sectors=np.concatenate([sectors, sectors]),
    )
