"""Loading of a stack from zero through compliant contacts, to find whether forces that could hold the stack arise.

Forces inside the Coulomb cones that balance all weights are necessary for rest, but not sufficient. With friction these
forces may be a self-stress that nothing supplies. For example, a brick overhangs its table and touches a heavy
neighbour with its inner end. Friction at this end could hold the brick. But when the brick begins to turn, its inner
end moves up and away from the neighbour, no pressure arises, and the brick falls.

**Model.** All contacts are elastic (``compliant_contacts``) and unloaded at first. Then the weights grow from zero. A
stack that the contacts hold comes to rest at displacements u. Otherwise a body keeps an acceleration a = u / kappa. The
method raises kappa (time squared over two) from 1 by factors of sqrt(10):

- the stack *stands* if a falls in proportion to 1 / kappa over two decades, at a sag of at most ``MOST_SAG``;
- the stack *falls* if a stays the same over two decades, in which the bonded stack comes to rest, or over the last two
  decades;
- otherwise, or without convergence, the stack is in *doubt*.

The verdict must be the same for every tangential stiffness of ``RATIOS`` and for both distributions of stiffness,
because the stiffness of real contacts is unknown. The stiffness is equal at all corners, or in proportion to the
reduced weight of the two bodies.

**Sag.** The sag of a body is the ratio of two greatest relative motions at its corners: with real contacts, and with
bonded contacts (the same linear problem). A limit of the sag is necessary, because normals have errors. Suppose that a
normal is off by an angle e [rad]. Then a contact that would not press begins to press once the body has moved by 1 / e
times its elastic compression. In the model this body stands. In reality the body has moved away long before. The sag
depends neither on the scale nor on the bodies below, because a body that moves with its neighbours does not move
against them.

**Proof.** With u = kappa a the equations are M a = w + J^T f(kappa J a).

- Forces do no positive work. Therefore a . M a and f . f / kappa are at most w . a: accelerations are bounded, and
  contacts close at most as 1 / sqrt(kappa).
- Where a and f tend to limits, no contact closes in the limit, and forces are in their cones. Forces of opening
  contacts are zero. A corner that slides has all its friction against the motion.
- Therefore the limit of a pile that "falls" is an acceleration, other than zero, that rigid bodies with Coulomb
  friction may take from rest. The pile is not strongly stable in the sense of Pang and Trinkle.
- A pile that "stands" reaches an equilibrium without prestress, for each of six kinds of contacts. This equilibrium is
  less than strong stability, because other solutions may exist.

**Limits.** If the surfaces of a contact move exactly parallel to each other, compression alone decides, because
displacements are infinitesimal and gaps are zero. All contacts belong to the plan: the model makes no new contacts.
Solutions need not be unique: the method finds the solution that continues the solution of soft contacts.

References:
    J.-S. Pang and J. C. Trinkle, "Stability characterizations of rigid body contact problems with Coulomb friction",
    ZAMM 80 (2000), 643-663.
    G. T.-C. Kao, A. Iannuzzo, B. Thomaszewski, S. Coros, T. Van Mele, P. Block, "Coupled Rigid-Block Analysis:
    Stability-Aware Design of Complex Discrete-Element Assemblies", Computer-Aided Design 146 (2022), 103216.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Literal

import numpy as np

from scenarios.geometry import FloatArray
from scenarios.statics.compliant_contacts import (
    CompliantPile,
    ball_gyration,
    even_stiffness,
    pile_of,
    stiffness_by_weight,
)
from scenarios.statics.contact_patch import GROUND, Patch
from scenarios.statics.contact_wrenches import Corners

RATIOS = (1.0, 0.1, 10.0)
"""Ratios of tangential to normal stiffness. The list has three ratios, because elastic spheres have 0.7 to 1, and rough
faces and grains may have far less."""
DISTRIBUTIONS = (stiffness_by_weight, even_stiffness)
"""Distributions of normal stiffness over the corners."""
MOST_SAG = 100.0
"""Sag up to which a pile counts as standing, because these sags were computed:

- 1 to 6 in card houses, logs, balls and planks at walls that stand;
- 12, 24 and 49 in arches of 50, 100 and 200 voussoirs at their limit;
- up to 70 in tight courses that two engines let stand;
- 600 to 9,000, 300 to 900 and 100 to 270 at contacts that press only because their normals are off by 0.001, 0.01 and
  0.03 rad.
