"""A bar, a wedge or a cylinder in a tilted V-groove, whose two sides never move.

Theory: a body of weight W lies in a groove. The groove tilts by t along its length, and its sides rise at the angle
a = 45 deg, because the bar's section is square. A wedge is half a bar, with its edge below.

- Across the groove the two normal forces N balance the weight's component normal to the groove's length:
  2 N cos(a) = W cos(t).
- Along the groove friction, with the coefficient mu, must balance the weight's component along the groove:
  2 mu N >= W sin(t).
- Therefore the body stands if mu >= k = tan(t) cos(a). The groove makes friction 1 / cos(a) = 1.41 times as strong.
- Friction across the groove may keep a body wedged after a force has pressed the body into the groove, and adds to N.
  At best this wedging lowers the limit to k / sqrt(1 + k^2 tan(a)^2), by 3 % here. Below this lower limit no forces
  hold the body.

Some engines replace the friction cone by a box: DART for every body, Bullet and PhysX for a bar at rest. If no axis of
the box points down the slope of a side, friction is up to sqrt(2) times as strong. Therefore the default margin is
0.35: within 29 % beyond the limit the outcome depends on an engine's law of friction.

Look for: the normals of the two contacts with fixed boxes differ by a right angle. A rule that merges both contacts
into one contact treats the groove as a flat floor. Then the bar slides or stands at the wrong tilt.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Annotated

import numpy as np

from scenarios.geometry import FloatArray, rotation
from scenarios.margins import by_margin
from scenarios.model import Brick, Quaternion, Vector, World
from scenarios.parameters import Choice, Margin, Real
from scenarios.planks import DENSITY, one_a_second
from scenarios.scenario import Plan, scenario
from scenarios.solids import cylinder, polyhedron

RISE = math.radians(45)
"""Angle [rad] between each side of the level groove and the horizontal."""
BAR: Vector = (0.10, 0.025, 0.025)
"""Edges of the bar [m]."""
SIDE: Vector = (0.60, 0.04, 0.02)
"""Edges of a side of the groove [m]; the second edge is across the groove."""
RELIEF = 0.005
"""Distance [m] of the groove's sides from its deepest line, which leaves the bar's lower edge free."""
ABOVE = 0.05
"""Height of the lower end of the groove's deepest line above the ground [m]."""
LIES_AT = 0.40
"""Distance of the bar's middle from the groove's lower end, along the groove [m]."""


@scenario
def groove(
    *,
    tilt: Annotated[float, Real(5, 40, "deg")] = 20.0,
    margin: Margin = 0.35,
    body: Annotated[str, Choice("bar", "wedge", "cylinder")] = "bar",
) -> Plan:
    """Build a bar, a wedge or a cylinder in a tilted V-groove.

    Args:
        tilt: angle [deg] of the groove's length to the ground.
        margin: share by which the friction exceeds its limit; if negative, share by which the friction is less than the
            limit of a wedged body.
        body: "bar" of square section, "wedge" with its edge below, or "cylinder" along the groove.
    """
    angle = math.radians(tilt)
    limit = math.tan(angle) * math.cos(RISE)
    if margin < 0:
        limit /= math.hypot(1.0, limit * math.tan(RISE))
    sides = tuple(_along_groove(angle, SIDE, SIDE[0] / 2, side, _beside(side)) for side in (-1, 1))
    return Plan(
        world=World(friction=(1 + margin) * limit, fixed=sides),
        actions=one_a_second([[_body(body, angle)]]),
        expectation=by_margin(margin, f"mu = {limit:.3f}, by the forces on both sides", falls_at=1),
        look_for="a body that slides where the groove's wedge must hold it, or sticks where it must slide",
        partner={"margin": abs(margin)},
    )


def _beside(side: int) -> FloatArray:
    """Return the vector [m] from the deepest line of the level groove to the middle of one side, shape (3,).

    ``side`` is 1 for the side at +y, and -1 for the side at -y.
    """
    across = np.array([0.0, side * math.cos(RISE), math.sin(RISE)])
    inward = np.array([0.0, -side * math.sin(RISE), math.cos(RISE)])
    middle: FloatArray = (RELIEF + SIDE[1] / 2) * across - SIDE[2] / 2 * inward
    return middle


def _body(body: str, tilt: float) -> Brick:
    """Return the body in a groove with the angle ``tilt`` [rad]; the body touches both sides."""
    bar = _along_groove(tilt, BAR, LIES_AT, 1, np.array([0.0, 0.0, BAR[1] * math.sqrt(0.5)]))
    lift: Quaternion = (math.cos(tilt / 2), 0.0, -math.sin(tilt / 2), 0.0)
    if body == "wedge":
        length, half = BAR[0] / 2, BAR[1] * math.sqrt(0.5)
        corners = [(x, y, z) for x in (-length, length) for y, z in ((0.0, 0.0), (half, half), (-half, half))]
        edge = rotation(np.array([lift]))[0] @ (LIES_AT, 0.0, 0.0) + (0.0, 0.0, ABOVE)
        return polyhedron(corners, position=_vector(edge), quaternion=lift, density=DENSITY)
    if body == "cylinder":
        half = (tilt + math.pi / 2) / 2  # the axis z turns to the groove's length
        along: Quaternion = (math.sin(half), 0.0, math.cos(half), 0.0)
        rod = cylinder(BAR[1] / 2, BAR[0], position=bar.position, density=DENSITY)
        return replace(rod, quaternion=along)
    return bar


def _vector(numbers: FloatArray) -> Vector:
    x, y, z = numbers.tolist()
    return x, y, z


def _along_groove(tilt: float, size: Vector, along: float, side: int, off_line: FloatArray) -> Brick:
    """Return a box that has turned about the groove's length by ``RISE``, and then tilts with the groove by ``tilt``.

    Args:
        tilt: tilt of the groove [rad]; the groove rises toward +x.
        size: edges of the box [m]; the first edge lies along the groove.
        along: distance of the box's middle from the lower end, along the groove [m].
        side: sign of the turn about the groove's length, 1 or -1.
        off_line: offset of the box's middle from the deepest line, in the level groove [m], shape (3,).
    """
    lift: Quaternion = (math.cos(tilt / 2), 0.0, -math.sin(tilt / 2), 0.0)
    roll = side * RISE / 2
    turn: Quaternion = (
        lift[0] * math.cos(roll),
        lift[0] * math.sin(roll),
        lift[2] * math.cos(roll),
        -lift[2] * math.sin(roll),
    )
    level = off_line + np.array([along, 0.0, 0.0])
    x, y, z = (rotation(np.array([lift]))[0] @ level + (0.0, 0.0, ABOVE)).tolist()
    return Brick(size, math.prod(size) * DENSITY, (x, y, z), turn)
