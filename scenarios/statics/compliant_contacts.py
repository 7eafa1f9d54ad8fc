"""Displacements, or remaining accelerations, of bodies on compliant contacts under their weights.

    (1 / kappa) M u = w + J^T f(v),    v = J u     u: displacements, v: relative motion at the corners, M: masses
    f_n = k max(0, -v_n)                           k: stiffness of a corner, w: weights, kappa: time squared over two
    f_t = Proj_{|f_t| <= mu f_n} (-r k v_t)        r: tangential over normal stiffness, mu: coefficient of friction

The module multiplies the rows of J by sqrt(k) and divides forces by sqrt(k), which gives k = 1 and keeps all cones.

- A solution exists for every kappa. Contact forces do no positive work (f . v <= 0). Therefore u . M u / kappa <= w . u
  bounds u, and Brouwer's theorem applies to u -> kappa M^-1 (w + J^T f(J u)).
- Without friction the solution is unique, because it is the minimum of a convex function. With friction the solution
  need not be unique.
- One solution gives the whole history of a load that grows in proportion, because the problem is homogeneous: weights t
  w lead to displacements t u. In this history sliding does not reverse.

Newton's method takes the derivative of f, or a one-sided derivative where f has no derivative. The search has three
stages, and ends with the first stage that converges:

1. Newton's method, which halves each step until the imbalance shrinks;
2. Newton's method with whole steps, which can leave a local minimum of the imbalance;
3. rounds of Newton's method with fixed friction bounds b = mu f_n of the last iterate (Tresca's friction). With fixed
   bounds shortened steps lead from any start to the solution, because the solution is the minimum of a convex energy.
   After each round the search renews the bounds, and starts stage 1 from the result of the round.

A tight course is a row of bricks whose faces touch. Of 11,630 searches in tight courses, 81 searches needed stage 3. Of
these 81 searches, 61 searches needed a single round, and 1 search found no solution.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt
from scipy.sparse import block_diag, csc_array, csr_array, diags_array
from scipy.sparse.linalg import splu

from scenarios.geometry import BoolArray, FloatArray
from scenarios.statics.contact_patch import GROUND, Patch
from scenarios.statics.contact_wrenches import Corners

IntArray: TypeAlias = npt.NDArray[np.int64]

PRECISION = 1e-8
"""Imbalance of a body, over the body's weight, up to which the body counts as balanced, so that an acceleration of
1e-4 g is exact to 1e-4 of its value."""
ROUNDING = 1e-15
"""Rounding error of forces that cancel, as a share of the forces."""
STEPS = 40
"""Greatest number of Newton steps of one stage, because piles that converge take 1 to 12 steps in stage 1."""
HALVINGS = 20
"""Greatest number of halvings of a step in stage 1."""
ROUNDS = 20
"""Greatest number of rounds of fixed friction bounds, because tight courses take up to 10 rounds, and arches and logs
up to 18."""
_DECREASE = 1e-4
"""Least ratio of the decrease by a step to the predicted decrease: of the imbalance or, with fixed bounds, of the
energy."""


@dataclass(frozen=True, slots=True)
class _Iterate:
    displacement: FloatArray
    opening: FloatArray
    """Normal part v_n of the relative motion at each corner, shape (p,)."""
    pull: FloatArray
    """Friction force -r v_t that each corner has if it sticks, shape (p, 2)."""
    pulled: FloatArray
    """Length of ``pull`` at each corner, shape (p,)."""
    sticks: BoolArray
    share: FloatArray
    """Ratio of the friction force to ``pull`` at each corner, from 0 to 1, shape (p,)."""
    forces: FloatArray
    """Normal and tangential forces at each corner, shape (p, 3)."""
    imbalance: FloatArray
    """Left side minus right side of the first equation of the module docstring, shape (6 n,)."""
    size: float
    """Euclidean norm of the imbalance."""
    energy: float
    """Energy whose minimum is the solution with fixed friction bounds."""


class CompliantPile:
    """Bodies with masses and weights, on compliant contacts with friction; see the module docstring."""

    def __init__(
        self,
        wrenches: csr_array,
        masses: FloatArray,
        gyration: FloatArray,
        load: FloatArray,
        friction: float | FloatArray,
        r: float,
    ) -> None:
        self._wrenches, self._motions = wrenches, csr_array(wrenches.T)
        blocks = [np.zeros((6, 6)) for _ in masses]
        for block, mass, squared in zip(blocks, masses, gyration, strict=True):
            block[:3, :3], block[3:, 3:] = mass * np.eye(3), mass * squared
        self._masses = csr_array(block_diag(blocks))
        self._inertia = self._masses.copy()
        """Matrix M / kappa; each Newton step replaces its values."""
        self._load, self._friction, self._ratio = load, np.ravel(friction), r
        self._corners = wrenches.shape[1] // 3
        self._precision = PRECISION * np.repeat(masses, 6)
        self._sizes = abs(wrenches)
        self._motion_sizes = self._sizes.T
        columns = np.tile(np.arange(3 * self._corners).reshape(-1, 3), (1, 3)).ravel()
        starts = 3 * np.arange(3 * self._corners + 1)
        self._stiffness = csr_array((np.zeros(len(columns)), columns, starts), shape=(3 * self._corners,) * 2)
        """Matrix of the stiffness of all corners; each Newton step replaces its values."""

    def relative_motion(self, displacement: FloatArray) -> FloatArray:
        """Return the length of the surfaces' relative motion at each corner, times sqrt(k), shape (p,)."""
        motion: FloatArray = np.linalg.norm((self._motions @ displacement).reshape(-1, 3), axis=1)
        return motion

    def bonded(self, kappa: float) -> FloatArray:
        """Return the displacements (6 n,) with bonded contacts, which neither open nor slide."""
        stiffness = diags_array(np.tile([1.0, self._ratio, self._ratio], self._corners))
        matrix = self._masses / kappa + self._wrenches @ stiffness @ self._motions
        displacement: FloatArray = splu(csc_array(matrix)).solve(self._load)
        return displacement

    def moved(self, start: FloatArray, kappa: float) -> FloatArray | None:
        """Search for the displacements (6 n,) at ``kappa``, and return None without convergence.

        The search begins with the start of less imbalance: ``start``, which suits bodies at rest, or sqrt(10) times
        ``start``, which suits accelerating bodies.
        """
        starts = [self._iterate(scale * start, kappa) for scale in (1.0, np.sqrt(10.0))]
        first = min(starts, key=lambda iterate: iterate.size)
        for search in (self._newton, self._by_whole_steps, self._by_fixed_bounds):
            found = search(first, kappa)
            if self._is_solved(found):
                return found.displacement
        return None

    def _iterate(self, displacement: FloatArray, kappa: float, bounds: FloatArray | None = None) -> _Iterate:
        motion = (self._motions @ displacement).reshape(-1, 3)
        normal, pull = np.maximum(0.0, -motion[:, 0]), -self._ratio * motion[:, 1:]
        if bounds is None:
            bounds = self._friction * normal
        pulled = np.linalg.norm(pull, axis=1)
        sticks = pulled <= bounds
        share = np.where(sticks, 1.0, bounds / np.where(pulled > 0, pulled, 1.0))
        forces = np.column_stack([normal, share[:, None] * pull])
        momentum = self._masses @ displacement / kappa
        imbalance = momentum - self._load - self._wrenches @ forces.ravel()
        size = float(np.linalg.norm(imbalance))
        held = share * pulled
        energy = float(displacement @ (momentum / 2 - self._load) + normal @ normal / 2)
        energy += float(held @ (pulled - held / 2)) / self._ratio
        return _Iterate(displacement, motion[:, 0], pull, pulled, sticks, share, forces, imbalance, size, energy)

    def _is_solved(self, iterate: _Iterate) -> bool:
        cancelled = self._sizes @ (self._motion_sizes @ np.abs(iterate.displacement))
        rounding = ROUNDING * (1.0 + self._ratio) * cancelled
        return bool((np.abs(iterate.imbalance) <= self._precision + rounding).all())

    def _newton(
        self, first: _Iterate, kappa: float, bounds: FloatArray | None = None, halvings: int = HALVINGS
    ) -> _Iterate:
        """Search for the solution near ``first``, and return the last iterate.

        Args:
            first: the first iterate, for the same ``kappa`` and ``bounds``.
            kappa: time squared over two (see the module docstring).
            bounds: fixed friction bounds, shape (p,); None for bounds that follow the normal forces.
            halvings: greatest number of halvings of a step. With 0 the method takes a step even if the imbalance grows.
        """
        iterate = first
        for _ in range(STEPS):
            step = None if self._is_solved(iterate) else self._step(iterate, kappa, are_fixed=bounds is not None)
            if step is None:
                break
            slope = -np.inf if bounds is None else float(iterate.imbalance @ step)
            for length in 0.5 ** np.arange(halvings + 1):
                tried = self._iterate(iterate.displacement + length * step, kappa, bounds)
                is_smaller = tried.size <= (1.0 - _DECREASE * length) * iterate.size
                if not halvings or is_smaller or tried.energy <= iterate.energy + _DECREASE * length * slope:
                    break
            else:
                break
            iterate = tried
        return iterate

    def _step(self, iterate: _Iterate, kappa: float, *, are_fixed: bool) -> FloatArray | None:
        """Return Newton's step (6 n,); None if the matrix is singular.

        With the ``pull`` q of a corner, its direction e = q / |q| and its friction bound b, -df/dv has the blocks

        - normal, normal: 1 if the corner is closed;
        - tangential, tangential: r I if the corner sticks, else r b / |q| (I - e e^T);
        - tangential, normal: mu e if the corner slides and b = mu f_n.
        """
        closed = iterate.opening < 0
        along = iterate.pull / np.where(iterate.pulled > 0, iterate.pulled, 1.0)[:, None]
        across = np.eye(2) - np.where(iterate.sticks[:, None, None], 0.0, along[:, :, None] * along[:, None, :])
        derivative = np.zeros((self._corners, 3, 3))
        derivative[:, 0, 0] = closed
        derivative[:, 1:, 1:] = self._ratio * iterate.share[:, None, None] * across
        if not are_fixed:
            derivative[~closed] = 0.0
            derivative[:, 1:, 0] = np.where((closed & ~iterate.sticks)[:, None], self._friction[:, None] * along, 0.0)
        self._stiffness.data, self._inertia.data = derivative.ravel(), self._masses.data * (1.0 / kappa)
        matrix = csc_array(self._inertia + self._wrenches @ self._stiffness @ self._motions)
        try:
            step: FloatArray = splu(matrix).solve(-iterate.imbalance)
        except RuntimeError:  # exactly singular
            return None
        return step if np.isfinite(step).all() else None

    def _by_whole_steps(self, first: _Iterate, kappa: float) -> _Iterate:
        """Search by whole steps from ``first``, and return the last iterate."""
        return self._newton(first, kappa, halvings=0)

    def _by_fixed_bounds(self, first: _Iterate, kappa: float) -> _Iterate:
        """Search by rounds of fixed friction bounds from ``first``, and return the last iterate."""
        found = first
        for _ in range(ROUNDS):
            bounds = self._friction * found.forces[:, 0]
            held = self._newton(self._iterate(found.displacement, kappa, bounds), kappa, bounds).displacement
            renewed = self._iterate(held, kappa)
            found = self._newton(renewed, kappa)
            if self._is_solved(found):
                break
            found = renewed
        return found