"""
STANDS = 0.02
"""Greatest ratio of the acceleration at kappa to the acceleration at kappa / 100 with which a pile stands, because a
pile at rest has a ratio of 0.01."""
FALLS = 0.5
"""Least ratio of the acceleration at kappa to the acceleration at kappa / 100 with which a pile falls, because a free
fall has a ratio of 1. Of 450 tight courses none had a ratio between ``STANDS`` and ``FALLS`` at the highest kappa, but
arches within 0.1 % of their limit have."""
MOST_FAILURES = 3
"""Number of kappas without a solution after which the search ends, because a search may recover after two failures in a
row."""
_DECADE = 2
"""Number of steps of kappa in a decade."""
_FIRST, _LAST = 4 * _DECADE, 8 * _DECADE
"""First and last step at which the method seeks a verdict: kappa = 1e4 and 1e8."""

Answer = Literal["stands", "falls", "doubt"]


@dataclass(frozen=True, slots=True)
class Loading:
    """Result of loading a pile from zero: stands, falls or doubt."""

    verdict: Answer
    why: str
    """Reason, in words; empty if the pile stands."""
    sag: float
    """Greatest sag of a body; infinite if the pile does not come to rest."""
    acceleration: float
    """Greatest remaining acceleration at the highest kappa [g]; angular accelerations count times the length unit."""


def load_from_zero(
    centers: FloatArray,
    weights: FloatArray,
    patches: Sequence[Patch],
    friction: float,
    length: float,
    *,
    gyration: FloatArray | None = None,
) -> Loading:
    """Load a pile from zero through six kinds of compliant contacts.

    Args:
        centers: centres of mass [m], shape (n, 3).
        weights: weight vectors [N], shape (n, 3); masses are in proportion.
        patches: contact patches.
        friction: Coulomb coefficient of a pair with the friction ratio 1 (``Patch.friction_ratio``).
        length: length unit [m] of the moments: a typical edge.
        gyration: inertia over mass [m2], shape (n, 3, 3); by default the result of ``ball_gyration``. The inertia does
            not change the verdict.
    """
    corners = Corners(centers, weights, patches, length)
    if gyration is None:
        gyration = ball_gyration(centers, patches, length)
    piles = (
        pile_of(corners, gyration / length**2, friction, ratio, stiffness(corners))
        for stiffness, ratio in product(DISTRIBUTIONS, RATIOS)
    )
    return _agreed(load_pile(pile, corners) for pile in piles)


def _agreed(loadings: Iterator[Loading]) -> Loading:
    """Return the common verdict of all loadings; doubt if a loading is in doubt or disagrees."""
    worst = next(loadings)
    for loading in loadings:
        if worst.verdict == "doubt":
            return worst
        if loading.verdict != worst.verdict and loading.verdict != "doubt":
            why = "whether it comes to rest depends on the stiffness of its contacts"
            return Loading("doubt", why, max(worst.sag, loading.sag), max(worst.acceleration, loading.acceleration))
        if loading.verdict == "doubt" or loading.sag > worst.sag:
            worst = loading
    return worst


def load_pile(pile: CompliantPile, corners: Corners) -> Loading:
    """Load a compliant pile with kappa rising from 1, and return the verdict that its accelerations give.

    Without a verdict up to the highest kappa, or after ``MOST_FAILURES`` kappas without a solution, the pile is in
    doubt.
    """
    displacement = np.zeros(6 * corners.bodies)
    accelerations: dict[int, float] = {}
    failures = 0
    loading = Loading("doubt", "no equilibrium of its compliant contacts was found", np.inf, np.inf)
    for step in range(_LAST + 1):
        kappa = 10.0 ** (step / _DECADE)
        moved = pile.moved(displacement, kappa)
        if moved is None:
            failures += 1
            if failures == MOST_FAILURES:
                break
            continue
        displacement = moved
        accelerations[step] = acceleration = float(np.abs(displacement).max()) / kappa
        before = accelerations.get(step - 2 * _DECADE)
        if step < _FIRST or before is None:
            continue
        ratio = acceleration / before
        if ratio >= FALLS and (step == _LAST or _is_at_rest_bonded(pile, kappa)):
            return Loading("falls", f"it gives way with {acceleration:.2g} g", np.inf, acceleration)
        loading = Loading(
            "doubt", f"it does not come to rest: it gives way with {acceleration:.2g} g", np.inf, acceleration
        )
        if ratio <= STANDS and step >= _LAST - 1:
            sag = _sag(corners, pile.relative_motion(displacement), pile.relative_motion(pile.bonded(kappa)))
            is_small = sag <= MOST_SAG
            why = "" if is_small else f"a body gives {sag:.0f} times as far as with its contacts bonded"
            loading = Loading("stands" if is_small else "doubt", why, sag, acceleration)
    return loading


def _is_at_rest_bonded(pile: CompliantPile, kappa: float) -> bool:
    """Return whether the pile with bonded contacts comes to rest over the two decades up to ``kappa``."""
    before, after = (float(np.abs(pile.bonded(step)).max()) / step for step in (kappa / 100, kappa))
    return after <= STANDS * before


def _sag(corners: Corners, motion: FloatArray, bonded: FloatArray) -> float:
    """Return the greatest sag of all bodies; infinite if a body has no corner that moves with bonded contacts.

    Args:
        corners: corners of the contact patches.
        motion: relative motion at each corner, shape (p,).
        bonded: relative motion at each corner with all contacts bonded, shape (p,).
    """
    greatest = np.zeros((2, corners.bodies))
    for body in (corners.first, corners.second):
        moving = body != GROUND
        for row, values in zip(greatest, (motion, bonded), strict=True):
            np.maximum.at(row, body[moving], values[moving])
    if not greatest[1].all():
        return np.inf
    return float((greatest[0] / greatest[1]).max())
