"""A log cabin: two parallel planks a level, each level across the one below.

Theory: a plank rests with both ends on the two below, symmetrically, and carries the next two at its ends alike. Half
of everything above goes down through each plank, through the squares at its ends: it stands at any height.

What to look for: four thin columns of squares that must stay plumb; the whole rocks on one that sank deeper.
"""

from __future__ import annotations

import math

from scenarios.model import Expectation, Scene, World
from scenarios.parameters import Value, variant_of, whole
from scenarios.planks import LENGTH, MU, WIDTH, lay, one_a_second

APART = (LENGTH - WIDTH) / 2
"""From the cabin's middle to the middle of a plank [m]: ends and sides are flush."""


def log_cabin(*, levels: int = 8) -> Scene:
    """Two parallel planks a level, each level across the one below.

    Args:
        levels: number of levels, of two planks each.
    """
    levels = whole("levels", levels, least=1, most=200)
    parameters: dict[str, Value] = {"levels": levels}
    planks = [
        lay(0.0, side * APART, level=level) if level % 2 else lay(side * APART, level=level, yaw=math.pi / 2)
        for level in range(1, levels + 1)
        for side in (-1, 1)
    ]
    return Scene(
        scenario="log_cabin",
        variant=variant_of(log_cabin, parameters),
        parameters=parameters,
        world=World(friction=MU),
        actions=one_a_second([plank] for plank in planks),
        expectation=Expectation(
            "stand", "every plank carries two loads and has two supports, symmetric about its middle"
        ),
        look_for="four columns of squares that must stay plumb; it rocks on one that sank deeper",
    )
