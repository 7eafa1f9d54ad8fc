"""Strong stability after Pang and Trinkle, as a mixed-integer program: a second opinion on small piles.

Rigid bodies start from rest under their weights w. The masses are M, and mu is the coefficient of friction. The map J
leads from motions of the bodies to relative motions at the corners. The accelerations a of the bodies and the contact
forces f satisfy

    M a = w + J^T f
    0 <= f_n, 0 <= J_n a, and one of them is zero                          at each corner
    J_t a = 0 and |f_t| <= mu f_n, or f_t = -mu f_n J_t a / |J_t a|        where J_n a = 0

A pile is *strongly stable* if a = 0 is the only solution. In every other solution a body goes down along its weight,
because contact forces do no positive work: 0 <= a . M a <= w . a. Each corner has one of these modes: the corner is
open, sticks, or slides in one of k sectors of directions. A binary variable z for each mode except "open" makes the
problem linear:

    sum z <= 1,    0 <= J_n a <= A (1 - sum z)                     A: bound of accelerations
    f = sum of generators of the mode's cone, sum of f_n <= F z    F: bound of forces
    c . J_t a >= -A (1 - z_stick - z_j)                            c: the normals of the borders of sector j

A second set of binary variables chooses a body. The program searches for a solution in which the centre of mass of this
body falls with ``LEAST_FALL`` or more. If no solution exists, the pile is strongly stable, within these limits:

- For a pile that is its own mirror image, the program works in the plane of symmetry, with two sliding directions. The
  plane program is exact, except for motions out of the plane.
- Other piles have ``SECTORS`` sectors. Friction may lie anywhere in a triangle around the sector's arc of Coulomb's
  circle, and corners that stick have the circumscribed pyramid. Therefore the program's solutions include all true
  solutions.
- Forces are at most ``MOST_FORCE`` times the weight of all bodies. If a solution has larger, self-stressing forces,
  smaller forces in the same modes also give a solution, unless a slow motion needs a large self-stress. In tests,
  forces stayed below the weight of all bodies.
- Only the first instant counts. A weak pile may still stand: logs in three rows may roll apart, but need not.
- ``force_balance`` decides whether rest is a solution at all. If rest is no solution, "strong" only means that nothing
  falls faster than ``LEAST_FALL``.

Times of the solver HiGHS, with the numbers of binary variables:

- V, or plank at a wall (9 to 12): 0.1 to 0.6 s;
- card house of two storeys (39): 2 s;
- four balls in space (54): 10 s;
- arch of 5 voussoirs (36): 20 s;
- arch of 7 voussoirs (48): no result in one minute;
- card house of three storeys (84): no result in twenty minutes.

A pile without a result in time is in doubt.

Reference:
    J.-S. Pang and J. C. Trinkle, "Stability characterizations of rigid body contact problems with Coulomb friction",
    ZAMM 80 (2000), 643-663.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.optimize import Bounds, LinearConstraint, milp
from scipy.sparse import csr_array, hstack, vstack

from scenarios.geometry import FloatArray
from scenarios.statics.compliant_contacts import ball_gyration
from scenarios.statics.contact_patch import Patch
from scenarios.statics.contact_wrenches import Corners
from scenarios.statics.rigid_pile import Law, RigidPile, law_in_plane, law_in_space, planar_pile, spatial_pile

LEAST_FALL = 1e-4
"""Acceleration of a centre of mass along its weight [g] that counts as a fall, because the tolerances of HiGHS leave
1e-6, an overhanging brick whose centre is 1 % of its length beyond the edge has 7e-4, and a V of 72 deg that lacks 1 %
of its friction has 5e-4."""
MOST_FORCE = 10.0
"""Greatest normal force of a mode, in weights of the whole pile."""
SECONDS = 60.0
"""Default time limit [s]."""
_INFEASIBLE = 2
"""Status of ``milp`` for a program without a solution."""


@dataclass(frozen=True, slots=True)
class Strength:
    """Result of the test of strong stability."""

    verdict: Literal["strong", "weak", "doubt"]
    """Verdict on the pile:

    - ``strong``: no solution with a fall of ``LEAST_FALL`` or more exists;
    - ``weak``: a solution with a fall of ``LEAST_FALL`` or more exists; for a pile without a plane of symmetry, with
      0.92 to 1.08 times the friction;
    - ``doubt``: the pile has too many binary variables or pairs of unequal friction, or the time limit ended the
      search.
    """
    fall: float
    """Greatest acceleration of a body along its weight [g] in the solution; 0 without a solution."""
    choices: int
    """Number of binary variables for the modes of all corners."""


def strong_stability(
    centers: FloatArray,
    weights: FloatArray,
    patches: Sequence[Patch],
    friction: float,
    length: float,
    *,
    gyration: FloatArray | None = None,
    seconds: float = SECONDS,
    most_choices: int | None = None,
) -> Strength:
    """Decide whether a pile is strongly stable.

    Args:
        centers: centres of mass [m], shape (n, 3).
        weights: weight vectors [N], shape (n, 3); masses are in proportion.
        patches: contact patches.
        friction: Coulomb coefficient of every pair. If a patch has a ratio of its own, the verdict is doubt.
        length: length unit [m] of the moments: a typical edge.
        gyration: inertia over mass [m2], shape (n, 3, 3); by default the result of ``ball_gyration``.
        seconds: time limit [s].
        most_choices: greatest number of binary variables. Beyond this number the verdict is doubt at once. None for no
            limit.
    """
    if gyration is None:
        gyration = ball_gyration(centers, patches, length)
    corners = Corners(centers, weights, patches, length)
    spatial = spatial_pile(corners, gyration / length**2)
    pile, law = planar_pile(corners, spatial), law_in_plane(friction)
    if pile is None:
        pile, law = spatial, law_in_space(friction)
    choices = pile.wrenches.shape[1] * (int(law.modes.max()) + 1)
    is_uniform = bool((corners.friction_ratios == 1.0).all())
    if not is_uniform or (most_choices is not None and choices > most_choices):
        return Strength("doubt", 0.0, choices)
    return _solve(pile, law, seconds)


def _solve(problem: RigidPile, law: Law, seconds: float) -> Strength:
    """Use HiGHS to search for an acceleration with which a body falls.

    The unknowns are

    - a: d accelerations;
    - x: p g amplitudes, of g generators at each of p corners;
    - z: p m binary variables, of m modes at each corner;
    - y: n binary variables that choose a body.
    """
    size, corners, _ = problem.wrenches.shape
    bodies, modes, generators = len(problem.down), int(law.modes.max()) + 1, corners * len(law.modes)
    choices = corners * modes
    most = MOST_FORCE * float(np.abs(problem.weights).sum())
    fastest = _greatest(problem, np.eye(size))
    found = milp(
        np.zeros(size + generators + choices + bodies),
        integrality=np.repeat([0, 0, 1, 1], [size, generators, choices, bodies]),
        bounds=Bounds(
            np.concatenate([-fastest, np.zeros(generators + choices + bodies)]),
            np.concatenate([fastest, np.full(generators, most), np.ones(choices + bodies)]),
        ),
        constraints=_constraints(problem, law, most),
        options={"time_limit": seconds},
    )
    if found.x is not None:
        return Strength("weak", float((problem.down @ found.x[:size]).max()), choices)
    return Strength("strong" if found.status == _INFEASIBLE else "doubt", 0.0, choices)


def _constraints(problem: RigidPile, law: Law, most: float) -> LinearConstraint:
    """Build the constraints of the program."""
    size, corners, _ = problem.wrenches.shape
    bodies, modes, generators = len(problem.down), int(law.modes.max()) + 1, len(law.modes)
    forces = np.einsum("dpt,gt->dpg", problem.wrenches, law.generators).reshape(size, -1)
    opening = problem.wrenches[..., 0].T
    inward = np.einsum("dpt,bt->pbd", problem.wrenches[..., 1:], law.borders).reshape(-1, size)
    touching = _each(corners, np.ones((1, modes)))
    is_sector = (law.sectors[:, None] == np.arange(modes)) | (np.arange(modes) == 0)
    is_mode = law.modes == np.arange(modes)[:, None]
    apart, sideways, down = (_greatest(problem, rows) for rows in (opening, inward, problem.down))
    rows = [
        _Rows(problem.weights, problem.weights, a=problem.masses, x=-forces),
        _Rows(0.0, np.inf, a=problem.weights[None]),  # contacts do no positive work
        _Rows(0.0, np.inf, a=opening),
        _Rows(-np.inf, apart, a=opening, z=apart[:, None] * touching),
        _Rows(-sideways, np.inf, a=inward, z=-sideways[:, None] * _each(corners, is_sector)),
        _Rows(-np.inf, 0.0, x=_each(corners, is_mode), z=-most * np.eye(corners * modes)),
        _Rows(-np.inf, 1.0, z=touching),
        _Rows(-down, np.inf, a=problem.down, y=-np.diag(down + LEAST_FALL)),
        _Rows(1.0, 1.0, y=np.ones((1, bodies))),
    ]
    widths = (size, corners * generators, corners * modes, bodies)
    return LinearConstraint(
        vstack([row.matrix(widths) for row in rows], format="csr"),
        np.concatenate([np.broadcast_to(row.least, row.height) for row in rows]),
        np.concatenate([np.broadcast_to(row.most, row.height) for row in rows]),
    )


class _Rows(NamedTuple):
    """Rows of the program: ``least`` <= the sum of the parts a, x, z, y times their unknowns <= ``most``."""

    least: float | FloatArray
    most: float | FloatArray
    a: FloatArray | None = None
    """Coefficients of the accelerations."""
    x: FloatArray | None = None
    """Coefficients of the amplitudes of generators."""
    z: FloatArray | None = None
    """Coefficients of the modes."""
    y: FloatArray | None = None
    """Coefficients of the choice of the falling body."""

    @property
    def height(self) -> int:
        """Return the number of rows."""
        return next(len(part) for part in (self.a, self.x, self.z, self.y) if part is not None)

    def matrix(self, widths: Sequence[int]) -> csr_array:
        """Return the rows as one sparse matrix."""
        parts = zip((self.a, self.x, self.z, self.y), widths, strict=True)
        return hstack([csr_array((self.height, width) if part is None else part) for part, width in parts])


def _each(corners: int, block: npt.NDArray[Any]) -> FloatArray:
    """Return a matrix with a copy of ``block`` for every corner, along the diagonal."""
    blocks: FloatArray = np.kron(np.eye(corners), block)
    return blocks


def _greatest(problem: RigidPile, rows: FloatArray) -> FloatArray:
    """Return an upper bound of |row . a| over all accelerations a, for each of ``rows`` (m, d), shape (m,).

    The bound holds because a . M a <= w . a, and therefore a . M a <= w . M^-1 w.
    """
    inverse = np.linalg.inv(problem.masses)
    energy = problem.weights @ inverse @ problem.weights
    bounds: FloatArray = np.sqrt(energy * np.einsum("md,de,me->m", rows, inverse, rows))
    return bounds
