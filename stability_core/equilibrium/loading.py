"""Load a stack from zero prestress, to decide whether contact forces that hold the bodies arise by themselves.

Forces inside the Coulomb cones may be a self-stress that nothing supplies. For example, two walls could hold a brick
between them only if something pressed the walls together. Therefore every contact gets a compliance, all loads grow
from zero, and the bodies move until the contacts hold them. One solution gives the whole path of proportional loads,
because with closed gaps the problem is homogeneous of degree 1:

    M u / kappa = A f(u) - w                       u (n, 6): displacements, A f: wrenches of the contacts,
                                                   w: wrenches that balance the loads, as in ``newton``
    v = A^T u                                      relative displacement at a contact, v_n along its normal
    f_n = max(0, -v_n - NORMAL_NOISE |v_t|)        pressed as the contact closes
    f_t = Proj_{|f_t| <= mu f_n} (-r v_t)          r: tangential over normal stiffness

M contains the weights, and M u / kappa is the unbalanced rest: u / kappa is the remaining acceleration [g]. As kappa
grows, u tends to a limit for a body that stands, and grows in proportion to kappa for a body that falls. The
sensitivity decides between both cases for each body:

    d u / d ln kappa = (A C A^T + M / kappa)^-1 M u / kappa        C: tangent of the contact law

The sensitivity is u for a body that falls, and u times (compliance / kappa) for a body that stands. Both cases
differ by powers of ten. The bodies need no prestress if the sensitivity is small for each tangential stiffness of
``STIFFNESSES``.

The term NORMAL_NOISE |v_t| subtracts the closure that an error of the normal could cause. Without this term, the sign
of a rounding error would decide whether a brick that slides along a neighbour's side jams or falls.

Proof: f(u) lies in the Coulomb cones and balances the loads up to M u / kappa. Therefore a stack that stands in this
loading has an equilibrium that arises monotonically from zero.

Limits: the method examines one loading path (all loads in proportion) and three stiffnesses. The method refuses a body
that only prestress holds (a hammered wedge).

References: J. S. Pang, J. Trinkle, "Stability characterizations of rigid body contact problems with Coulomb friction",
ZAMM 80 (2000) 643-663, for the notion. G. T.-C. Kao et al., "Coupled rigid-block analysis", Computer-Aided Design 146
(2022) 103216, for self-stress that statics alone accepts.
"""

from __future__ import annotations

import numpy as np

from stability_core.compiled import compiled
from stability_core.equilibrium.compliance import COULOMB, NEWTON_STEPS, ROUNDS, Case, displace, displace_in_rounds
from stability_core.equilibrium.envelope import envelope_of, numbering
from stability_core.equilibrium.problem import Problem
from stability_core.port import BoolArray, FloatArray

STIFFNESSES = np.array([1.0, 0.1, 10.0])
"""Ratios of the tangential to the normal stiffness of a contact. The bodies must stand for all three ratios, because
the true ratio is unknown."""
KAPPA = 1e7
"""Displacement at which the term M u / kappa equals the weight of a body [mean weight / normal stiffness]. The value is
a hundred times the sag of a tower of 100 blocks. For a falling body, the rounding error of the forces at this
displacement is 1e-9 of the weights."""
SENSITIVE = 0.1
"""Ratio of a body's sensitivity to its displacement, above which contacts do not hold the body. Standing bodies have
ratios of 1e-6 to 1e-2 (a tower of 100 blocks, an arch of 200 blocks). Falling bodies have ratios of 0.5 to 1."""
WARM_STEPS = 8
"""Greatest number of Newton steps from an earlier displacement, before loading starts again from zero."""
FEW_KAPPAS, MANY_KAPPAS = np.array([1e2, KAPPA]), 10.0 ** np.linspace(0.0, 7.0, 15)
"""Short and long sequence of kappa. Newton's method rarely fails on the short sequence, or on its last value alone. On
the long sequence, rounds of friction bounds continue where Newton's method fails."""
NO_ROUNDS, FEW_ROUNDS, ALL_ROUNDS = 0, 8, ROUNDS * len(MANY_KAPPAS)
"""Greatest numbers of rounds of friction bounds on the long sequence of kappa:

- NO_ROUNDS: loading does not try the long sequence;
- FEW_ROUNDS: twice the 4 rounds that courses of touching bricks take at most. Of 238 questions in a poured pile of 100
  bricks, more rounds decided none, and took up to 5 s;
- ALL_ROUNDS: ``ROUNDS`` for each value of kappa.
"""
WIDEST = 48
"""Greatest mean length of the matrix rows [entries] at which loading tries the long sequence. A pile of twenty bricks
has longer rows. There the long sequence costs 0.1 s and rarely decides more bodies. An arch has rows of 12 entries."""


