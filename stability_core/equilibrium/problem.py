"""The statics problem of bodies and contacts, and the checks of the proofs that bodies stand or fall.

The checks recompute the imbalance and the work of a motion, independently of the search for the forces or the motion.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stability_core.compiled import compiled
from stability_core.equilibrium.cone import project
from stability_core.port import BoolArray, FloatArray, IntArray

BALANCED = 1e-9
"""Imbalance, relative to the largest force on a body, up to which the body is in balance, because rounding leaves about
1e-12."""


class Problem(NamedTuple):
    """Bodies, numbered from 0, and the contacts between the bodies."""

    body_a: IntArray
    """First body of each contact, negative for a fixed body, shape (m,)."""
    body_b: IntArray
    """Second body, on which the force acts, shape (m,). The opposite force acts on the first body."""
    lever_a: FloatArray
    """Lever from the first body's centre of mass to the contact, over that body's size, shape (m, 3)."""
    lever_b: FloatArray
    """Lever from the second body's centre of mass to the contact, over that body's size, shape (m, 3)."""
    normal: FloatArray
    """Unit normals from a to b, shape (m, 3)."""
    friction: FloatArray
    """Coulomb coefficients, shape (m,)."""
    load: FloatArray
    """Force [N] and moment [N, over the body's size] that contacts must exert on each body, shape (n, 6)."""
    slack: FloatArray
    """Moment [N, over the body's size] that may stay unbalanced, shape (n,).

    A body that touches only in points and lines has a slack: the moment of the weight about a contact point with a
    measurement error. A rigid sphere needs this slack, because the sphere does not balance on a point that lies off the
    vertical by a rounding error. For all other bodies, the slack is zero."""


@compiled
def along_contacts(problem: Problem, motion: FloatArray, velocity: FloatArray) -> None:
    """Write A^T y for a ``motion`` y (n, 6): the relative ``velocity`` (m, 3) of b against a at each contact."""
    for c in range(len(velocity)):
        velocity[c] = 0.0
        for sign, body, lever in (
            (-1.0, problem.body_a[c], problem.lever_a[c]),
            (1.0, problem.body_b[c], problem.lever_b[c]),
        ):
            if body < 0:
                continue
            v = motion[body]
            velocity[c, 0] += sign * (v[0] + v[4] * lever[2] - v[5] * lever[1])
            velocity[c, 1] += sign * (v[1] + v[5] * lever[0] - v[3] * lever[2])
            velocity[c, 2] += sign * (v[2] + v[3] * lever[1] - v[4] * lever[0])


@compiled
def add_wrench(load: FloatArray, sign: float, force: FloatArray, lever: FloatArray, size: float) -> None:
    """Add ``sign`` times a force [N] at a ``lever`` [m], and its moment over ``size`` [m], to ``load`` (6,) [N]."""
    load[0] += sign * force[0]
    load[1] += sign * force[1]
    load[2] += sign * force[2]
    load[3] += sign * (lever[1] * force[2] - lever[2] * force[1]) / size
    load[4] += sign * (lever[2] * force[0] - lever[0] * force[2]) / size
    load[5] += sign * (lever[0] * force[1] - lever[1] * force[0]) / size


@compiled
def imbalance(problem: Problem, force: FloatArray, rest: FloatArray) -> None:
    """Write w - A f, each body's load w minus the action A f of the contact forces f (m, 3), to ``rest`` (n, 6)."""
    rest[:] = problem.load
    for c in range(len(force)):
        f = force[c]
        for sign, body, r in (
            (1.0, problem.body_a[c], problem.lever_a[c]),
            (-1.0, problem.body_b[c], problem.lever_b[c]),
        ):
            if body >= 0:
                add_wrench(rest[body], sign, f, r, 1.0)


@compiled
def greatest_imbalance(problem: Problem, force: FloatArray, rest: FloatArray) -> float:
    """Return the greatest imbalance of a body beyond its slack, over the largest force on it, or infinity for NaN."""
    largest = np.zeros(len(rest))
    for i in range(len(rest)):
        for k in range(6):
            largest[i] = max(largest[i], abs(problem.load[i, k]))
    for c in range(len(force)):
        size = max(abs(force[c, 0]), abs(force[c, 1]), abs(force[c, 2]))
        for body in (problem.body_a[c], problem.body_b[c]):
            if body >= 0:
                largest[body] = max(largest[body], size)
    worst = 0.0
    for i in range(len(rest)):
        for k in range(6):
            missing = abs(rest[i, k]) - (problem.slack[i] if k > 2 else 0.0)
            if not missing <= 0.0:  # 0 / 0 for a body without load and force
                share = missing / largest[i]
                if not share <= worst:  # true for NaN, which must never pass for balance
                    worst = np.inf if np.isnan(share) else share
    return worst


@compiled
def weakest_equilibrium(problem: Problem, ray: FloatArray, work: FloatArray, force: FloatArray) -> float:
    """Return a lower bound on the greatest force of any equilibrium, over the total weight, or infinity.

    ``ray`` is a motion r (n, 6). If the loads do no positive work along r, the bound is zero. Otherwise, if no contact
    resists r, the bound is infinite, because the motion proves the fall. Any forces f in the cones with A f = w, and
    any r, satisfy

        r . w = sum f_c . (A^T r)_c <= max |f_c| sum |P_K (A^T r)_c|

    From r . w the function subtracts the work of the slack.
    """
    along_contacts(problem, ray, work)
    project(work, problem.normal, problem.friction, force)
    resisted = 0.0
    for c in range(len(force)):
        resisted += np.sqrt(force[c, 0] ** 2 + force[c, 1] ** 2 + force[c, 2] ** 2)
    gained, weight = 0.0, 0.0
    for i in range(len(ray)):
        for k in range(6):
            gained += ray[i, k] * problem.load[i, k]
            if k > 2:
                gained -= problem.slack[i] * abs(ray[i, k])
            weight += abs(problem.load[i, k])
    return gained / (resisted * weight) if gained > 0.0 else 0.0


@compiled
def islands(problem: Problem) -> IntArray:
    """Return the label of each body's island, shape (n,): the bodies that contacts join, directly or indirectly.

    The function sweeps over the contacts, back and forth, until nothing changes. A sweep costs O(m).
    """
    label = np.arange(len(problem.load))
    grows = True
    while grows:
        grows = False
        for sweep in range(2):
            for i in range(len(problem.body_a)):
                c = i if sweep == 0 else len(problem.body_a) - 1 - i
                a, b = problem.body_a[c], problem.body_b[c]
                if a >= 0 and b >= 0 and label[a] != label[b]:
                    label[a] = label[b] = min(label[a], label[b])
                    grows = True
    return label


def with_neighbours(problem: Problem, bodies: BoolArray) -> BoolArray:
    """Return the mask (n,) of the bodies of the mask ``bodies`` (n,), and of all bodies that touch these bodies."""
    among = np.append(bodies, False)  # the last row is the ground's
    touching = among[problem.body_a] | among[problem.body_b]
    among[problem.body_a[touching]] = among[problem.body_b[touching]] = True
    return among[:-1]


def held_by_the_rest(problem: Problem, moves: BoolArray) -> tuple[Problem, BoolArray]:
    """Return the problem in which only the bodies of the mask ``moves`` (n,) are free.

    Also return the mask (m,) of the contacts of this problem. Bodies that fall in this problem fall in the whole
    problem as well, because fixed bodies withstand more than free bodies.
    """
    index = np.full(len(moves) + 1, -1)  # the last row is the ground's
    index[:-1][moves] = np.arange(np.count_nonzero(moves))
    body_a, body_b = index[problem.body_a], index[problem.body_b]
    theirs: BoolArray = (body_a >= 0) | (body_b >= 0)
    return Problem(
        body_a[theirs],
        body_b[theirs],
        problem.lever_a[theirs],
        problem.lever_b[theirs],
        problem.normal[theirs],
        problem.friction[theirs],
        problem.load[moves],
        problem.slack[moves],
    ), theirs


def relieved_of(problem: Problem, gone: BoolArray, force: FloatArray) -> tuple[Problem, BoolArray]:
    """Return the problem without the bodies of the mask ``gone`` (n,), but with their ``force`` (m, 3) as loads.

    Also return the mask (m,) of the remaining contacts.
    """
    stays = np.append(~gone, True)  # the last row is the ground's
    index = np.cumsum(stays) - 1
    index[-1] = -1
    kept: BoolArray = stays[problem.body_a] & stays[problem.body_b]
    rest = np.empty_like(problem.load)
    imbalance(problem, np.where(kept[:, None], 0.0, force), rest)
    return Problem(
        index[problem.body_a[kept]],
        index[problem.body_b[kept]],
        problem.lever_a[kept],
        problem.lever_b[kept],
        problem.normal[kept],
        problem.friction[kept],
        rest[~gone],
        problem.slack[~gone],
    ), kept
