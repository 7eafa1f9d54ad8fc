"""The content of a user's own scene: bricks that touch exactly, with times and levels, and the actions on them."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import groupby

from scenarios.geometry import Boxes, height_above_ground, room_above_fixed, vertical_clearance
from scenarios.model import Brick, Pull, Push, Remove, World
from scenarios.statics.contact_patch import GROUND, contact_patches

SNAP = 0.2e-3
"""Greatest gap or overlap [m] that counts as rounding in a TOML file."""
GRAZING = 1e-6
"""Greatest distance [m] from the body below at which a brick without a contact patch grazes the body."""
WATCH_S = 5.0
"""Least and default duration [s] of the trial after the last action, for a scene of size 1."""


@dataclass(frozen=True, slots=True)
class OwnContent:
    """The content of a user's own scene."""

    world: World
    bricks: tuple[Brick, ...]
    """Bricks in the order of placement, with their levels."""
    times: tuple[float, ...]
    """Time of placement of each brick [s]."""
    then: tuple[Remove | Push | Pull, ...] = ()
    """Actions on bricks."""
    watch_s: float = WATCH_S
    name: str = ""
    """Name of the scene in the file; empty for the file's own name."""
    notes: tuple[str, ...] = ()
    """Differences from the file, in words."""


def set_down(bricks: Sequence[Brick], times: Sequence[float], fixed: Sequence[Brick]) -> list[Brick]:
    """Return the bricks, with each group of one time shifted along z by at most ``SNAP`` onto the bodies below.

    A group with a larger gap or overlap keeps its place.
    """
    settled: list[Brick] = []
    for _, group in groupby(range(len(bricks)), key=times.__getitem__):
        coming = [bricks[index] for index in group]
        room = room_below(coming, settled, fixed)
        drop = room if abs(room) <= SNAP else 0.0
        settled += [replace(brick, position=(*brick.position[:2], brick.position[2] - drop)) for brick in coming]
    return settled


def room_below(coming: Sequence[Brick], there: Sequence[Brick], fixed: Sequence[Brick]) -> float:
    """Return the distance [m] by which the ``coming`` bricks can sink together.

    The bricks sink until a coming brick meets a placed brick, a fixed body or the ground. The distance is negative if
    the bricks must rise.
    """
    boxes = Boxes.of(coming)
    room = min(float(height_above_ground(boxes).min()), room_above_fixed(boxes, Boxes.of(fixed)))
    return min(room, float(vertical_clearance(boxes, Boxes.of(there)).min(initial=math.inf)))


def levelled(
    bricks: Sequence[Brick], times: Sequence[float], names: Sequence[str], fixed: Sequence[Brick]
) -> tuple[Brick, ...]:
    """Return the bricks, in the order of placement, with their levels.

    Ground and fixed bodies have level 0. A brick is one level above the highest body that it touches at its placement.
    Bricks of one time get their levels one after another, from the support up.

    Raises:
        ValueError: if two bricks overlap, or a brick touches nothing at its placement; the message names the brick and
            the fix.
    """
    try:
        patches = contact_patches(bricks, fixed)
    except ValueError as error:
        raise ValueError(_by_name(str(error), names)) from error
    touched: dict[int, set[int]] = {index: set() for index in range(len(bricks))}
    for patch in patches:
        for one, other in ((patch.first, patch.second), (patch.second, patch.first)):
            if one != GROUND:
                touched[one].add(other)
    levels: dict[int, int] = {GROUND: 0}
    for _, group in groupby(range(len(bricks)), key=times.__getitem__):
        coming = list(group)
        while coming:  # lowest first, because a brick of the group may carry another
            carried = [index for index in coming if touched[index] & levels.keys()]
            if not carried:
                there = [bricks[k] for k in levels if k != GROUND]
                raise ValueError(_floats(names[coming[0]], bricks[coming[0]], there, fixed))
            found = {index: 1 + max(levels[k] for k in touched[index] & levels.keys()) for index in carried}
            levels |= found
            coming = [index for index in coming if index not in found]
    return tuple(replace(brick, level=levels[index]) for index, brick in enumerate(bricks))


def _by_name(message: str, names: Sequence[str]) -> str:
    """Return the message with the names of bricks and fixed bodies in the file, in place of their indices."""
    named = re.sub(r"\bbrick (\d+)\b", lambda found: names[int(found[1])], message)
    return re.sub(r"\bwall (\d+)\b", r"fixed body \1 (from 0)", named)


def _floats(name: str, brick: Brick, there: Sequence[Brick], fixed: Sequence[Brick]) -> str:
    room = room_below([brick], there, fixed)
    if abs(room) <= GRAZING:
        return (
            f"{name} must touch a body or the ground when it is placed, but only grazes the nearest body at a corner "
            f"or at a border of its faces: move {name} sideways, so that it lies on the body below"
        )
    return (
        f"{name} must touch a body or the ground when it is placed, but is {room * 1e3:.3f} mm above the "
        f"nearest body or ground below: set position z of {name} to {brick.position[2] - room:g} m, or place its "
        "support earlier"
    )
