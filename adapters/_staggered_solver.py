"""Staggered projections: solve the contact problem of a step by turns of the impact and the friction program.

    beta = the friction of the step before
    repeat
        w, alpha = impact(start + D^T beta)
        residual = the greatest violation of the law of friction by (w, alpha, beta)
        beta = friction(start + N^T alpha)
    until the residual is small, or the turns are exhausted

The result comes from an impact program, so that nothing penetrates, unless no velocities avoid penetration. Both
programs are projections, and neither program adds kinetic energy. The alternation may fail to converge. The solver then
returns the iterate with the least residual.

The matrix D D^T has the diagonal d. Let b be the projection of beta - D w / d on the cone of mu alpha. The residual of
a contact is d times the difference between beta and b. The residual is zero if and only if the friction obeys Coulomb's
law, for the alpha of the same impact. See ``_staggered_programs`` for the symbols. The unit is the velocity that
gravity adds in a step.

Source: D. M. Kaufman, S. Sueda, D. L. James, D. K. Pai, "Staggered projections for frictional contact in multibody
systems", ACM Transactions on Graphics 27(5), 2008. The scheme follows two public implementations, SCISim and
ContactBench, because the text of the paper was not available. The stopping rule, the box as the default cone, the
acceleration (``Mixing``) and the correction of overlaps are additions of this module.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from adapters._staggered_programs import Friction, Impact, friction_in_box, friction_in_disc, impact, normal_rows
from adapters.reference.contact_rows import ContactRows
from stability_core.port import FloatArray

CONES: dict[str, Callable[[ContactRows, FloatArray, FloatArray], Friction]] = {
    "box": friction_in_box,
    "disc": friction_in_disc,
}


@dataclass(slots=True)
class Turns:
    """Record of the turns of one step."""

    count: int
    """Number of impact programs."""
    residual: float
    """Residual of the returned iterate, in units of U (``reference.contact_rows``)."""
    rise: float
    """Greatest rise of kinetic energy in one program, in units of M U^2 (``reference.contact_rows``). The rise is
    positive by the programs' rounding errors only, unless the host moves a body of the contacts."""


class Mixing:
    """Anderson's acceleration of the alternation beta -> F(beta), the friction after an impact with friction beta.

    The velocities f_k = D^T (F(beta_k) - beta_k) measure the change in turn k. The next friction is

        F(beta_k) - sum gamma_j (F(beta_j+1) - F(beta_j)),    gamma minimises |f_k - sum gamma_j (f_j+1 - f_j)|

    The norm is a norm of velocities, because the impulses of a stack are not unique.
    """

    def __init__(self, problem: ContactRows, memory: int) -> None:
        """Start without turns for a contact problem; ``mixed`` combines up to ``memory`` earlier turns."""
        self._problem = problem
        self._memory = memory
        self._turns: list[tuple[FloatArray, FloatArray]] = []

    def mixed(self, beta: FloatArray, after: FloatArray) -> FloatArray:
        """Return the friction (n, 2) of the next turn, from the friction before and after the present turn."""
        if not self._memory:
            return after
        self._turns = [*self._turns[-self._memory :], (after, along_tangents(self._problem, after - beta))]
        if len(self._turns) == 1:
            return after
        changes = np.diff(np.array([change for _, change in self._turns]), axis=0)
        weights = np.linalg.lstsq(changes.T, self._turns[-1][1], rcond=1e-8)[0]
        steps = np.diff(np.array([value for value, _ in self._turns]), axis=0)
        mixed: FloatArray = after - np.tensordot(weights, steps, 1)
        return mixed


