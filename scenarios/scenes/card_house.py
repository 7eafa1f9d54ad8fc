"""The paper's card house: planks leaning in pairs (inverted Vs), storeys divided by flat planks.

One storey is a single V. A house of n storeys has n Vs side by side on the ground, n - 1 above and so on; between the
storeys a roof plank bridges each pair of neighbouring ridges. Levels count Vs and roofs in turn, so n storeys make
2 n - 1 levels; the top has no roof. All planks lie in the x-z plane.

Layout. The ridges of a storey are so far apart that a roof plank covers both and overhangs by ``OVERHANG``. Over three
ridges two roof planks must meet above the middle ridge, each on its own side of that ridge, so the layout moves these
planks outward until they leave the usual gap between them. Upper Vs stand centred between the ridges below. Over four
and more ridges whole planks do not fit, so the planks between the outermost two are shortened to leave the usual gap.

Theory. A plank of weight w that leans at theta from the ground and carries P at its top is pushed sideways at the
ridge with H = (w / 2 + P) (cot theta - t / L) (L, t: length and thickness), while its foot carries w + P.

- If the ridge's normal is horizontal, only the foot needs friction: mu >= H / (w + P). The limit grows with the load,
  from (cot theta - t / L) / 2 for a V alone toward cot theta - t / L. Exact statics at 72 deg, where roofs hold the
  ridges together by their friction: 0.129, 0.183 and 0.208 for one, two and three storeys.
- Two edges meet at the ridge, and most engines report a plank's face as the normal there (not Jolt and Havok, whose
  normal is horizontal). The same horizontal force then leans 90 deg - theta from the normal: mu >= cot theta, which
  requires more friction, at any load: 0.325 at 72 deg.

So a house stands if mu >= cot theta, and its first V falls if mu < (cot theta - t / L) / 2; in between the ridge's
normal decides, and the scene is a study.

Both sides of a storey are placed together, because a plank that loads only one half of a V needs a vertical force at
its ridge, where theory has no single answer. The planks of a V keep a gap of ``RIDGE_GAP``, so that rounding cannot
make them overlap.

Look for: feet that creep apart, and a ridge that drops. A V that stands with mu below its limit is a false stand.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated

from scenarios.model import Brick, Expectation, World
from scenarios.parameters import Friction, Gap, Real, Whole
from scenarios.planks import LENGTH, MU, THICKNESS, lay, lean, one_a_second
from scenarios.scenario import Plan, scenario

RIDGE_GAP = 0.2e-3
"""Gap [m] between the two planks of a V at its ridge."""
OVERHANG = 2.5e-3
"""Overhang [m] of a roof plank beyond the outermost edges that carry it, which exceeds the largest placement error."""
MIN_FACTOR = 1.05
"""Least ratio of the friction to its limit, or of the limit to the friction, at which the answer holds under placement
noise."""


@scenario
def card_house(
    *,
    storeys: Annotated[int, Whole(1, 10)] = 1,
    theta: Annotated[float, Real(45, 85)] = 72.0,
    friction: Friction = MU,
    gap: Gap = 2.0,
) -> Plan:
    """Build leaning pairs of planks under flat roofs; one storey is the inverted V.

    Args:
        storeys: number of storeys, and of Vs on the ground.
        theta: angle [deg] between a leaning plank and the ground.
        friction: Coulomb coefficient of every pair.
        gap: distance between roof planks [mm], and least distance between the feet of two Vs; at 0 roof planks touch.
    """
    angle = math.radians(theta)
    return Plan(
        world=World(friction=friction),
        actions=one_a_second(_groups(storeys, angle, gap * 1e-3)),
        expectation=expected(angle, friction),
        look_for="feet that creep apart and a ridge that drops; a house that stands below its limit is a false stand",
        partner={"friction": MU},
        planar=True,
    )


def expected(theta: float, friction: float) -> Expectation:
    """Return the expectation for a house of planks that lean at ``theta`` [rad] from the ground."""
    most = 1 / math.tan(theta)
    least = (most - THICKNESS / LENGTH) / 2
    if friction >= MIN_FACTOR * most:
        return Expectation(
            "stand", f"mu = {friction:g} exceeds cot(theta) = {most:.3f}, enough for either ridge normal"
        )
    if friction * MIN_FACTOR <= least:
        return Expectation("fall", f"mu = {friction:g} is below (cot(theta) - t/L)/2 = {least:.3f}: the feet slip", 1)
    return Expectation("study", f"between mu = {least:.3f} and {most:.3f} the ridge's contact normal decides")


def _groups(storeys: int, theta: float, gap: float) -> list[Sequence[Brick]]:
    """Return the groups in order of placement: single Vs on the ground, then whole roofs and whole storeys in turn."""
    spread, edge = _half_foot_spread(theta), THICKNESS * math.sin(theta)
    spacing = LENGTH - 2 * (edge + RIDGE_GAP / 2 + OVERHANG)
    if storeys > 1 and spacing < 2 * (spread + edge) + gap:
        raise ValueError(
            f"theta must be at least 70 deg for more than one storey, got {math.degrees(theta):g}, because Vs that "
            "lean further collide before a roof plank reaches two ridges; use a larger theta, or storeys = 1"
        )
    height = LENGTH * math.sin(theta) + THICKNESS * math.cos(theta)
    groups: list[Sequence[Brick]] = []
    for storey in range(storeys):
        level, bottom, ridges = 2 * storey + 1, storey * (height + THICKNESS), storeys - storey
        pairs = [_inverted_v(x, theta, level, bottom) for x in _row(ridges, spacing)]
        groups.extend(pairs if storey == 0 else [[plank for pair in pairs for plank in pair]])
        if ridges > 1:
            groups.append(_roofs(ridges, spacing, level + 1, bottom + height, gap))
    return groups


def _roofs(ridges: int, spacing: float, level: int, bottom: float, gap: float) -> list[Brick]:
    """Return the planks across each pair of neighbouring ridges; only the outermost planks are whole."""
    middles, sawn = _row(ridges - 1, spacing), spacing - gap
    if ridges == 2:
        return [lay(0.0, level=level, bottom=bottom)]
    outward = (LENGTH - sawn) / 2
    return [
        lay(middles[0] - outward, level=level, bottom=bottom),
        *(lay(x, level=level, bottom=bottom, length=sawn) for x in middles[1:-1]),
        lay(middles[-1] + outward, level=level, bottom=bottom),
    ]


def _half_foot_spread(theta: float) -> float:
    """Return the distance [m] along x from a V's middle to the edges on which it stands."""
    return LENGTH * math.cos(theta) + RIDGE_GAP / 2


def _inverted_v(x: float, theta: float, level: int, bottom: float) -> list[Brick]:
    """Return two planks that lean against each other over ``x``."""
    spread = _half_foot_spread(theta)
    return [
        lean(x - spread, theta=theta, toward=1, level=level, bottom=bottom),
        lean(x + spread, theta=theta, toward=-1, level=level, bottom=bottom),
    ]


def _row(count: int, pitch: float) -> list[float]:
    """Return ``count`` positions [m] at a distance of ``pitch`` [m], symmetric about 0."""
    return [(index - (count - 1) / 2) * pitch for index in range(count)]
