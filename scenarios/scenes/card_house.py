"""The paper's card house: planks leaning in pairs (inverted Vs), storeys divided by flat planks.

A house of one storey is a single V. A house of n storeys has n Vs side by side on the ground, n - 1 Vs above, and so
on. Between the storeys a roof plank bridges each pair of neighbouring ridges. The top has no roof. Levels count Vs and
roofs in turn: n storeys make 2 n - 1 levels. All planks lie in the x-z plane.

Layout:

- Two ridges: a roof plank covers both ridges and overhangs each ridge by ``OVERHANG``.
- Three ridges: two roof planks meet above the middle ridge. The layout moves both planks outward until the usual gap is
  between them.
- Four ridges and more: whole planks do not fit. The layout shortens all planks except the two outermost planks, and
  leaves the usual gaps.
- Upper Vs stand in the middle between the ridges below.

Theory: a plank of weight w, length L and thickness t leans at theta from the ground, and carries the load P at its top.
The plank's foot carries w + P. The force at the ridge has the horizontal part

    H = (w / 2 + P) (cot theta - t / L)

- If the ridge's normal is horizontal, only the foot needs friction: the coefficient mu must be at least H / (w + P).
  This limit grows with the load, from (cot theta - t / L) / 2 for a V alone toward cot theta - t / L. Exact statics at
  72 deg gives 0.129, 0.183 and 0.208 for one, two and three storeys, because the friction of the roofs helps to hold
  the ridges.
- Most engines report a plank's face normal at the ridge, because two edges meet there. The normal of Jolt and Havok is
  horizontal. With a face normal the force H leans 90 deg - theta from the normal. The ridge then needs more friction,
  at any load: mu >= cot theta, which is 0.325 at 72 deg.

Therefore a house stands if mu >= cot theta, and its first V falls if mu < (cot theta - t / L) / 2. Between both limits
the ridge's normal decides, and the scene is a study.

The parameter ``slenderness`` makes cards of the planks: as long and as wide as planks, but thinner, of the same wood.
Houses of cards stand at flatter angles, because thinner cards leave more room between neighbouring Vs. Thin boxes test
contact detectors. Published card houses have a slenderness of 88 (65 deg, mu = 0.8) and 200 (mu = 0.7).

The scene places both sides of a storey together. A plank on only one half of a V would need a vertical force at the
ridge, and theory does not determine this force. The planks of a V keep a gap of ``RIDGE_GAP``, so that rounding cannot
make the planks overlap.

Look for: feet that creep apart, and a ridge that drops. A V that stands with less friction than its limit is a false
stand.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import partial
from typing import Annotated, NamedTuple

from scenarios.model import Brick, Expectation, World
from scenarios.parameters import Friction, Gap, Real, Whole
from scenarios.planks import LENGTH, MU, THICKNESS, lay, lean, one_a_second
from scenarios.scenario import Plan, scenario

PLANK = LENGTH / THICKNESS
"""Length over thickness of a plank."""
RIDGE_GAP = 0.2e-3
"""Gap [m] between the two planks of a V at its ridge; between thinner cards the gap shrinks in proportion."""
OVERHANG = 2.5e-3
"""Overhang [m] of a roof plank beyond the outermost edges that carry it, which exceeds the largest placement error."""
MIN_FACTOR = 1.05
"""Least ratio of the friction to its limit, or of the limit to the friction, at which the answer holds under placement
noise."""


class Card(NamedTuple):
    """A leaning card of a V."""

    theta: float
    """Angle [rad] from the ground."""
    thickness: float
    """Thickness [m]."""

    @property
    def ridge_gap(self) -> float:
        """Return the gap [m] between the two cards of a V at its ridge."""
        return RIDGE_GAP * (self.thickness / THICKNESS)

    @property
    def edge(self) -> float:
        """Return the width [m] along x of the upper short edge."""
        return self.thickness * math.sin(self.theta)

    @property
    def height(self) -> float:
        """Return the height [m] of a V."""
        return LENGTH * math.sin(self.theta) + self.thickness * math.cos(self.theta)

    @property
    def spread(self) -> float:
        """Return the distance [m] along x from a V's middle to the edges on which the V stands."""
        return LENGTH * math.cos(self.theta) + self.ridge_gap / 2