@compiled
def _displace_in_small_steps(case: Case, u: FloatArray, rounds: int) -> FloatArray:
    """Load through the long sequence of kappa from ``u`` (n, 6) = 0, and return the same ratios as ``displace``.

    Where Newton's method fails, rounds of friction bounds continue. After ``rounds`` rounds in total, the sequence ends
    at the first value without a solution.
    """
    known, sensitivity = np.empty_like(u), np.ones(len(u))
    for kappa in MANY_KAPPAS:  # after a failure, a later kappa may converge
        known[:] = u
        held, sensitivity = displace(case, kappa, NEWTON_STEPS, u)
        if not held:
            u[:] = known
            held, sensitivity, used = displace_in_rounds(case, kappa, min(ROUNDS, rounds), u)
            rounds -= used
            if not held and rounds == 0:
                break
    return sensitivity


@compiled
def displace_step_by_step(case: Case, u: FloatArray, rounds: int) -> FloatArray:
    """Load at ``KAPPA`` from the displacements ``u`` (n, 6), which the function overwrites.

    If contacts do not hold all bodies, the function loads from zero: through a smaller value of kappa, then at
    ``KAPPA`` alone. If both fail, a long sequence of values follows, with at most ``rounds`` rounds of friction bounds,
    but only for short matrix rows (see ``WIDEST``). Only the last sequence decides a fall, because a long step may end
    in a distant jam. A distant jam may hold fewer bodies than the path from zero.

    Returns:
        The ratio of each body's sensitivity to its displacement, shape (n,). See ``displace`` for the values without a
        solution.
    """
    if u.any():
        held, sensitivity = displace(case, KAPPA, WARM_STEPS, u)
        if held and sensitivity.max() <= SENSITIVE:
            return sensitivity
    for kappas in (FEW_KAPPAS, FEW_KAPPAS[1:]):
        u[:] = 0.0
        for kappa in kappas:
            held, sensitivity = displace(case, kappa, NEWTON_STEPS, u)
            if not held:
                break
        if held and sensitivity.max() <= SENSITIVE:
            return sensitivity
    if rounds == 0 or case.envelope.size > WIDEST * len(case.problem.load) * 6:
        return sensitivity
    u[:] = 0.0
    return _displace_in_small_steps(case, u, rounds)


@compiled
def needs_prestress(problem: Problem, displacement: FloatArray, rounds: int) -> BoolArray:
    """Return the mask (n,) of the bodies that contacts do not hold while all loads grow from zero.

    Args:
        problem: n bodies, each with a weight, that have an equilibrium.
        displacement: start of the search for each of ``STIFFNESSES``, shape (3, n, 6): the solution of a similar
            problem, or zero. The solution overwrites the start. Zero overwrites the starts from the first ratio for
            which contacts do not hold all bodies.
        rounds: greatest number of rounds of friction bounds for each of ``STIFFNESSES``, such as ``ALL_ROUNDS``.
    """
    n = len(problem.load)
    unit = np.abs(problem.load[:, :3]).sum() / n
    scaled = Problem(
        problem.body_a,
        problem.body_b,
        problem.lever_a,
        problem.lever_b,
        problem.normal,
        problem.friction,
        problem.load / unit,
        problem.slack / unit,
    )
    place = numbering(problem.body_a, problem.body_b, n)
    envelope = envelope_of(problem.body_a, problem.body_b, place, 6)
    found = np.zeros(n, np.bool_)
    for k in range(len(STIFFNESSES)):
        u, bound = displacement[k] / unit, np.full(len(problem.normal), COULOMB)
        sensitivity = displace_step_by_step(Case(scaled, STIFFNESSES[k], bound, place, envelope), u, rounds)
        for i in range(n):
            found[i] = not sensitivity[i] <= SENSITIVE
        if found.any():
            displacement[k:] = 0.0
            return found
        displacement[k] = u * unit
    return found
