"""Two criteria on a stack. A pair of scenes enters the study ``truth`` only if both criteria agree.

The first criterion is loading from zero (``loading``). If a stack comes to rest in this loading, the judge (``truth``)
must call the stack stable. The first applicable criterion of this list must confirm the verdict:

1. ``normal forces``: normal forces alone hold the stack. Then rest is the only solution (proof in ``force_balance``).
2. ``strong stability``: rest is the only solution of rigid bodies (``strong_stability``, for small piles).
3. ``other stiffness``: the stack comes to rest with ``DRAWS`` draws of random stiffness too, with each corner up to
   three times softer or stiffer. This criterion is the weakest, and serves piles too large for the second criterion.

If a stack falls in the loading, the judge must not call the stack stable. The first applicable criterion of this list
must confirm the fall:

1. ``cone``: a proof shows that no forces hold the stack.
2. ``strong stability``: rigid bodies may take an acceleration other than zero.
3. ``load-bearing contacts``: no forces at contacts whose cones contain the vertical hold the stack.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from scenarios.geometry import FloatArray
from scenarios.model import Brick, World
from scenarios.statics.compliant_contacts import pile_of, stiffness_by_weight
from scenarios.statics.contact_patch import Ridge, contact_patches
from scenarios.statics.contact_wrenches import Corners
from scenarios.statics.force_balance import solve_balance
from scenarios.statics.loading import Answer, load_from_zero, load_pile
from scenarios.statics.pile import Pile, gyration_of, pile_of_bricks
from scenarios.statics.strong_stability import strong_stability
from scenarios.statics.truth import judge

DRAWS = 5
"""Number of random draws of the stiffness of all corners."""
SPREAD = 3.0
"""Greatest factor by which a corner is softer or stiffer in a random draw."""
MOST_CHOICES = 40
"""Greatest number of binary variables up to which the module computes strong stability, which takes about 3 s."""


@dataclass(frozen=True, slots=True)
class Agreement:
    """The common verdict of two criteria."""

    verdict: Answer
    """The common verdict; ``doubt`` if the criteria disagree, or if either criterion is in doubt."""
    second: str
    """The criterion that confirms or contradicts loading."""
    why: str
    """Reason of a doubt, in words; empty without doubt."""


def agreed_verdict(bricks: Sequence[Brick], world: World, *, ridge: Ridge = "bisector") -> Agreement:
    """Return the common verdict of loading and a second criterion on bricks in their planned poses; else doubt.

    Args:
        bricks: at least one brick; bricks may touch, but must not overlap.
        world: friction, gravity and fixed bodies.
        ridge: the normal where two parallel edges meet (see ``contact_patch``).

    Raises:
        ValueError: if bricks overlap.
    """
    pile = pile_of_bricks(bricks, contact_patches(bricks, world.fixed, ridge=ridge), world)
    gyration = gyration_of(bricks)
    loading = load_from_zero(*pile, gyration=gyration)
    statics = judge(*pile, gyration=gyration, loading=loading)
    if loading.verdict == "doubt":
        return Agreement("doubt", "", loading.why)
    if loading.verdict == "falls":
        if statics.verdict == "stable":
            return Agreement("doubt", statics.by, f"stable for the judge by {statics.by}, but falls when loaded")
        return _why_it_falls(pile, gyration, is_proven=statics.verdict == "unstable")
    if statics.verdict != "stable":
        return Agreement("doubt", statics.by, statics.why or "comes to rest when loaded, but no forces hold it")
    return _why_it_stands(pile, gyration, is_proven=statics.frictionless)


def _why_it_stands(pile: Pile, gyration: FloatArray, *, is_proven: bool) -> Agreement:
    if is_proven:
        return Agreement("stands", "normal forces", "")
    strength = strong_stability(*pile, gyration=gyration, most_choices=MOST_CHOICES)
    if strength.verdict == "strong":
        return Agreement("stands", "strong stability", "")
    if strength.verdict == "weak":
        return Agreement("doubt", "strong stability", f"it may also fall with {strength.fall:.2g} g")
    corners = Corners(pile.centers, pile.weights, pile.patches, pile.length)
    for draw in range(DRAWS):
        random = np.random.default_rng([draw, len(corners.points)])
        ratio = 10.0 ** random.uniform(-1, 1)
        stiffness = stiffness_by_weight(corners) * SPREAD ** random.uniform(-1, 1, len(corners.points))
        loading = load_pile(pile_of(corners, gyration / pile.length**2, pile.friction, ratio, stiffness), corners)
        if loading.verdict != "stands":
            return Agreement("doubt", "other stiffness", loading.why)
    return Agreement("stands", "other stiffness", "")


def _why_it_falls(pile: Pile, gyration: FloatArray, *, is_proven: bool) -> Agreement:
    if is_proven:
        return Agreement("falls", "cone", "")
    strength = strong_stability(*pile, gyration=gyration, most_choices=MOST_CHOICES)
    if strength.verdict == "weak":
        return Agreement("falls", "strong stability", "")
    if strength.verdict == "strong":
        return Agreement("doubt", "strong stability", "rest is the only solution of rigid bodies")
    down = pile.weights.sum(axis=0) / np.linalg.norm(pile.weights.sum(axis=0))
    steepest = 1 / np.hypot(1.0, pile.friction)
    load_bearing = [patch for patch in pile.patches if abs(patch.normal @ down) >= steepest]
    if solve_balance(*pile._replace(patches=load_bearing)).balanced is False:
        return Agreement("falls", "load-bearing contacts", "")
    return Agreement("doubt", "load-bearing contacts", "load-bearing contacts alone could hold it")
