"""A ring of wedge-shaped stones on a seat that slopes down inward, as in a dome: a whole ring, or half a ring.

Theory: a single stone slides inward, because the seat's ``SLOPE`` exceeds the angle of friction.

- Whole ring: the sides of each stone point to the axis, and neighbours press against each other. Because of the
  symmetry this pressure alone holds all stones. With n stones of weight W, the pressure P between neighbours satisfies
  2 P sin(pi / n) = W tan(slope).
- Half a ring: the two outer stones have no pressure on one side, and the stones slide inward. Exact statics finds no
  forces that hold the stones. In engines the stones slide until they meet the seats of their neighbours, where they
  may jam: after 20 mm for 8 stones and scale 1. Therefore half a ring is a study.

Look for: pressure between the sides arises only when the stones begin to slide. A rule that judges each stone by the
bodies below the stone freezes half a ring, or never freezes a whole ring.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Annotated

from scenarios.model import Brick, Expectation, Place, Vector, World
from scenarios.parameters import Choice, Scale, Whole
from scenarios.planks import DENSITY
from scenarios.scenario import Plan, scenario
from scenarios.solids import polyhedron

INNER, OUTER = 0.10, 0.14
"""Distance [m] of a stone's inner and outer face from the axis, at scale 1."""
HEIGHT = 0.03
"""Height of a stone [m], at scale 1."""
SEAT = 0.10
"""Height [m] of the seat's inner edge above the ground, at scale 1, which leaves room to fall."""
SEAT_WIDTH = 0.5
"""Ratio of a seat's width to the width of its stone, because a stone that slides inward must not meet the seats of its
neighbours, which rise toward their own stones."""
SLOPE = math.radians(30)
"""Slope of the seat [rad]."""
FRICTION = 0.2
"""Coulomb coefficient, less than half of tan(``SLOPE``)."""


@scenario
def dome_ring(
    *,
    stones: Annotated[int, Whole(5, 24)] = 8,
    ring: Annotated[str, Choice("whole", "open")] = "whole",
    scale: Scale = 1.0,
) -> Plan:
    """Build a ring of stones on a sloping seat.

    Args:
        stones: number of stones of a whole ring.
        ring: "whole", or "open" for half of the stones.
        scale: factor on all lengths.
    """
    count = stones if ring == "whole" else stones // 2
    is_whole = count == stones
    return Plan(
        world=World(friction=FRICTION, fixed=tuple(_seat(index, stones, scale) for index in range(stones))),
        actions=(Place(0.0, tuple(_stone(index, stones, scale) for index in range(count)), 0.0),),
        expectation=Expectation("stand", "pressure between the sides alone holds the ring, by symmetry")
        if is_whole
        else Expectation(
            "study", "the stones slide inward, but then meet the seats of their neighbours, where they may jam"
        ),
        look_for="stones that slide inward in half a ring, and nowhere else",
    )


def _stone(index: int, stones: int, scale: float) -> Brick:
    return _sector(index, stones, scale, 1.0, bottom=_rise, top=lambda x: _rise(x) + HEIGHT)


def _seat(index: int, stones: int, scale: float) -> Brick:
    return _sector(index, stones, scale, SEAT_WIDTH, bottom=lambda _: 0.0, top=_rise)


def _rise(x: float) -> float:
    """Return the height [m] of the seat at the distance ``x`` [m] from the axis."""
    return SEAT + (x - INNER) * math.tan(SLOPE)


def _sector(
    index: int,
    stones: int,
    scale: float,
    width: float,
    *,
    bottom: Callable[[float], float],
    top: Callable[[float], float],
) -> Brick:
    """Return a body between two planes through the axis.

    ``bottom`` and ``top`` give the body's heights [m] at the distance x [m] from the axis.
    """
    half = width * math.tan(math.pi / stones)
    corners: list[Vector] = [
        (scale * x, scale * side * x * half, scale * height(x))
        for x in (INNER, OUTER)
        for side in (-1, 1)
        for height in (bottom, top)
    ]
    turn = 2 * math.pi * index / stones
    quaternion = (math.cos(turn / 2), 0.0, 0.0, math.sin(turn / 2))
    return polyhedron(corners, position=(0.0, 0.0, 0.0), quaternion=quaternion, density=DENSITY)
