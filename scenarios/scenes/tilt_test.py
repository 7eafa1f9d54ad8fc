"""A prebuilt stack on ground that tilts beyond the stack's limit: gravity turns, at 0.1 deg/s near the limit.

Theory, for planks of length L, width b and thickness t, with the coefficient of friction mu = 0.45 and leaning planks
at theta = 72 deg:

- Column of 10 planks, slope along the planks: the column slides at atan(mu) = 24.228 deg.
- Column of 10 planks, slope across the planks: the column tips at atan(b / 10 t) = 16.699 deg.
- V, slope along the planks: the forces at feet and ridge are statically determinate. Moments about both feet give the
  horizontal part h and the vertical part v of the ridge's force. At a slope a,
  v / h = tan(a) sin(theta) (L sin(theta) + t cos(theta)) / (cos(theta) (L cos(theta) - t sin(theta))). If the ridge's
  normal is the bisector, which is horizontal, the ridge slips at v / h = mu: 2.117 deg. If the normal is a plank's face
  normal, the ridge slips at 4.263 deg or at 0.513 deg, depending on the plank. There v / h is
  tan(atan(mu) +- (90 deg - theta)).
- V and card house of three storeys, slope across the planks: the stack tips at atan(b / 2 z), where z is the height of
  its centre of mass. The angles are 11.631 deg and 4.714 deg.
- Card house, slope along the planks: the top V slips first, at the angles of the V alone.

Look for: the onset, at which a brick has moved by 1 % of its thickness or turned by 0.5 deg. The harness measures the
angle of the onset, and the angle at which exact statics finds no equilibrium with the engine's own contact normals.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated, NamedTuple

from scenarios.model import Brick, Expectation, Place, Tilt, World
from scenarios.parameters import Choice
from scenarios.planks import LENGTH, MU, THICKNESS, WIDTH, lay
from scenarios.scenario import Plan, dynamic_scenario
from scenarios.scenes.card_house import card_house
from scenarios.scenes.leaning_pair import leaning_pair
from scenarios.scenes.shared.prebuilt import closed

THETA = 72.0
"""Angle [deg] between leaning planks and the ground."""
PLANKS = 10
"""Number of planks of the column."""
AXES = {"along": (0.0, 1.0), "across": (-1.0, 0.0)}
"""Axes of the tilt, by heading; the low end is at +x for "along", at +y for "across"."""
REST_S = 2.0
"""Time [s] for which a stack rests before the tilt."""
FAST, SLOW, LAST = 5.0, 0.1, 1.0
"""Speeds [deg/s] of the tilt:

- FAST: below the slow range;
- SLOW: in the slow range;
- LAST: above the slow range.
"""
MARGIN = 1.0
"""Reach [deg] of the slow range below the least and beyond the greatest limit."""
BEYOND = 5.0
"""Reach [deg] of the tilt beyond the slow range."""


class TiltLimits(NamedTuple):
    """The slopes [deg] at which a stack gives way."""

    exact: float
    """Slope with the bisector as the normal of a ridge."""
    least: float
    """Slope with the normal of a plank's face as the normal of a ridge, for the face with the lesser slope."""
    greatest: float
    """Slope with the normal of a plank's face as the normal of a ridge, for the face with the greater slope."""


@dynamic_scenario
def tilt_test(
    *,
    stack: Annotated[str, Choice("column", "v", "card_house")] = "column",
    heading: Annotated[str, Choice(*AXES)] = "along",
) -> Plan:
    """Build a stack on ground that tilts beyond the stack's limit.

    Args:
        stack: "column" of 10 planks, "v" of two planks, or "card_house" of three storeys.
        heading: direction in which the ground goes down: "along" or "across" the planks.
    """
    bricks = tilted_bricks(stack)
    limits = tilt_limits(stack, heading)
    slow_from, slow_to = max(0.0, limits.least - MARGIN), limits.greatest + MARGIN
    tilts: list[Tilt] = []
    time = REST_S
    for speed, degrees in ((FAST, slow_from), (SLOW, slow_to - slow_from), (LAST, BEYOND)):
        if degrees > 0:
            tilts.append(Tilt(time, AXES[heading], speed, degrees / speed))
            time += degrees / speed
    theory = f"by exact statics the stack gives way at {limits.exact:.3f} deg"
    if limits.least < limits.greatest:
        theory += f", or from {limits.least:.3f} to {limits.greatest:.3f} deg with a face as the ridge's normal"
    begins = REST_S + slow_from / FAST
    return Plan(
        world=World(friction=MU),
        actions=(Place(0.0, tuple(bricks), 0.0), *tilts),
        expectation=Expectation("fall", theory, max(brick.level for brick in bricks), not_before_s=begins),
        look_for="the angle at which the first brick moves",
        planar=heading == "along",
        watch_s=1.0,
    )


def tilted_bricks(stack: str) -> Sequence[Brick]:
    """Return the bricks of a stack "column", "v" or "card_house", with closed ridges."""
    if stack == "column":
        return [lay(0.0, level=level) for level in range(1, PLANKS + 1)]
    if stack == "v":
        return leaning_pair(theta=THETA, friction=MU).bricks
    return closed(card_house(storeys=3, theta=THETA)).bricks


def tilt_limits(stack: str, heading: str) -> TiltLimits:
    """Return the slopes [deg] at which a stack gives way: see the module docstring."""
    if heading == "across":
        bricks = tilted_bricks(stack)
        height = sum(brick.mass * brick.position[2] for brick in bricks) / sum(brick.mass for brick in bricks)
        exact = math.degrees(math.atan(WIDTH / (2 * height)))
        return TiltLimits(exact, exact, exact)
    if stack == "column":
        exact = math.degrees(math.atan(MU))
        return TiltLimits(exact, exact, exact)
    face, cone = math.radians(90.0 - THETA), math.atan(MU)
    limits = (_slope_of_ridge(slip) for slip in (MU, math.tan(cone - face), math.tan(cone + face)))
    return TiltLimits(*limits)


def _slope_of_ridge(slip: float) -> float:
    """Return the slope [deg] at which the ridge's force has the vertical part ``slip`` times its horizontal part."""
    cos, sin = math.cos(math.radians(THETA)), math.sin(math.radians(THETA))
    lever = cos * (LENGTH * cos - THICKNESS * sin) / (sin * (LENGTH * sin + THICKNESS * cos))
    return math.degrees(math.atan(slip * lever))
