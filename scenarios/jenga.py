"""Jenga: three planks a level, each level across the one below; then two are taken from one level.

Theory: what lies above the robbed level has its centre of mass over the tower's middle. If the middle plank is left it
lies half a width (11.7 mm) inside that plank's edges: it stands. If a side plank is left it lies 13.7 mm beyond the
nearest edge: it falls. With two planks left it stands either way, so the first removal does no harm.

What to look for: after the second removal, does the tower turn over about the plank that is left, in one piece?
"""

from __future__ import annotations

import math

from scenarios.model import Action, Brick, Expectation, Remove, Scene, World
from scenarios.parameters import Value, choice, variant_of, whole
from scenarios.planks import GAP, LENGTH, MU, THICKNESS, WIDTH, box, one_a_second

ROBBED = 2
"""The level from which planks are taken."""
TALL = 3
"""Height of that level's planks in thicknesses: room to fall."""
PAUSE_S = 1.0
"""From the last plank to the first removal, and from that to the next [s]: time to settle."""


def jenga(*, levels: int = 6, left: str = "middle") -> Scene:
    """Three planks a level in turn along and across; then two planks of the second level are taken.

    Args:
        levels: number of levels, of three planks each.
        left: which plank of the second level is left, "middle" or "side".
    """
    levels = whole("levels", levels, least=ROBBED + 1, most=100)
    left = choice("left", left, ("middle", "side"))
    parameters: dict[str, Value] = {"levels": levels, "left": left}
    planks = [_plank(level, place * (WIDTH + GAP)) for level in range(1, levels + 1) for place in (-1, 0, 1)]
    groups = [[plank for plank in planks if plank.level == level] for level in range(1, levels + 1)]
    actions: tuple[Action, ...] = one_a_second(groups)
    first = 3 * (ROBBED - 1)
    time = actions[-1].time + PAUSE_S
    taken = (first, first + 2) if left == "middle" else (first, first + 1)
    actions += tuple(Remove(time + turn * PAUSE_S, brick) for turn, brick in enumerate(taken))
    if left == "middle":
        expectation = Expectation("stand", "the upper part's centre of mass lies over the plank that is left")
    else:
        expectation = Expectation(
            "fall",
            "the upper part's centre of mass lies 13.7 mm beside the plank that is left",
            levels,
            actions[-1].time,
        )
    return Scene(
        scenario="jenga",
        variant=variant_of(jenga, parameters),
        parameters=parameters,
        world=World(friction=MU),
        actions=actions,
        expectation=expectation,
        look_for="does it turn over about the plank that is left, in one piece?",
        pair=variant_of(jenga, parameters | {"left": "middle"}),
    )


def _plank(level: int, aside: float) -> Brick:
    """A plank of a level, so far [m] aside of the middle."""
    height = TALL * THICKNESS if level == ROBBED else THICKNESS
    bottom = (level - 1) * THICKNESS + ((TALL - 1) * THICKNESS if level > ROBBED else 0.0)
    x, y, yaw = (0.0, aside, 0.0) if level % 2 else (aside, 0.0, math.pi / 2)
    return box((LENGTH, WIDTH, height), x, y, level=level, bottom=bottom, yaw=yaw)
