"""A stack that stands. Then the scene removes a load on top, or a support below.

Theory: exact statics of the remaining bricks (``scenarios.statics.truth``) gives the outcome. After the removal of a
support, a brick lacks the support under one side of its centre of mass, or its leaning partner.

- In the stack ``two_blocks``, the upper cube drops straight down after the removal of the lower cube. The upper cube
  stays upright, and keeps its place in plan (seen from above).
- Flat stacks stand on tall pedestals, one below each brick of the lowest level. The scene removes a pedestal, so that a
  brick visibly falls, by more than a thickness onto the next brick.

Look for: an engine may leave sleeping bricks in the air after the removal of their support. The bricks on the removed
support must fall, and no other bricks.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Annotated

from scenarios.lookup import one_of
from scenarios.model import Action, Expectation, Place, Remove, Scene, World
from scenarios.parameters import Choice, Gap, Real
from scenarios.planks import GAP, MU, box, one_a_second
from scenarios.scenario import Plan, scenario
from scenarios.scenes.brick_wall import brick_wall
from scenarios.scenes.card_house import card_house
from scenarios.scenes.four_stack import four_stack
from scenarios.scenes.log_cabin import log_cabin
from scenarios.scenes.pyramid import pyramid
from scenarios.scenes.shared.pedestals import lifted, pedestals

PAUSE_S = 2.0
"""Time from the last brick to the removal [s], in which the stack settles."""
EDGE = 0.2
"""Edge of a block [m]."""


@dataclass(frozen=True, slots=True)
class _Robbery:
    """A stack, and the bricks that a scene may remove."""

    build: Callable[..., Scene]
    """Builder of the stack, which has a parameter ``gap`` [mm] if ``has_gap`` is True."""
    load: tuple[int, ...]
    """Indices of the bricks on top, which carry nothing, in the order of placement without pedestals."""
    support: int
    """Index of a brick of the lowest level in the order of placement: a pedestal if the stack stands on pedestals."""
    is_raised: bool = True
    """True if the stack stands on pedestals."""
    has_gap: bool = False
    """True if the user can choose the gap between neighbours."""


STACKS: Mapping[str, _Robbery] = {
    "four_stack": _Robbery(partial(four_stack, levels=3), load=(11,), support=0, has_gap=True),
    "brick_wall": _Robbery(partial(brick_wall, courses=4, width=2), load=(8,), support=0, has_gap=True),
    "pyramid": _Robbery(partial(pyramid, rows=3), load=(5,), support=0),
    "log_cabin": _Robbery(partial(log_cabin, levels=4), load=(7,), support=0),
    "card_house": _Robbery(partial(card_house, storeys=2), load=(5, 6), support=0, is_raised=False),
    "two_blocks": _Robbery(lambda: _two_blocks(), load=(1,), support=0, is_raised=False),
}


@scenario
def robbed_stack(
    *,
    stack: Annotated[str, Choice(*STACKS)] = "four_stack",
    taken: Annotated[str, Choice("load", "support")] = "load",
    gap: Gap = 2.0,
    pause: Annotated[float, Real(1, 100, "s")] = PAUSE_S,
) -> Plan:
    """Build a stack that stands, then remove the topmost load, or a support of the lowest level.

    Args:
        stack: name of the stack, a key of ``STACKS``.
        taken: brick that the scene removes, "load" or "support".
        gap: distance between neighbours of a level [mm], for "four_stack" and "brick_wall"; at 0 neighbours touch.
        pause: time from the last placement to the removal [s]. An engine puts bricks to sleep after some seconds at
            rest.

    Raises:
        ValueError: if ``gap`` is not its default for a stack of fixed gap.
    """
    robbery = STACKS[stack]
    if gap != robbed_stack.defaults["gap"] and not robbery.has_gap:
        with_gap = one_of(name for name, one in STACKS.items() if one.has_gap)
        raise ValueError(
            f"parameter 'gap' applies only if stack is {with_gap}, got gap = {gap:g} mm with stack = '{stack}', whose "
            "gap is fixed: leave out 'gap'"
        )
    plain = robbery.build(gap=gap) if robbery.has_gap else robbery.build()
    built = _raised(plain, max(0.0, GAP - gap * 1e-3)) if robbery.is_raised else plain
    time = built.actions[-1].time + pause
    below = len(built.bricks) - len(plain.bricks)
    bricks = [below + brick for brick in robbery.load] if taken == "load" else [robbery.support]
    removals: tuple[Action, ...] = tuple(Remove(time, brick) for brick in bricks)
    if taken == "load":
        expectation = Expectation("stand", "the remaining bricks stood before, under more load")
    else:
        expectation = Expectation("fall", "exact statics finds no equilibrium without the support", built.levels, time)
    return Plan(
        world=built.world,
        actions=built.actions + removals,
        expectation=expectation,
        look_for="the bricks that rested on the removed brick must fall, and no other bricks",
        partner={"taken": "load"},
        planar=built.planar,
    )


def _two_blocks() -> Scene:
    """Return a cube on a second cube: without the lower cube, the upper cube drops straight down."""
    blocks = [box((EDGE, EDGE, EDGE), 0.0, level=level, bottom=(level - 1) * EDGE, mass=1.0) for level in (1, 2)]
    return Scene(
        scenario="two_blocks",
        variant="two_blocks",
        parameters={},
        world=World(friction=MU),
        actions=one_a_second([block] for block in blocks),
        expectation=Expectation("stand", "the upper block's centre of mass is above the lower block's middle"),
        look_for="",
        planar=True,
    )


def _raised(scene: Scene, narrower: float) -> Scene:
    """Return the scene on pedestals; the pedestals come one second before the first brick of the scene."""
    higher: list[Action] = [
        Place(action.time + 1.0, tuple(lifted(brick) for brick in action.bricks))
        for action in scene.actions
        if isinstance(action, Place)
    ]
    return replace(scene, actions=(Place(0.0, pedestals(scene, narrower)), *higher))