@dataclass(frozen=True, slots=True)
class StaggeredSolver:
    """The alternation with the settings of a profile."""

    friction: float
    """Coefficient of every contact."""
    tolerance: float
    """Residual, in units of U (``reference.contact_rows``), at which the alternation ends."""
    most_turns: int
    """Greatest number of turns."""
    memory: int
    """Number of earlier turns that ``Mixing`` combines; 0 for the plain alternation."""
    cone: str
    """Shape of the friction cone's section: one of ``CONES``."""

    def solve(self, problem: ContactRows, warm: FloatArray) -> tuple[FloatArray, FloatArray, Turns]:
        """Return the velocities (m, 6) after the contacts, the impulses (n, 3) along the rows, and the record.

        Args:
            problem: the contact problem.
            warm: friction impulses of the step before along both tangents, shape (n, 2).
        """
        start = problem.start.ravel()
        if not len(problem):
            return problem.start, np.zeros((0, 3)), Turns(0, 0.0, 0.0)
        normals = normal_rows(problem)
        least = -np.maximum(problem.gap, 0.0) - problem.drive[:, 0]
        beta, turns = warm, Turns(0, np.inf, 0.0)
        best: tuple[Impact, FloatArray] | None = None
        mixing = Mixing(problem, self.memory)
        while turns.count < self.most_turns:
            turns.count += 1
            pushed = start + along_tangents(problem, beta)
            hit = impact(normals, pushed, least)
            turns.rise = max(turns.rise, _energy(hit.velocity) - _energy(pushed))
            residual = self.residual(problem, hit, beta)
            if residual < turns.residual or best is None:
                best, turns.residual = (hit, beta), residual
            if residual <= self.tolerance or turns.count == self.most_turns:
                break
            loaded = start + along_normals(problem, hit.alpha)
            rubbed = CONES[self.cone](problem, loaded, self.friction * hit.alpha)
            turns.rise = max(turns.rise, _energy(rubbed.velocity) - _energy(loaded))
            beta = mixing.mixed(beta, rubbed.beta)
        assert best is not None
        hit, beta = best
        return hit.velocity.reshape(-1, 6), np.column_stack([hit.alpha, beta]), turns

    def residual(self, problem: ContactRows, hit: Impact, beta: FloatArray) -> float:
        """Return the greatest violation of the law of friction, in units of U (``reference.contact_rows``)."""
        rows = problem.jacobian[:, 1:]
        diagonal = np.maximum((rows * rows).sum(axis=(2, 3)), 1e-12)
        wanted = beta - (_along(problem, rows, hit.velocity) + problem.drive[:, 1:]) / diagonal
        bound = self.friction * np.maximum(hit.alpha, 0.0)
        if self.cone == "disc":
            length = np.maximum(np.linalg.norm(wanted, axis=1), 1e-300)
            allowed = wanted * np.minimum(1.0, bound / length)[:, None]
        else:
            allowed = np.clip(wanted, -bound[:, None], bound[:, None])
        return float((np.abs(allowed - beta) * diagonal).max())

    def correction(self, problem: ContactRows, velocity: FloatArray, share: float, most: float) -> FloatArray:
        """Return displacements (m, 6), as scaled velocities for one step, that push overlapping boxes apart.

        Args:
            problem: the contact problem.
            velocity: velocities (m, 6) after the contacts.
            share: share of an overlap that the step removes.
            most: greatest removed overlap, divided by the distance that the velocity unit covers in a step.
        """
        ahead = problem.gap + _along(problem, problem.jacobian[:, :1], velocity.ravel())[:, 0] + problem.drive[:, 0]
        least = np.where(ahead < 0.0, np.minimum(-share * ahead, most), -ahead)
        return impact(normal_rows(problem), np.zeros(problem.start.size), least).velocity.reshape(-1, 6)


def along_normals(problem: ContactRows, alpha: FloatArray) -> FloatArray:
    """Return the change of the scaled velocities (6 m,) by normal impulses (n,)."""
    return _spread(problem, problem.jacobian[:, 0] * alpha[:, None, None])


def along_tangents(problem: ContactRows, beta: FloatArray) -> FloatArray:
    """Return the change of the scaled velocities (6 m,) by friction impulses (n, 2)."""
    return _spread(problem, (problem.jacobian[:, 1:] * beta[:, :, None, None]).sum(axis=1))


def _spread(problem: ContactRows, changes: FloatArray) -> FloatArray:
    """Return the sums (6 m,) of changes (n, 2, 6) of the bodies a and b of each contact."""
    spread = np.zeros((len(problem.start) + 1, 6))
    np.add.at(spread, problem.body.ravel(), changes.reshape(-1, 6))  # index -1 is the last row, of all fixed bodies
    return spread[:-1].ravel()


def _along(problem: ContactRows, rows: FloatArray, velocity: FloatArray) -> FloatArray:
    """Return the velocities (n, k) along rows (n, k, 2, 6)."""
    of_bodies = np.vstack([velocity.reshape(-1, 6), np.zeros(6)])[problem.body]
    along: FloatArray = np.einsum("ckbj,cbj->ck", rows, of_bodies)
    return along


def _energy(velocity: FloatArray) -> float:
    return float(velocity @ velocity) / 2
