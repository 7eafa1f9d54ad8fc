"""The time that an unstable stack takes to fall, from rest to the limit at which the harness records the fall.

By Gauss's principle, contact forces f in the Coulomb cones give the accelerations a that are nearest to free fall. With
the weights w, the mass matrix M and the map G from contact forces to forces and moments on the bodies,

    minimise |M^(-1/2) (w + G f)|  over f in the cones;     a = M^(-1) (w + G f).

The bodies move along q a, from rest at q = 0. Body i has the mass m_i, the inertia I_i, and the linear part v_i and the
angular part o_i of a. The balance of energy gives

    mass       m = sum(m_i |v_i|^2 + o_i . I_i o_i)
    force      F = sum(m_i g . v_i) = m                     (contact forces do no work along a)
    stiffness  K = sum(m_i g . (o_i x v_i))                 (a body that turns about an edge below it accelerates)
    motion     q'' = 1 + s^2 q,  s^2 = K / m;               q(t) = (cosh(s t) - 1) / s^2
    time       t = acosh(1 + s^2 q) / s                     (sqrt(2 q) without rotation, s = 0)

For example, a block has its centre of mass e beyond an edge and h above the edge, and the inertia I about the edge. The
block has s^2 = m g h / I, and reaches the angle phi at the time acosh(1 + phi h / e) / s.

The minimisation projects the forces on the cones. Therefore the two surfaces of a sliding contact also move apart. On a
slope of 15 to 25 deg this error changes the horizontal acceleration by at most 5 %.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from scipy.linalg import block_diag
from scipy.optimize import nnls

from scenarios.geometry import FloatArray
from scenarios.model import Brick, World
from scenarios.statics.contact_patch import contact_patches
from scenarios.statics.contact_wrenches import Corners
from scenarios.statics.pile import gyration_of, pile_of_bricks

TILT_LIMIT = math.radians(15)
"""Angle [rad] from which a brick has toppled, because a plank that leans this far off its plan no longer carries the
bricks planned on it."""
SLIDE_LIMIT = 1.0
"""Ratio of a brick's displacement to its least edge from which the brick has slid or dropped."""
SIDES = 16
"""Number of sides of the pyramids inscribed into the Coulomb cones, so that friction is too small by at most 2 %."""
_STILL = 1e-6
"""Speed up to which a body counts as still, as a share of the fastest body's speed, because rounding leaves small
speeds."""


def fall_time(bricks: Sequence[Brick], world: World) -> float:
    """Return the time [s] until the first brick has toppled or slid, from rest in the planned poses.

    If no brick topples or slides, the time is the time until the first brick has dropped.

    Raises:
        ValueError: if no brick moves, or bricks overlap.
    """
    mass = np.array([brick.mass for brick in bricks])
    gyration = gyration_of(bricks)
    linear, angular = _first_accelerations(bricks, world, gyration)
    way = _way_to_the_limit(bricks, linear, angular)
    inertia = mass[:, None, None] * gyration
    turning = np.einsum("ni,nij,nj->", angular, inertia, angular)
    moved = float(mass @ (linear**2).sum(axis=1) + turning)
    stiffness = float(mass @ (np.cross(angular, linear) @ np.array(world.gravity)))
    rate = math.sqrt(max(0.0, stiffness / moved))
    if rate * math.sqrt(way) < _STILL:
        return math.sqrt(2 * way)
    return math.acosh(1 + rate**2 * way) / rate


def _first_accelerations(bricks: Sequence[Brick], world: World, gyration: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the initial linear (n, 3) [m/s2] and angular (n, 3) [rad/s2] accelerations.

    Raises:
        ValueError: if no brick moves, or bricks overlap.
    """
    pile = pile_of_bricks(bricks, contact_patches(bricks, world.fixed), world)
    length, mass = pile.length, [brick.mass for brick in bricks]
    corners = Corners(pile.centers, pile.weights, pile.patches, length)
    angle = np.arange(SIDES) * (2 * np.pi / SIDES)
    friction = corners.coefficients(pile.friction)
    lean = friction * np.tile(np.array([np.cos(angle), np.sin(angle)])[:, None], (1, len(corners.points), 1))
    edges = corners.normals[:, None] + np.einsum("apk,apd->pkd", lean, corners.tangents)
    roots = [part for one in zip(mass, gyration, strict=True) for part in _inverse_roots(*one, length)]
    scale = block_diag(*roots)
    contact, load = scale @ corners.wrenches(edges).toarray(), scale @ corners.load
    forces = nnls(contact, -load)[0] if contact.size else np.zeros(0)
    motion = (scale @ (load + contact @ forces) * corners.unit).reshape(-1, 6)
    if not np.abs(motion).max() > _STILL * np.linalg.norm(world.gravity):
        raise ValueError(
            f"the {len(bricks)} bricks must include a brick that falls, but no brick moves: call fall_time only for "
            "bricks that cannot stand"
        )
    return motion[:, :3], motion[:, 3:] / length


def _inverse_roots(mass: float, gyration: FloatArray, length: float) -> tuple[FloatArray, FloatArray]:
    """Return both blocks (3, 3) of M^(-1/2) of a body: of its mass, and of its inertia over ``length`` squared."""
    values, axes = np.linalg.eigh(mass * gyration / length**2)
    return np.eye(3) / math.sqrt(mass), (axes / np.sqrt(values)) @ axes.T


def _way_to_the_limit(bricks: Sequence[Brick], linear: FloatArray, angular: FloatArray) -> float:
    """Return the least q at which the displacements q a reach the limit of a brick.

    The limit of a brick is toppling or sliding. If no brick topples or slides, the limit is dropping.
    """
    thickness = np.array([min(brick.size) for brick in bricks])
    fastest = float(np.linalg.norm(linear, axis=1).max())
    turning = np.hypot(angular[:, 0], angular[:, 1])
    sliding, dropping = np.hypot(linear[:, 0], linear[:, 1]), -linear[:, 2]
    ways = _ways(np.full(len(bricks), TILT_LIMIT), turning, fastest / thickness.max())
    ways += _ways(SLIDE_LIMIT * thickness, sliding, fastest)
    return min(ways or _ways(SLIDE_LIMIT * thickness, dropping, fastest))


def _ways(limits: FloatArray, speeds: FloatArray, fastest: float) -> list[float]:
    moving = speeds > _STILL * fastest
    return list((limits[moving] / speeds[moving]).tolist())