def pile_of(
    corners: Corners, gyration: FloatArray, friction: float, ratio: float, stiffness: FloatArray
) -> CompliantPile:
    """Build a compliant pile from the corners of its contact patches.

    Args:
        corners: corners of the contact patches, with the bodies' loads.
        gyration: inertia over mass, in squares of the length unit, shape (n, 3, 3).
        friction: Coulomb coefficient of every pair; a patch may have a ratio of its own (``Patch.friction_ratio``).
        ratio: tangential over normal stiffness.
        stiffness: relative normal stiffness of each corner, shape (p,).
    """
    frames = np.stack([corners.normals, *corners.tangents], axis=1)
    wrenches = csr_array(corners.wrenches(frames) @ diags_array(np.repeat(np.sqrt(stiffness), 3)))
    coefficients = corners.coefficients(friction)
    return CompliantPile(wrenches, _masses(corners), gyration, corners.load, coefficients, ratio)


def even_stiffness(corners: Corners) -> FloatArray:
    """Return the same stiffness for each corner, shape (p,)."""
    return np.ones(len(corners.points))


def stiffness_by_weight(corners: Corners) -> FloatArray:
    """Return the stiffness of each corner, in proportion to the reduced weight of its two bodies, shape (p,).

    The reduced weight of two bodies with weights a and b is 1 / (1 / a + 1 / b). With this stiffness all bodies sink by
    the same amount under their own weights. Therefore a heavy body does not press on its neighbours.
    """
    compliance = 1.0 / np.append(_masses(corners), np.inf)  # the last entry is for GROUND, -1
    stiffness: FloatArray = 1.0 / (compliance[corners.first] + compliance[corners.second])
    return stiffness


def _masses(corners: Corners) -> FloatArray:
    masses: FloatArray = np.linalg.norm(corners.load.reshape(-1, 6)[:, :3], axis=1)
    return masses


def ball_gyration(centers: FloatArray, patches: Sequence[Patch], length: float) -> FloatArray:
    """Return the inertia over the mass [m2] of bodies of unknown shape, shape (n, 3, 3).

    Each body counts as a ball. Its inertia over the mass is a third of the squared distance from the centre of mass to
    the farthest corner of the body's contact patches. This distance counts as at least a thousandth of ``length`` [m].
    """
    reach = np.full(len(centers), 1e-3 * length)
    for patch in patches:
        for body in (patch.first, patch.second):
            if body != GROUND:
                reach[body] = max(reach[body], np.linalg.norm(patch.points - centers[body], axis=1).max())
    gyration: FloatArray = reach[:, None, None] ** 2 / 3 * np.eye(3)
    return gyration
