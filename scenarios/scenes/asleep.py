"""Bodies that must move and therefore must not sleep: after a removal, in a common fall, or under a new load.

Theory, by case:

- ``support``: a block lies on a pillar for ``PAUSE_S``. Then the scene removes the pillar. The block falls a distance s
  in the time sqrt(2 s / g): 0.2 m in 0.202 s.
- ``pair``: two blocks, one on the other, fall together: 0.2 m in 0.202 s. The blocks touch, and do not move relative to
  each other.
- ``striker``: a plank lies balanced on a pillar for ``PAUSE_S``. Then a block drops on the plank's end. The lever arms
  about the pillar's edge are 0.05 m for the plank's weight, and 0.10 m for the block's weight. The plank tips, because
  the block is three times as heavy as the plank.

Look for: a body that hangs in the air, and a plank that carries a load beyond its balance.
"""

from __future__ import annotations

import math
from typing import Annotated

from scenarios.model import Expectation, MustMove, Place, Remove, World
from scenarios.parameters import Choice
from scenarios.planks import GRAVITY, MU, box
from scenarios.scenario import Plan, dynamic_scenario

PAUSE_S = 8.0
"""Time [s] for which a stack rests first, so that every engine has put the stack to sleep."""
EDGE = 0.1
"""Edge of a block [m]."""
PILLAR = 0.4
"""Height of the pillar [m]."""
FALL = 0.2
"""Distance [m] that a falling body must move."""
FALL_S = math.sqrt(2 * FALL / GRAVITY)
"""Time [s] of a fall by ``FALL``, from rest."""
DROP = 1.0
"""Drop height [m] of the pair."""
PLANK = (0.3, EDGE, 0.02)
"""Edges of the balanced plank [m]."""
STRIKER = 0.05
"""Edge of the striker [m], and its drop height [m]."""
TIPPED = 0.01
"""Distance [m] that the centre of the balanced plank must move; from this distance the plank has tipped."""


@dynamic_scenario
def asleep(*, case: Annotated[str, Choice("support", "pair", "striker")] = "support") -> Plan:
    """Build bodies that must not sleep, because they must move.

    Args:
        case: "support" for the removal of a support, "pair" for two blocks that fall, "striker" for a block that drops
            on a balanced plank.
    """
    return {"support": _support, "pair": _pair, "striker": _striker}[case]()


def _support() -> Plan:
    pillar = box((EDGE, EDGE, PILLAR), 0.0, level=1)
    block = box((EDGE, EDGE, EDGE), 0.0, level=2, bottom=PILLAR)
    return Plan(
        world=World(friction=MU),
        actions=(Place(0.0, (pillar, block), 0.0), Remove(PAUSE_S, 0)),
        expectation=Expectation(
            "fall", f"without its support the block falls by {FALL:g} m in {FALL_S:.3f} s", 2, not_before_s=PAUSE_S
        ),
        look_for="a block that hangs in the air",
        planar=True,
        must_move=(MustMove(1, PAUSE_S, FALL, FALL_S),),
    )


def _pair() -> Plan:
    blocks = tuple(box((EDGE, EDGE, EDGE / 2), 0.0, level=k + 1, bottom=k * EDGE / 2) for k in range(2))
    return Plan(
        world=World(friction=MU),
        actions=(Place(0.0, blocks, DROP),),
        expectation=Expectation("study", f"both fall by {FALL:g} m in {FALL_S:.3f} s; no landing is demanded"),
        look_for="blocks that stop in the air because they do not move against each other",
        planar=True,
        watch_s=2.0,
        must_move=tuple(MustMove(brick, 0.0, FALL, FALL_S) for brick in range(2)),
    )


def _striker() -> Plan:
    pillar = box((EDGE, EDGE, PILLAR), 0.0, level=1)
    plank = box(PLANK, 0.0, level=2, bottom=PILLAR)
    x = (PLANK[0]) / 2
    block = box((STRIKER,) * 3, x, level=3, bottom=PILLAR + PLANK[2], mass=3 * plank.mass)
    strikes_s = PAUSE_S + math.sqrt(2 * STRIKER / GRAVITY)
    return Plan(
        world=World(friction=MU),
        actions=(Place(0.0, (pillar, plank), 0.0), Place(PAUSE_S, (block,), STRIKER)),
        expectation=Expectation(
            "fall", "a block of three times its mass, 0.10 m beyond the edge, tips the plank", 3, not_before_s=PAUSE_S
        ),
        look_for="a plank that carries a load at its end beyond its balance",
        planar=True,
        must_move=(MustMove(1, strikes_s, TIPPED, None),),
    )
