"""Decision whether contact forces can hold bodies at rest, by linear programs inside and around Coulomb's cone.

The unknowns are the forces at the patches' corners, each inside its Coulomb cone |f_t| <= mu f_n, with the coefficient
of friction mu. The sum of weight and contact forces, and the sum of their moments, must vanish on every body. Two
pyramids enclose each cone, because a cone is no polyhedron:

- the inscribed pyramid: forces found with this pyramid obey Coulomb's law, and prove that equilibrium exists;
- the circumscribed pyramid: if even this pyramid allows no equilibrium, no equilibrium exists. The proof is the dual
  solution: a virtual motion in which gravity does positive work and no allowed contact force does negative work.
  Therefore the works of gravity and contacts do not cancel.

While neither pyramid gives a proof, the method adds a side to the pyramids at each corner, in the direction of the
circumscribed pyramid's force. With each added side, the error in this direction falls to a quarter. A case without a
proof after ``ROUNDS`` added sides is in doubt.

Each program is elastic: it minimises the sum of missing forces and moments. Therefore each program has a solution, the
two pyramids bracket the true cone's residual, and no verdict depends on a solver's exit status.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.optimize import linprog
from scipy.sparse import csc_array, hstack

from scenarios.geometry import FloatArray
from scenarios.statics.contact_patch import Patch
from scenarios.statics.contact_wrenches import Corners

Verdict = Literal["stable", "unstable", "doubt"]
Criterion = Literal["normal forces", "vertical forces", "loading", "cone"]

BALANCED = 1e-9
"""Greatest residual of forces that balance, in weights of all bodies (for moments: weights times the length unit). The
value lies between two residuals, because the solver's own tolerance could hide 6e-10, and a harmonic overhang of 300
bricks that is too long by 1e-5 leaves 3e-7."""
SIDES = 8
"""Number of sides of the first pyramids at each corner."""
ROUNDS = 24
"""Number of added sides after which the answer is doubt, because a yawed V takes 12 sides within 1e-6 of its least
friction, and 16 sides within 1e-8."""
SOLVER = {"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10}
"""Options of HiGHS, because its default tolerances are a thousand times larger."""


@dataclass(frozen=True, slots=True)
class Statics:
    """Result of statics: the verdict whether bodies can rest, with the proof."""

    verdict: Verdict
    """Verdict on the bodies:

    - ``stable``: contact forces that hold all bodies exist and arise;
    - ``unstable``: no contact forces can hold all bodies;
    - ``doubt``: neither verdict has a proof.

    Bodies can rest only if forces that hold them exist. If normal forces alone hold the bodies, this condition is also
    sufficient. With friction this condition is not sufficient: bodies wedged against each other may stress
    themselves in theory and fall in reality (Kao et al. 2022).
    """
    by: Criterion
    """Criterion that decided the verdict:

    - ``normal forces``: normal forces alone hold all bodies;
    - ``vertical forces``: vertical forces at load-bearing contacts hold all bodies;
    - ``loading``: the bodies come to rest, or do not, while their weights grow from zero;
    - ``cone``: forces that obey Coulomb's law and balance the weights exist, or do not.
    """
    why: str
    """Reason of a doubt, in words; empty without doubt."""
    balanced: bool | None
    """True if contact forces that obey Coulomb's law and hold all bodies exist, False if none exist, None without a
    proof."""
    residual: float
    """Least sum of missing forces and moments, in weights of all bodies. The residual is at most ``BALANCED`` if
    ``balanced`` is True, and above if ``balanced`` is False. It does not measure the distance of a stable stack from
    its limit."""
    frictionless: bool
    """True if normal forces alone hold all bodies."""
    points: FloatArray
    """The patches' corners [m], shape (p, 3)."""
    normals: FloatArray
    """Unit normal at each corner, from its first body to its second, shape (p, 3)."""
    bodies: tuple[tuple[int, int], ...]
    """First and second body of each corner."""
    forces: FloatArray
    """Force [N] on the second body at each corner, shape (p, 3). If ``balanced`` is True, these forces prove it. Other
    forces may also hold the bodies, and the forces that arise in reality generally differ from these forces."""
    mechanism: FloatArray
    """Virtual velocity of each body, shape (n, 6): linear, then angular times the length unit, at most 1 in any
    component. The mechanism proves the verdict ``unstable``, and is zero with any other verdict. Bodies that do not
    move in the mechanism need not fall."""

    @property
    def stable(self) -> bool:
        """Return whether the verdict is ``stable``."""
        return self.verdict == "stable"


