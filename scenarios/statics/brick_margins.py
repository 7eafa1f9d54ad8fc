"""The margins of each brick of a stack at rest: the additional load and the tilt up to which an equilibrium exists.

The forces f act at the corners of contact patches, each in its Coulomb cone |f_t| <= mu f_n, with the coefficient of
friction mu. The map A gives the forces and moments of f on the bodies (``contact_wrenches``), and w are the weights. A
stack has an equilibrium if A f + w = 0 has a solution.

**Load margin** of brick i [N]: the greatest force s along gravity at the brick's centre of mass for which this problem
has a solution. The vector d_i is a unit force along gravity on brick i:

    A f + w + s d_i = 0,   s >= 0,   f in the cones

The margin is infinite if every s has a solution.

**Tilt margin** of brick i [deg]: gravity, of constant strength, turns by alpha toward a direction h perpendicular to
gravity, for all bodies. The forces w_h have the size of the weights and the direction h. An equilibrium exists exactly
if this problem has a solution, because forces scale with the weights:

    A f + w + tan(alpha) w_h = 0,   f in the cones

For each direction h, the method finds the margins in rising order:

1. Find the greatest alpha that has a solution. The dual solution of the linear program is a mechanism: the motion in
   which the stack gives way. Alpha is the margin of the bricks that move in the mechanism.
2. Remove these bricks. Also remove the bricks that have no equilibrium without the removed bricks: alpha is their
   margin too.
3. Repeat the steps with the remaining bricks. No margin is less than an earlier margin.

The tilt margin of a brick is the least margin over ``DIRECTIONS`` directions h.

- An equilibrium exists up to the margin and nowhere beyond, because the solutions of each problem form a convex set.
- No margin is too large, because an inscribed pyramid of ``SIDES`` sides replaces each cone. Along the pyramid's edges
  friction is exact. Elsewhere friction is at least cos(pi / ``SIDES``) = 98 % of its exact value.
- Equilibrium is necessary for rest, but with friction not sufficient: a wedged brick may fall earlier (``truth``).
- The margins ignore the energy of a drop or a blow.
- A brick without any equilibrium, for example a brick in the air, has both margins 0.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.optimize import linprog
from scipy.sparse import csc_array, hstack

from scenarios.geometry import FloatArray
from scenarios.statics.contact_patch import Patch
from scenarios.statics.contact_wrenches import Corners, patches_among
from scenarios.statics.force_balance import BALANCED, SOLVER, Balance

SIDES = 16
"""Number of sides of the pyramid inscribed in each cone."""
DIRECTIONS = 8
"""Number of directions of the tilt, at equal angles. The first direction is that of gravity's horizontal part, or x if
gravity has no horizontal part."""
MOST_TILT = 89.0
"""Tilt [deg] from which the margin counts as 90, because the tangent grows without bounds."""
MOST_LOAD = 1e4
"""Load, in weights of all bricks, from which the load margin counts as infinite."""
_MOVES = 1e-6
"""Ratio of a brick's virtual velocity to the greatest virtual velocity from which the brick counts as moving; the value
is far above the solver's rounding."""

BoolArray = npt.NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class BrickMargins:
    """The margins of n bricks."""

    load_n: FloatArray
    """Greatest additional load at the centre of mass [N], shape (n,); infinite without a limit, 0 without
    equilibrium."""
    tilt_deg: FloatArray
    """Greatest tilt of gravity [deg], at most 90, shape (n,); 0 without equilibrium."""


class _Limit(NamedTuple):
    factor: float
    """Greatest factor of the additional load; infinite if the factor reaches ``most``."""
    moves: BoolArray
    """True for each body that moves in the mechanism at the limit, shape (n,)."""


class _Pile:
    """Bodies in equilibrium, with the forces that hold the bodies, in the dimensionless quantities of ``Corners``."""

    def __init__(self, corners: Corners, wrenches: csc_array, held: FloatArray) -> None:
        self.corners, self._wrenches = corners, wrenches
        self._held = held
        """Sums of the contact forces and of their moments on each body, shape (6 n,), which balance the weights up to
        ``BALANCED``."""

    def limit(self, load: FloatArray, most: float) -> _Limit:
        """Return the greatest factor with which contact forces hold the weights plus the factor times ``load``.

        The result also contains the bodies that move at this limit.

        Args:
            load: additional forces and moments, shape (6 n,).
            most: least factor that counts as infinite.
        """
        count = self._wrenches.shape[1]
        matrix = hstack([self._wrenches, csc_array(load[:, None])], format="csc")
        bounds = np.column_stack([np.zeros(count + 1), np.append(np.full(count, np.inf), most)])
        found = linprog(
            np.append(np.zeros(count), -1.0),
            A_eq=matrix,
            b_eq=self._held,
            bounds=bounds,
            method="highs",
            options=SOLVER,
        )
        if found.x is None:  # the limit is zero within the solver's tolerance
            return _Limit(0.0, np.ones(self.corners.bodies, bool))
        if found.x[-1] >= most * (1 - 1e-9):
            return _Limit(np.inf, np.zeros(self.corners.bodies, bool))
        return _Limit(float(found.x[-1]), _moving(found.eqlin.marginals))


