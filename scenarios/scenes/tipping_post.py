"""A tall post that leans on its lower edge, a little beyond its balance, and falls slowly at first.

Theory: a post of width b, height h and mass m balances on an edge at atan(b / h) = 5.711 deg. The centre of mass lies
at the distance R = sqrt(b^2 + h^2) / 2 from the edge. The angle phi leads from the vertical above the edge to the
centre:

    phi'' = k sin(phi),    k = 3 g / (4 R)          (moment of inertia about the edge: m (b^2 + h^2) / 3)
    t(phi0 -> phi) = (K(n) - F(asin(cos(phi / 2) / cos(phi0 / 2)), n)) / sqrt(k),    n = cos(phi0 / 2)^2

K and F are the complete and the incomplete elliptic integral of the first kind, of parameter n. From rest at 0.2 deg
(0.05 deg) beyond the balance, the post lies on the ground after 1.77 s (2.14 s). After 0.5 s its centre moves at
22 mm/s (5.7 mm/s).

Look for: if an engine puts slow bodies to sleep, the post stays at an angle at which it cannot stand.
"""

from __future__ import annotations

import math
from typing import Annotated

from scipy.special import ellipkinc, ellipkm1

from scenarios.model import Brick, Expectation, MustMove, Place, World
from scenarios.parameters import Real
from scenarios.planks import DENSITY, GRAVITY
from scenarios.scenario import Plan, dynamic_scenario
from scenarios.scenes.shared.prebuilt import WITHIN

WIDTH, HEIGHT = 0.1, 1.0
"""Edges [m] of the post."""
BALANCE = math.degrees(math.atan(WIDTH / HEIGHT))
"""Angle [deg] off the vertical at which the post balances on an edge."""
FALLEN = 15.0
"""Angle [deg] of rotation from which a brick counts as fallen."""
FRICTION = 0.9
"""Coulomb coefficient, so high that the foot does not slip before the post has fallen."""


@dynamic_scenario
def tipping_post(*, beyond: Annotated[float, Real(0.01, 5.0, "deg")] = 0.2) -> Plan:
    """Build a post that leans on its lower edge beyond its balance.

    Args:
        beyond: angle [deg] beyond the balance.
    """
    lean, arm = math.radians(BALANCE + beyond), math.hypot(WIDTH, HEIGHT) / 2
    height = (HEIGHT * math.cos(lean) + WIDTH * math.sin(lean)) / 2
    turn = (math.cos(lean / 2), 0.0, math.sin(lean / 2), 0.0)
    post = Brick((WIDTH, WIDTH, HEIGHT), DENSITY * WIDTH * WIDTH * HEIGHT, (0.0, 0.0, height), turn)
    seconds = post_fall_s(beyond, beyond + FALLEN)
    way = 2 * arm * math.sin(math.radians(FALLEN) / 2)
    return Plan(
        world=World(friction=FRICTION),
        actions=(Place(0.0, (post,), 0.0),),
        expectation=Expectation(
            "fall",
            f"{beyond:g} deg beyond its balance the post turns by {FALLEN:g} deg in {seconds:.2f} s, and lies after "
            f"{post_fall_s(beyond, 90.0 - BALANCE):.2f} s",
            1,
            within_s=round(WITHIN * seconds, 3),
        ),
        look_for="the post hardly moves at first; a rule that judges rest by speed alone freezes it, which is wrong",
        planar=True,
        watch_s=WITHIN * seconds,
        must_move=(MustMove(0, 0.0, way, seconds),),
    )


def post_fall_s(start: float, end: float) -> float:
    """Return the time [s] in which the post turns, from rest, between two angles [deg] beyond its balance.

    Args:
        start: initial angle [deg], above 0.
        end: final angle [deg]; at ``90 - BALANCE`` the post lies flat on the ground.
    """
    first, last = math.radians(start) / 2, math.radians(end) / 2
    rate = math.sqrt(3 * GRAVITY / (2 * math.hypot(WIDTH, HEIGHT)))
    amplitude = math.asin(min(1.0, math.cos(last) / math.cos(first)))
    quarter, passed = float(ellipkm1(math.sin(first) ** 2)), float(ellipkinc(amplitude, math.cos(first) ** 2))
    return (quarter - passed) / rate
