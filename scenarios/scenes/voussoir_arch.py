"""A semicircular arch of voussoirs (wedge-shaped stones) on centring (a support). Then the scene removes the centring.

Theory (limit analysis, J. Heyman, "The Stone Skeleton", 1966; discrete voussoirs):

- The arch stands if a line of thrust lies inside every joint. Half of the symmetric arch has two unknowns: the
  horizontal thrust H at the crown, and its height e.
- V is the weight of all voussoirs between the crown and a joint. The force at the joint lies inside the joint if the
  moments of H and V about the joint's two ends have opposite signs. Each joint gives two linear conditions in H and
  H e. An arch with an even number of voussoirs has a joint at the crown too.
- Bisection finds the least thickness for which H and e exist: 0.1075 of the mean radius for many voussoirs, and less
  for few voussoirs.
- In an arch of many voussoirs no joint slides if the coefficient of friction exceeds 0.396. If the coefficient is below
  0.309, this arch slides at any thickness (A. Sinopoli, M. Corradi, F. Foce, "Modern formulation for preelastic
  theories on masonry arches", J. Eng. Mech. 123 (1997), 204-213).

The centring is a polyhedron, whose facets carry the voussoirs. All bodies drop together onto the ground. The scene
removes the centring before a policy can freeze the voussoirs, so that the engine, not a policy, decides whether the
arch moves.

Look for: an arch that is too thin opens hinges at the crown and at the haunches. With too little friction, voussoirs
slide at the springing (the foot of the arch).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Annotated

import numpy as np
from scipy.optimize import linprog

from scenarios.geometry import FloatArray
from scenarios.margins import by_margin
from scenarios.model import UPRIGHT, Brick, Expectation, Place, Quaternion, Remove, Vector, World
from scenarios.parameters import Friction, Margin, Real, Scale, Whole
from scenarios.planks import DENSITY
from scenarios.scenario import Plan, scenario
from scenarios.solids import polyhedron

RADIUS = 0.3
"""Mean radius [m] of the arch at scale 1."""
DEPTH = 0.1
"""Depth of the arch [m] across its plane, at scale 1."""
REMOVED_S = 0.1
"""Time [s] at which the scene removes the centring: 0.09 s after the bodies have landed, and one frame before a policy
that waits for 0.1 s of rest can freeze a voussoir."""
NO_SLIDING = 0.4
"""Coefficient of friction from which no joint slides: 0.396 suffices for many voussoirs."""
SLIDES = 0.25
"""Coefficient of friction below which an arch slides at any thickness. The value is less than 0.309, because arches may
have few voussoirs."""
THICKEST = 0.5
"""Greatest thickness in which the search for the limit begins, in mean radii."""


@scenario
def voussoir_arch(
    *,
    voussoirs: Annotated[int, Whole(3, 61)] = 9,
    margin: Margin = 0.25,
    friction: Friction = 0.6,
    scale: Scale = 10.0,
    thickness: Annotated[float, Real(0, THICKEST)] = 0.0,
) -> Plan:
    """Build a semicircular arch of voussoirs on centring, then remove the centring.

    Args:
        voussoirs: number of voussoirs.
        margin: share by which the thickness exceeds the least thickness; negative if the arch is thinner.
        friction: Coulomb coefficient of every pair. From 0.25 to below 0.4 the scene has no known answer.
        scale: factor on all lengths; the mean radius is 0.3 m at scale 1. At scale 1 an engine's tolerances of 0.1 mm
            can decide the outcome, because they are a hundredth of the thickness that a joint can lose.
        thickness: thickness over the mean radius, in place of ``margin``; 0 for the thickness with this margin.
    """
    least = least_thickness(voussoirs)
    partner = None if thickness else {"margin": abs(margin), "friction": friction if friction >= NO_SLIDING else 0.6}
    if thickness:
        margin = thickness / least - 1
    else:
        thickness = (1 + margin) * least
    bricks = (_centring(voussoirs, thickness, scale), *_stones(voussoirs, thickness, scale))
    top = max(brick.level for brick in bricks)
    if friction < SLIDES:
        expectation = Expectation("fall", f"voussoirs slide below mu = {SLIDES:g}", top, REMOVED_S)
    elif friction < NO_SLIDING:
        expectation = Expectation("study", "the closed form assumes that no joint slides")
    else:
        limit = f"t / R = {least:.4f}, the least thickness with a line of thrust inside all joints"
        expectation = by_margin(margin, limit, falls_at=top, not_before_s=REMOVED_S)
    return Plan(
        world=World(friction=friction),
        actions=(Place(0.0, bricks), Remove(REMOVED_S, 0)),
        expectation=expectation,
        look_for="hinges at the crown and the haunches, or voussoirs that slide, once the centring is gone",
        partner=partner,
        planar=True,
    )


@lru_cache(maxsize=64)
def least_thickness(voussoirs: int) -> float:
    """Return the least thickness with which a semicircular arch stands, over the mean radius, to within 1e-9."""
    low, high = 0.0, THICKEST
    while high - low > 1e-9:
        middle = (low + high) / 2
        low, high = (low, middle) if _has_thrust_line(voussoirs, middle) else (middle, high)
    return high


def _has_thrust_line(voussoirs: int, thickness: float) -> bool:
    """Return whether a line of thrust fits into all joints of an arch of mean radius 1."""
    rows, bounds = [], []
    weight = moment = 0.0
    joints = _joints(voussoirs)
    half = [angle for angle in joints if angle <= math.pi / 2 + 1e-12][::-1]  # from the crown to the springing
    upper = math.pi / 2
    for angle in half:
        if upper - angle > 1e-12:
            area, x = _sector(angle, upper, thickness, is_cut=voussoirs % 2 == 1 and upper == math.pi / 2)
            weight, moment = weight + area, moment + area * x
        # About a joint's end (x, z) the thrust and the weights have the moment H (e - z) - (weight x - moment): not
        # negative at the intrados, and not positive at the extrados.
        for radius, sign in ((1 - thickness / 2, -1.0), (1 + thickness / 2, 1.0)):
            x, z = radius * math.cos(angle), radius * math.sin(angle)
            rows.append([sign * -z, sign])
            bounds.append(sign * (weight * x - moment))
        upper = angle
    found = linprog([0.0, 0.0], A_ub=rows, b_ub=bounds, bounds=[(0, None), (None, None)], method="highs")
    return bool(found.status == 0)


def _joints(voussoirs: int) -> FloatArray:
    """Return the angles [rad] of all joints, from the right springing to the left springing."""
    return np.linspace(0.0, math.pi, voussoirs + 1)


def _sector(low: float, high: float, thickness: float, *, is_cut: bool) -> tuple[float, float]:
    """Return area and centroid x of the section of the voussoir between two angles, for an arch of mean radius 1.

    With ``is_cut`` the function returns the values of the half to the right of the crown. The section is a trapezoid,
    because the faces of a voussoir are flat.
    """
    inner, outer = 1 - thickness / 2, 1 + thickness / 2
    corners = [(inner, low), (outer, low), (outer, high), (inner, high)]
    x, z = np.array([(radius * math.cos(angle), radius * math.sin(angle)) for radius, angle in corners]).T
    if is_cut:  # the upper half of the keystone ends in the plane x = 0, where its faces are level
        x[2:], z[2:] = 0.0, z[[1, 0]]
    step_x, step_z = np.roll(x, -1), np.roll(z, -1)
    cross = x * step_z - step_x * z
    area = float(cross.sum() / 2)
    return area, float(((x + step_x) * cross).sum() / 6 / area)


def _stones(voussoirs: int, thickness: float, scale: float) -> tuple[Brick, ...]:
    """Return the voussoirs from the right to the left springing; levels count from the nearer springing."""
    radius, depth = RADIUS * scale, DEPTH * scale
    half = math.pi / voussoirs / 2
    inner, outer = (radius * (1 + side * thickness / 2) for side in (-1, 1))
    section = [(side * r * math.sin(half), r * math.cos(half)) for r in (inner, outer) for side in (-1, 1)]
    corners = [(x, y, z) for x, z in section for y in (-depth / 2, depth / 2)]
    stones = []
    for index in range(voussoirs):
        turn = math.pi / 2 - (2 * index + 1) * half  # from the crown toward +x
        level = 1 + min(index, voussoirs - 1 - index)
        quaternion = (math.cos(turn / 2), 0.0, math.sin(turn / 2), 0.0)
        stones.append(_in_plane(corners, quaternion, level))
    return tuple(stones)


def _centring(voussoirs: int, thickness: float, scale: float) -> Brick:
    """Return the centring: a polyhedron on the ground, with the voussoirs' lower faces as facets."""
    radius, depth = RADIUS * scale * (1 - thickness / 2), DEPTH * scale
    corners = [
        (radius * math.cos(angle), y, radius * math.sin(angle))
        for angle in _joints(voussoirs)
        for y in (-depth / 2, depth / 2)
    ]
    return _in_plane(corners, UPRIGHT, level=1)


def _in_plane(corners: Sequence[Vector], quaternion: Quaternion, level: int) -> Brick:
    """Return the convex hull of corners as a brick, with its centre of mass exactly in the plane of the arch."""
    stone = polyhedron(corners, position=(0.0, 0.0, 0.0), quaternion=quaternion, density=DENSITY, level=level)
    x, _, z = stone.position
    return replace(stone, position=(x, 0.0, z))
