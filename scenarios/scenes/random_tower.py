"""A tower of planks: the middle of each plank lies at a random place between the ends of the plank below.

Theory, for planks of length L, thickness t and mass m: each plank must lie below the centre of mass of all planks
above, or the tower falls. Two planks stand in every draw. The third plank tips the second plank if the offsets u2 and
u3 satisfy |u2 + u3 / 2| > L / 2, with the probability 1/8. On average a tower falls at its 7.11th plank.

Each draw is a tower with a known answer, unless a centre of mass lies near an edge. Near an edge the energy of placing
a plank may decide. At the distance e from the edge, k planks tip with the energy k m g e^2 / (k t). This energy exceeds
ten times the energy of placing a plank if e > sqrt(10 t c) = 6.2 mm, with the release height c.

Look for: the joint that gives way, which need not be the topmost joint. The tower must not fall a plank early or late.
"""

from __future__ import annotations

import math
import random
from collections.abc import Sequence
from itertools import accumulate
from typing import Annotated

from scenarios.model import CLEARANCE, Expectation, World
from scenarios.parameters import Whole
from scenarios.planks import LENGTH, MU, THICKNESS, lay, one_a_second
from scenarios.scenario import Plan, scenario

MIN_DISTANCE = math.sqrt(10 * THICKNESS * CLEARANCE)
"""Least distance [m] of a centre of mass from an edge at which the answer is known."""
MOST = 60
"""Greatest number of planks, because fewer than one tower in a million grows so high."""


@scenario
def random_tower(*, draw: Annotated[int, Whole(0, 10**9)] = 1, levels: Annotated[int, Whole(2, MOST)] = 12) -> Plan:
    """Build a tower of planks, each with its middle at a random position over the plank below.

    Args:
        draw: number from which all offsets follow; each number gives another tower.
        levels: number of planks.
    """
    middles = middles_of(draw)[:levels]
    planks = [lay(x, level=level) for level, x in enumerate(middles, start=1)]
    return Plan(
        world=World(friction=MU),
        actions=one_a_second([plank] for plank in planks),
        expectation=expected(middles),
        look_for="which joint gives way (not always the topmost), and whether the fall comes a plank early or late",
        partner={"levels": 12},
        planar=True,
    )


def middles_of(draw: int) -> list[float]:
    """Return the middles along x [m] of a draw's planks, shape (MOST,); the middle of the lowest plank is 0."""
    generator = random.Random(draw)
    return list(accumulate((LENGTH * (generator.random() - 0.5) for _ in range(MOST - 1)), initial=0.0))


def room(middles: Sequence[float]) -> float:
    """Return the least distance [m] of an upper part's centre of mass from the ends of the plank below.

    The distance is negative if the centre lies beyond an end, and infinite for a single plank.
    """
    least, total = math.inf, 0.0
    for above, middle in enumerate(reversed(middles)):
        if above:
            least = min(least, LENGTH / 2 - abs(total / above - middle))
        total += middle
    return least


def falls_at(middles: Sequence[float]) -> int | None:
    """Return the least number of planks with which the tower falls; None if all planks stand."""
    return next((n for n in range(2, len(middles) + 1) if room(middles[:n]) < 0), None)


def expected(middles: Sequence[float]) -> Expectation:
    """Return the expectation for planks with these ``middles`` [m]."""
    fall = falls_at(middles)
    standing = middles if fall is None else middles[: fall - 1]
    is_known = all(room(standing[:n]) > MIN_DISTANCE for n in range(2, len(standing) + 1))
    if not is_known or (fall is not None and room(middles[:fall]) > -MIN_DISTANCE):
        return Expectation(
            "study", f"a centre of mass within {MIN_DISTANCE * 1e3:.1f} mm of an edge: placement errors decide"
        )
    if fall is None:
        return Expectation("stand", "every upper part's centre of mass lies over the plank below it")
    return Expectation("fall", f"{fall} planks are the first with a centre of mass beside its support", fall)
