"""Flat planks straight above each other: the simplest stack.

Theory: the centre of mass of any upper part lies over the middle of the plank below. The nearest edge is 58.5 mm away
along x, and 11.7 mm across. The tower stands at any height.

Look for: the tower sinks. At the top the sinking is visible even if each level sinks by only a tenth of a millimetre.
Then the tower sways slowly. If a solver does not converge over 26 contacts, the swaying grows until the tower topples.
"""

from __future__ import annotations

from typing import Annotated

from scenarios.model import Expectation, World
from scenarios.parameters import Whole
from scenarios.planks import MU, lay, one_a_second
from scenarios.scenario import Plan, scenario


@scenario
def plank_tower(*, levels: Annotated[int, Whole(1, 500)] = 26) -> Plan:
    """Build a tower of flat planks straight above each other, one plank a level.

    Args:
        levels: number of planks. The suite times frames at level 25, and the default of 26 adds a plank above this
            level.
    """
    planks = [lay(0.0, level=level) for level in range(1, levels + 1)]
    return Plan(
        world=World(friction=MU),
        actions=one_a_second([plank] for plank in planks),
        expectation=Expectation("stand", "every upper part's centre of mass lies over the middle of its support"),
        look_for="sinking, level by level; then swaying until the tower topples",
        planar=True,
    )
