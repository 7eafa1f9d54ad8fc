"""The engine's own contacts of a stack at rest: the slope at which they give way, and the normal at a ridge."""

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
"""Gap [m] up to which planks count as touching."""
STEEPEST = 45.0
"""Greatest slope [deg] of the search."""
PRECISION = 1e-3
"""Tolerance of the search [deg]."""
DIFFERENT = math.radians(1.0)
"""Angle [rad] between both ridge conventions above which two planks meet at a ridge."""


class OwnContacts:
    """The latest contacts of each pair of bodies."""

    def __init__(self) -> None:
        self._pairs: dict[tuple[int, int], list[Patch]] = {}

    def see(self, contacts: Contacts) -> None:
        """Take the contacts of the latest step; pairs that are no longer listed keep their former contacts."""
        touching = contacts.chosen(contacts.separation <= TOUCHING)
        now: dict[tuple[int, int], list[Patch]] = {}
        rows = zip(touching.body_a.tolist(), touching.body_b.tolist(), touching.point, touching.normal, strict=True)
        for a, b, point, normal in rows:
            now.setdefault((a, b), []).append(Patch(a, b, point[None].copy(), normal.copy()))
        self._pairs |= now

    @property
    def patches(self) -> list[Patch]:
        """One patch per contact point."""
        return [patch for pair in self._pairs.values() for patch in pair]

    def ridge_deg(self, bricks: Sequence[Brick]) -> float | None:
        """Return the angle [deg] between the normals at ridges and their bisectors, the greatest; None without a ridge.

        Args:
            bricks: as planned, in the order of their ids from 0 on.
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
    """Return the slope [deg] up to which forces in the Coulomb cones of ``patches`` hold bricks.

    None if they do not hold them on level ground, or still do at ``STEEPEST``.

    Args:
        bricks: their masses count.
        world: its friction, and its gravity on level ground.
        axis: axis of the tilt; see ``scenarios.model.Tilt``.
        patches: contact patches.
        centers: centres of the bricks [m], shape (n, 3).
    """
    mass = np.array([brick.mass for brick in bricks])
    length = float(np.mean([max(brick.size) for brick in bricks]))

    def holds(degrees: float) -> bool:
        weights = np.outer(mass, turned(world.gravity, axis, -math.radians(degrees)))
        return bool(solve_balance(centers, weights, patches, world.friction, length).balanced)

    bracket = Bisection(0.0, STEEPEST, PRECISION).search(holds)
    return bracket.middle if bracket.is_found and bracket.low_stands else None


def _angle(first: FloatArray, second: FloatArray) -> float:
    """Return the angle [rad] between two unit normals, whichever way they point."""
    return math.acos(min(1.0, abs(float(first @ second))))