@scenario
def card_house(
    *,
    storeys: Annotated[int, Whole(1, 10)] = 1,
    theta: Annotated[float, Real(45, 85, "deg")] = 72.0,
    friction: Friction = MU,
    gap: Gap = 2.0,
    slenderness: Annotated[float, Real(PLANK, 200)] = PLANK,
) -> Plan:
    """Build leaning pairs of planks (inverted Vs) under flat roofs.

    Args:
        storeys: number of storeys, and of Vs on the ground.
        theta: angle [deg] between a leaning plank and the ground.
        friction: Coulomb coefficient of every pair.
        gap: distance between roof planks [mm], and least distance between the feet of two Vs; 0 lets roof planks touch.
        slenderness: length of a plank over its thickness.

    Raises:
        ValueError: if neighbouring Vs collide, because the planks lean too flat.
    """
    angle = math.radians(theta)
    return Plan(
        world=World(friction=friction),
        actions=one_a_second(_groups(storeys, Card(angle, LENGTH / slenderness), gap * 1e-3)),
        expectation=expected(angle, friction, slenderness),
        look_for="feet that creep apart and a ridge that drops; a house that stands below its limit is a false stand",
        partner={"friction": MU},
        planar=True,
    )


def expected(theta: float, friction: float, slenderness: float = PLANK) -> Expectation:
    """Return the expectation for a house of planks that lean at ``theta`` [rad] from the ground."""
    most = 1 / math.tan(theta)
    least = (most - 1 / slenderness) / 2
    if friction >= MIN_FACTOR * most:
        return Expectation(
            "stand", f"mu = {friction:g} exceeds cot(theta) = {most:.3f}, enough for either ridge normal"
        )
    if friction * MIN_FACTOR <= least:
        return Expectation("fall", f"mu = {friction:g} is below (cot(theta) - t/L)/2 = {least:.3f}: the feet slip", 1)
    return Expectation("study", f"between mu = {least:.3f} and {most:.3f} the ridge's contact normal decides")


def _groups(storeys: int, card: Card, gap: float) -> list[Sequence[Brick]]:
    """Return the groups of planks in order of placement: each V on the ground, then roofs and storeys in turn.

    Raises:
        ValueError: if neighbouring Vs collide, because the planks lean too flat.
    """
    spacing = LENGTH - 2 * (card.edge + card.ridge_gap / 2 + OVERHANG)
    if storeys > 1 and spacing < 2 * (card.spread + card.edge) + gap:
        raise ValueError(
            f"theta is too flat for more than one storey, got {math.degrees(card.theta):g} deg with a gap of "
            f"{gap * 1e3:g} mm, because neighbouring Vs collide before a roof plank reaches two ridges: use a greater "
            "theta, a smaller gap, a greater slenderness, or storeys = 1"
        )
    groups: list[Sequence[Brick]] = []
    for storey in range(storeys):
        level, bottom, ridges = 2 * storey + 1, storey * (card.height + card.thickness), storeys - storey
        pairs = [_inverted_v(x, card, level, bottom) for x in _row(ridges, spacing)]
        groups.extend(pairs if storey == 0 else [[plank for pair in pairs for plank in pair]])
        if ridges > 1:
            roof = partial(lay, level=level + 1, bottom=bottom + card.height, thickness=card.thickness)
            groups.append(_roofs(ridges, spacing, roof, gap))
    return groups


def _roofs(ridges: int, spacing: float, roof: Callable[..., Brick], gap: float) -> list[Brick]:
    """Return the roof planks across each pair of neighbouring ridges.

    Args:
        ridges: number of ridges.
        spacing: distance [m] between neighbouring ridges.
        roof: function that returns a roof plank at x [m] with a ``length`` [m].
        gap: distance [m] between roof planks.
    """
    middles, sawn = _row(ridges - 1, spacing), spacing - gap
    if ridges == 2:
        return [roof(0.0)]
    outward = (LENGTH - sawn) / 2
    return [
        roof(middles[0] - outward),
        *(roof(x, length=sawn) for x in middles[1:-1]),
        roof(middles[-1] + outward),
    ]


def _inverted_v(x: float, card: Card, level: int, bottom: float) -> list[Brick]:
    """Return two planks that lean against each other, with the ridge at ``x`` [m]."""
    leaning = partial(lean, theta=card.theta, level=level, bottom=bottom, thickness=card.thickness)
    return [leaning(x - card.spread, toward=1), leaning(x + card.spread, toward=-1)]


def _row(count: int, pitch: float) -> list[float]:
    """Return ``count`` positions [m], symmetric about 0, with the distance ``pitch`` [m] between neighbours."""
    return [(index - (count - 1) / 2) * pitch for index in range(count)]
