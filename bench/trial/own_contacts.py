"""The engine's own contacts of a stack at rest: the slope that they can hold, and their normals at ridges.

At a ridge, parallel edges of two planks meet.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from bench.trial.gravity import turned
from scenarios.bisection import Bisection
from scenarios.geometry import FloatArray
from scenarios.model import Brick, World
from scenarios.statics.contact_patch import Patch, contact_patches
from scenarios.statics.force_balance import solve_balance
from stability_core import Contacts

TOUCHING = 20e-6
"""Greatest separation of two bodies at a contact point that counts as touching [m]."""
STEEPEST = 45.0
"""Upper end of the search for the greatest slope [deg]."""
PRECISION = 1e-3
"""Greatest width of the final bracket of the search [deg]."""
DIFFERENT = math.radians(1.0)
"""Angle between a face normal of a plank and the bisector of the face normals of both planks [rad], above which the
planks meet at a ridge."""


class OwnContacts:
    """Collector of the latest touching contacts (see ``TOUCHING``) of each pair of bodies."""

    def __init__(self) -> None:
        self._pairs: dict[tuple[int, int], list[Patch]] = {}

    def see(self, contacts: Contacts) -> None:
        """Record the touching contacts of the latest step; pairs without such contacts keep their earlier contacts."""
        touching = contacts.chosen(contacts.separation <= TOUCHING)
        now: dict[tuple[int, int], list[Patch]] = {}
        rows = zip(touching.body_a.tolist(), touching.body_b.tolist(), touching.point, touching.normal, strict=True)
        for a, b, point, normal in rows:
            now.setdefault((a, b), []).append(Patch(a, b, point[None].copy(), normal.copy()))
        self._pairs |= now

    @property
    def patches(self) -> list[Patch]:
        """Patches of all contacts, one patch per contact point."""
        return [patch for pair in self._pairs.values() for patch in pair]

    def ridge_deg(self, bricks: Sequence[Brick]) -> float | None:
        """Return the greatest angle between a contact normal at a ridge and the bisector of the face normals [deg].

        The result is None without a ridge, or without contacts at a ridge.

        Args:
            bricks: bricks at their planned poses, in the order of their ids from 0 on.
        """
        bisectors, faces = (
            {(patch.first, patch.second): patch.normal for patch in contact_patches(bricks, ridge=ridge)}
            for ridge in ("bisector", "face")
        )
        ridges = {pair: normal for pair, normal in bisectors.items() if _angle(normal, faces[pair]) > DIFFERENT}
        angles = [
            _angle(patch.normal, bisector)
            for (a, b), bisector in ridges.items()
            for pair in ((a, b), (b, a))
            for patch in self._pairs.get(pair, ())
        ]
        return math.degrees(max(angles)) if angles else None


def limit_slope(
    bricks: Sequence[Brick], world: World, axis: tuple[float, float], patches: Sequence[Patch], centers: FloatArray
) -> float | None:
    """Return the greatest slope at which forces in the Coulomb cones of ``patches`` can hold the bricks [deg].

    The result is None if the forces cannot hold the bricks on level ground, or hold the bricks even at ``STEEPEST``.

    Args:
        bricks: bricks with the masses and sizes to use.
        world: a world with the friction of the scene and the gravity on level ground.
        axis: horizontal axis of the tilt (x, y); see ``scenarios.model.Tilt``.
        patches: contact patches.
        centers: centres of the bricks [m], shape (n, 3), world frame.
    """
    mass = np.array([brick.mass for brick in bricks])
    length = float(np.mean([max(brick.size) for brick in bricks]))

    def holds(degrees: float) -> bool:
        weights = np.outer(mass, turned(world.gravity, axis, -math.radians(degrees)))
        return bool(solve_balance(centers, weights, patches, world.friction, length).balanced)

    bracket = Bisection(0.0, STEEPEST, PRECISION).search(holds)
    return bracket.middle if bracket.is_found and bracket.low_stands else None


def _angle(first: FloatArray, second: FloatArray) -> float:
    """Return the angle between the lines along two unit normals [rad], from 0 to pi / 2."""
    return math.acos(min(1.0, abs(float(first @ second))))