def brick_margins(
    centers: FloatArray, weights: FloatArray, patches: Sequence[Patch], friction: float, length: float
) -> BrickMargins:
    """Return the margins of bodies at rest; see the module docstring for the equations.

    The function solves a linear program for each brick in equilibrium, and at least one for each direction of the tilt.

    Args:
        centers: centres of mass [m], shape (n, 3).
        weights: weight vectors [N], shape (n, 3), all in the direction of gravity.
        patches: contact patches.
        friction: Coulomb coefficient of a pair with the friction ratio 1 (``Patch.friction_ratio``).
        length: length unit [m] of the moments: a typical edge.
    """
    stack = _Stack(np.asarray(centers, np.float64), np.asarray(weights, np.float64), patches, friction, length)
    everything = np.arange(len(centers))
    if not len(everything):
        return BrickMargins(np.empty(0), np.empty(0))
    held, pile = stack.held(everything)
    margins = BrickMargins(np.zeros(len(centers)), np.zeros(len(centers)))
    if pile is None:
        return margins
    down = stack.weights.sum(axis=0) / np.linalg.norm(stack.weights.sum(axis=0))
    for row, brick in enumerate(held.tolist()):
        load = np.zeros((len(held), 6))
        load[row, :3] = down
        most = MOST_LOAD * len(held)
        margins.load_n[brick] = pile.limit(load.ravel(), most).factor * pile.corners.unit
    margins.tilt_deg[held] = 90.0
    for direction in _across(down):
        tilts = _tilts(stack, held, direction)
        margins.tilt_deg[held] = np.minimum(margins.tilt_deg[held], tilts[held])
    return margins


@dataclass(frozen=True, slots=True)
class _Stack:
    centers: FloatArray
    weights: FloatArray
    patches: Sequence[Patch]
    friction: float
    length: float

    def held(self, present: npt.NDArray[np.int64]) -> tuple[npt.NDArray[np.int64], _Pile | None]:
        """Return the bodies of ``present`` that can stay in equilibrium, and their pile; None if no body stays.

        The method removes the bodies that move in a mechanism, until contact forces hold all other bodies.
        """
        while len(present):
            corners = Corners(
                self.centers[present], self.weights[present], patches_among(present.tolist(), self.patches), self.length
            )
            angles = np.tile(np.arange(SIDES) * (2 * np.pi / SIDES), (len(corners.points), 1))
            friction = corners.coefficients(self.friction)
            solution = Balance(corners).solve(friction, angles)
            if solution.residual <= BALANCED:
                lean = friction * np.array([np.cos(angles), np.sin(angles)])
                edges = corners.normals[:, None] + np.einsum("apk,apd->pkd", lean, corners.tangents)
                forces = corners.wrenches(np.tile(np.eye(3), (len(corners.points), 1, 1))) @ solution.forces.ravel()
                return present, _Pile(corners, corners.wrenches(edges), forces)
            present = present[~_moving(solution.motion)]
        return present, None


def _tilts(stack: _Stack, held: npt.NDArray[np.int64], direction: FloatArray) -> FloatArray:
    """Return the tilt [deg] toward ``direction`` at which each brick begins to move, shape (n,).

    The tilt is 0 for bricks that are not among the ``held`` bricks.
    """
    tilts = np.zeros(len(stack.centers))
    reached, most = 0.0, math.tan(math.radians(MOST_TILT))
    strength = np.linalg.norm(stack.weights, axis=1)
    while True:
        present, pile = stack.held(held)
        tilts[np.setdiff1d(held, present)] = math.degrees(math.atan(reached))
        if pile is None:
            return tilts
        load = np.zeros((len(present), 6))
        load[:, :3] = strength[present, None] * direction / pile.corners.unit
        limit = pile.limit(load.ravel(), most)
        if math.isinf(limit.factor):
            tilts[present] = 90.0
            return tilts
        reached = max(reached, limit.factor)
        tilts[present[limit.moves]] = math.degrees(math.atan(reached))
        held = present[~limit.moves]


def _across(down: FloatArray) -> FloatArray:
    """Return the unit vectors perpendicular to gravity that ``DIRECTIONS`` describes, shape (``DIRECTIONS``, 3)."""
    leaning = np.array([down[0], down[1], 0.0])
    first = leaning if np.linalg.norm(leaning) > _MOVES else np.array([1.0, 0.0, 0.0])
    first = first - (first @ down) * down
    first /= np.linalg.norm(first)
    angles = np.arange(DIRECTIONS) * (2 * np.pi / DIRECTIONS)
    directions: FloatArray = np.outer(np.cos(angles), first) + np.outer(np.sin(angles), np.cross(down, first))
    return directions


def _moving(motion: FloatArray) -> BoolArray:
    """Return the mask (n,) of the bodies that move in ``motion``, (6 n,) or (n, 6); True for all if nothing moves."""
    speeds = np.abs(motion.reshape(-1, 6)).max(axis=1)
    moving: BoolArray = speeds >= _MOVES * speeds.max()
    return moving