@dataclass(frozen=True, slots=True)
class Solution:
    """Solution of an elastic linear program."""

    residual: float
    """Least sum of missing forces and moments, in weights of all bodies."""
    forces: FloatArray
    """Forces on the second bodies, in units of the mean weight, shape (p, 3)."""
    motion: FloatArray
    """Dual solution: virtual motion of each body, shape (n, 6)."""


class Balance:
    """The elastic linear program of a stack, in the dimensionless quantities of ``Corners``."""

    def __init__(self, corners: Corners) -> None:
        self._corners = corners

    def solve(self, friction: float | FloatArray, angles: FloatArray) -> Solution:
        """Return the solution of least residual with a pyramid of forces at each corner.

        Args:
            friction: tangent of the angle between the pyramid's edges and the normal, shape (p, k) or (p, 1), or one
                number for all edges.
            angles: directions of the edges [rad] in the contact plane, shape (p, k).
        """
        lean = friction * np.array([np.cos(angles), np.sin(angles)])
        edges = self._corners.normals[:, None] + np.einsum("apk,apd->pkd", lean, self._corners.tangents)
        return self.along(edges)

    def along(self, edges: FloatArray) -> Solution:
        """Return the solution of least residual with forces that are positive sums of ``edges`` (p, k, 3).

        Raises:
            ArithmeticError: if the solver fails.
        """
        wrenches = hstack([self._corners.wrenches(edges), *self._missing()], format="csc")
        count = edges.shape[0] * edges.shape[1]
        cost = np.ones(wrenches.shape[1])
        cost[:count] = 0.0
        found = linprog(cost, A_eq=wrenches, b_eq=-self._corners.load, method="highs", options=SOLVER)
        if found.x is None:
            raise ArithmeticError(
                f"HiGHS failed to solve the elastic linear program of {self._corners.bodies} bodies ({found.message}): "
                "report the scene as a bug of the suite"
            )
        forces = np.einsum("pk,pkd->pd", found.x[:count].reshape(edges.shape[:2]), edges)
        motion = -found.eqlin.marginals.reshape(self._corners.bodies, 6)
        return Solution(max(0.0, float(found.fun)) / self._corners.bodies, forces, motion)

    def _missing(self) -> tuple[csc_array, csc_array]:
        """Return the program's columns for missing forces and moments, positive and negative."""
        diagonal = np.arange(6 * self._corners.bodies)
        push = csc_array((np.ones(len(diagonal)), (diagonal, diagonal)))
        return push, -push


