"""Ask two criteria about a pile: a pair of scenes enters the study ``truth`` only where they agree.

The first is ``truth.equilibrium``. What it calls stable must also come to rest when it is loaded from zero, whatever
decided, and a second criterion must confirm it, the first of these that can:

1. ``normal forces`` alone hold it, which excludes every other solution (proof in ``force_balance``);
2. ``strong stability``: rest is the only solution of rigid bodies (``strong_stability``, small piles);
3. ``other stiffness``: it comes to rest with each of ``DRAWS`` random stiffnesses, too, each corner up to three times
   softer or stiffer. It is the weakest of the three, for piles that are too large for the second.

What it calls unstable has no forces that hold it; loaded from zero it must fall.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from scenarios.compliant_contacts import pile_of, stiffness_by_weight
from scenarios.contact_patch import Patch, Ridge, contact_patches
from scenarios.contact_wrenches import Corners
from scenarios.force_balance import Verdict
from scenarios.geometry import Boxes, FloatArray
from scenarios.loading import load_from_zero, load_pile
from scenarios.model import Brick, World
from scenarios.strong_stability import strong_stability
from scenarios.truth import judge

DRAWS = 5
"""Random stiffnesses."""
SPREAD = 3.0
"""Factor by which a corner may be softer or stiffer."""
MOST_CHOICES = 40
"""Binary variables up to which strong stability is asked for: about three seconds."""


@dataclass(frozen=True, slots=True)
class Agreement:
    """What two criteria say."""

    verdict: Verdict
    """``doubt`` where they disagree, or one of them is in doubt."""
    first: str
    """The criterion by which the judge decided."""
    second: str
    """The criterion that confirms or contradicts it."""
    why: str
    """The reason of a doubt, in words; else empty."""


def agreed_verdict(bricks: Sequence[Brick], world: World, *, ridge: Ridge = "bisector") -> Agreement:
    """Return on what the judge and a second criterion agree about bricks in their planned poses.

    Args:
        bricks: at least one; they must touch, not overlap.
        world: friction and gravity.
        ridge: the normal where two parallel edges meet (see ``contact_patch``).
    """
    centers = np.array([brick.position for brick in bricks], np.float64)
    weights = np.outer([brick.mass for brick in bricks], world.gravity)
    length = float(np.mean([max(brick.size) for brick in bricks]))
    patches, gyration = contact_patches(bricks, ridge=ridge), Boxes.of(bricks).gyration
    statics = judge(centers, weights, patches, world.friction, length, gyration=gyration)
    if statics.verdict == "doubt":
        return Agreement("doubt", statics.by, "", statics.why)
    loading = load_from_zero(centers, weights, patches, world.friction, length, gyration=gyration)
    if loading.verdict != {"stable": "stands", "unstable": "falls"}[statics.verdict]:
        return Agreement("doubt", statics.by, "loading", loading.why or "it comes to rest when loaded from zero")
    if statics.verdict == "unstable":
        return Agreement("unstable", statics.by, "loading", "")
    if statics.frictionless:
        return Agreement("stable", "loading", "normal forces", "")
    strength = strong_stability(
        centers, weights, patches, world.friction, length, gyration=gyration, most_choices=MOST_CHOICES
    )
    if strength.verdict == "strong":
        return Agreement("stable", statics.by, "strong stability", "")
    if strength.verdict == "weak":
        return Agreement("doubt", statics.by, "strong stability", f"it may also fall with {strength.fall:.2g} g")
    why = _with_other_stiffness(centers, weights, patches, world.friction, length, gyration)
    return Agreement("doubt" if why else "stable", statics.by, "other stiffness", why)


def _with_other_stiffness(
    centers: FloatArray,
    weights: FloatArray,
    patches: Sequence[Patch],
    friction: float,
    length: float,
    gyration: FloatArray,
) -> str:
    """Return why the pile does not stand with a random stiffness; empty if it does with all."""
    corners = Corners(centers, weights, patches, length)
    for draw in range(DRAWS):
        random = np.random.default_rng([draw, len(corners.points)])
        ratio = 10.0 ** random.uniform(-1, 1)
        stiffness = stiffness_by_weight(corners) * SPREAD ** random.uniform(-1, 1, len(corners.points))
        loading = load_pile(pile_of(corners, gyration / length**2, friction, ratio, stiffness), corners)
        if loading.verdict != "stands":
            return loading.why
    return ""
