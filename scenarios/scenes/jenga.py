"""Jenga: three planks a level, each level across the level below. Then the scene takes two planks from some levels.

Theory: a robbed level is a level that loses two planks. The part above a robbed level has its centre of mass over the
tower's middle.

- If the middle plank remains, the centre lies half a width (11.7 mm) inside the plank's edges. The tower stands, with
  any number of robbed levels.
- If a side plank remains, the centre lies half a width and the gap between planks (13.7 mm) beyond the nearest edge.
  The tower falls.
- With two remaining planks the tower stands in either case. Therefore the tower stands after the first removal from a
  level.

The scene removes planks at once, or pulls planks out slowly along their length. A pulled plank drags the tower with mu
times the load on this plank (mu: coefficient of friction). The remaining planks of the level hold the tower with mu
times their loads. If each load acts at the middle of its plank, the remaining planks bear more: of three planks the
pulled plank bears a third of the load, and of two planks the pulled side plank bears 11.7 / 25.4 of the middle plank's
load. If a side plank remains, the tower falls in any case.

The manipulator also carries the pulled plank's weight. Otherwise the plank tips as soon as its centre has left the
tower, and its inner end lifts the part above. With 15 mm of the plank inside, the inner end lifts with three times the
plank's weight.

Look for: a tower that falls after the last removal should turn over about the remaining plank, in one piece.
"""

from __future__ import annotations

import math
from collections.abc import Container, Iterator
from typing import Annotated

from scenarios.model import Action, Brick, Expectation, Pull, Remove, World
from scenarios.parameters import Choice, Gap, Real, Whole
from scenarios.planks import LENGTH, MU, THICKNESS, WIDTH, box, one_a_second
from scenarios.scenario import Plan, scenario

LOWEST = 2
"""Lowest level from which the scene removes planks."""
TALL = 3
"""Height of a robbed level's planks in thicknesses of a plank, which leaves room to fall."""
PAUSE_S = 1.0
"""Time from the last plank to the first removal, and from the end of a removal to the next [s], in which the stack
settles."""
WAY = 1.2 * LENGTH
"""Length of a pull [m], which removes the plank completely."""


@scenario
def jenga(
    *,
    levels: Annotated[int, Whole(LOWEST + 1, 100)] = 6,
    left: Annotated[str, Choice("middle", "side")] = "middle",
    robbed: Annotated[int, Whole(1, 49)] = 1,
    speed: Annotated[float, Real(0, 1, "m/s")] = 0.0,
    gap: Gap = 2.0,
) -> Plan:
    """Build levels of three planks, each across the level below, then take two planks from one or more levels.

    Args:
        levels: number of levels, of three planks each.
        left: remaining plank of the last robbed level, "middle" or "side"; lower robbed levels keep the middle plank.
        robbed: number of robbed levels: the second level, the fourth level, and so on.
        speed: speed of the pull [m/s]; 0 to remove planks at once.
        gap: distance between the planks of a level [mm]; at 0 their sides touch.

    Raises:
        ValueError: if the tower has too few levels for ``robbed``.
    """
    robbed = Whole(1, (levels - LOWEST + 1) // 2).check("robbed", robbed)
    robbed_levels = range(LOWEST, LOWEST + 2 * robbed, 2)
    actions: tuple[Action, ...] = one_a_second(_layers(levels, robbed_levels, gap * 1e-3))
    for level in robbed_levels:
        is_last = level == robbed_levels[-1]
        for place in (0, 1) if is_last and left == "side" else (0, 2):
            before = actions[-1]
            time = PAUSE_S + (before.until if isinstance(before, Pull) else before.time)
            actions += (_taken(3 * (level - 1) + place, level, time, speed),)
    if left == "middle":
        expectation = Expectation("stand", "the upper part's centre of mass lies over the remaining plank")
    else:
        expectation = Expectation(
            "fall",
            f"the upper part's centre of mass lies {WIDTH * 1e3 / 2 + gap:.1f} mm beside the remaining plank",
            levels,
            actions[-1].time,
        )
    return Plan(
        world=World(friction=MU),
        actions=actions,
        expectation=expectation,
        look_for="whether the upper part turns over about the remaining plank, in one piece",
        partner={"left": "middle"},
    )


def _taken(plank: int, level: int, time: float, speed: float) -> Action:
    """Return the action that removes or pulls out a plank, given by its index in the order of placement."""
    if not speed:
        return Remove(time, plank)
    return Pull(time, plank, (speed, 0.0) if level % 2 else (0.0, speed), WAY / speed, is_carried=True)


def _layers(levels: int, robbed: Container[int], gap: float) -> Iterator[list[Brick]]:
    """Yield the planks of each level, from the lowest level, with a distance of ``gap`` [m] between the planks."""
    bottom = 0.0
    for level in range(1, levels + 1):
        height = THICKNESS * (TALL if level in robbed else 1)
        aside = [place * (WIDTH + gap) for place in (-1, 0, 1)]
        poses = [(0.0, shift, 0.0) if level % 2 else (shift, 0.0, math.pi / 2) for shift in aside]
        yield [box((LENGTH, WIDTH, height), x, y, level=level, bottom=bottom, yaw=yaw) for x, y, yaw in poses]
        bottom += height