def solve_balance(
    centers: FloatArray, weights: FloatArray, patches: Sequence[Patch], friction: float, length: float
) -> Statics:
    """Decide whether contact forces can hold all bodies at rest, with forces or a mechanism as proof.

    The verdict is ``stable`` only if the existence of forces suffices for rest. Forces of two kinds suffice: normal
    forces alone, or vertical forces at load-bearing contacts. If the bodies need other friction, forces may exist
    (``balanced``) but not arise. ``truth.judge`` examines these cases further.

    Proof that normal forces p >= 0 suffice, with the weights w, the masses M, and the opening velocities J_n a of a
    motion a (see ``strong_stability``):

    - w . a = -p . J_n a <= 0 for every motion a without overlap, because p balances w.
    - a . M a <= w . a for every solution a, because contact forces do no positive work.
    - Therefore a = 0 is the only solution.

    For vertical forces this module has no proof. The criterion rests on experience: nothing slides where the whole load
    acts straight down.

    Args:
        centers: centres of mass [m], shape (n, 3).
        weights: weight vectors [N], shape (n, 3); not all zero.
        patches: contact patches.
        friction: Coulomb coefficient of every pair; a patch may have a ratio of its own (``Patch.friction_ratio``).
        length: length unit [m] of the moments: a typical edge.
    """
    corners = Corners(centers, weights, patches, length)
    coefficients = corners.coefficients(friction)
    balance = Balance(corners)

    smooth = balance.solve(0.0, np.zeros((len(corners.points), 1)))
    if smooth.residual <= BALANCED:
        return _statics(corners, smooth, "stable", "normal forces")
    if friction == 0:
        return _statics(corners, smooth, "unstable", "cone")
    vertical = balance.along(_vertical(corners, coefficients))
    if vertical.residual <= BALANCED:
        return _statics(corners, vertical, "stable", "vertical forces")
    is_balanced, solution = _in_cones(corners, balance, coefficients)
    if is_balanced is False:
        return _statics(corners, solution, "unstable", "cone")
    why = "too close to its limit to decide" if is_balanced is None else "forces exist, and need not arise"
    return _statics(corners, solution, "doubt", "cone", why=why, balanced=is_balanced)


def _in_cones(corners: Corners, balance: Balance, friction: float | FloatArray) -> tuple[bool | None, Solution]:
    """Return whether forces in the Coulomb cones balance the weights, None if undecided, and the last solution."""
    angles = np.tile(np.arange(SIDES) * (2 * np.pi / SIDES), (len(corners.points), 1))
    outer = None
    for _ in range(ROUNDS):
        outer = balance.solve(*_circumscribed(friction, angles))
        if outer.residual > BALANCED:
            return False, outer
        inner = balance.solve(friction, angles)
        if inner.residual <= BALANCED:
            return True, inner
        along_first, along_second = np.einsum("apd,pd->ap", corners.tangents, outer.forces)
        leaning = np.arctan2(along_second, along_first) % (2 * np.pi)
        angles = np.sort(np.column_stack([angles, leaning]), axis=1)
    return None, outer or balance.solve(*_circumscribed(friction, angles))


def _statics(
    corners: Corners,
    solution: Solution,
    verdict: Verdict,
    by: Criterion,
    *,
    why: str = "",
    balanced: bool | None = None,
) -> Statics:
    return Statics(
        verdict=verdict,
        by=by,
        why=why,
        balanced=balanced if verdict == "doubt" else verdict == "stable",
        residual=solution.residual,
        frictionless=by == "normal forces",
        points=corners.points,
        normals=corners.normals,
        bodies=tuple(zip(corners.first.tolist(), corners.second.tolist(), strict=True)),
        forces=corners.unit * solution.forces,
        mechanism=solution.motion if verdict == "unstable" else np.zeros((corners.bodies, 6)),
    )


def _vertical(corners: Corners, friction: float | FloatArray) -> FloatArray:
    """Return a unit force against gravity at each corner, or zero if the corner's cone excludes it, shape (p, 1, 3)."""
    up = -corners.load.reshape(-1, 6)[:, :3].sum(axis=0)
    up /= np.linalg.norm(up)
    upward = corners.normals @ up
    is_load_bearing = np.abs(upward) >= np.ravel(1 / np.hypot(1.0, friction))
    forces: FloatArray = (np.where(is_load_bearing, np.sign(upward), 0.0)[:, None] * up)[:, None]
    return forces


def _circumscribed(friction: float | FloatArray, angles: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the edges of the circumscribed pyramids, which touch the cones at rising ``angles`` (p, k) [rad].

    The result is the two arguments of ``Balance.solve``, each of shape (p, k): the tangents of the edges' angles to the
    normal, and the directions of the edges [rad].
    """
    half = np.diff(angles, axis=1, append=angles[:, :1] + 2 * np.pi) / 2
    return friction / np.cos(half), angles + half
