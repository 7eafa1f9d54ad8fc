"""A plank that is dropped from a height on a tower.

Theory: what it brings is m g h. To tip k planks over the long edges of those below takes k m g (sqrt(e^2 + z^2) - z),
with e = half a width and z = k t / 2; the topmost one alone needs least. While m g h is less than half of that nothing
can tip, wherever the energy goes, and nothing slides, for it strikes the middle. Beyond that dynamics decide: a study.

What to look for: a blow on a frozen brick must wake what it can move, and only that; a stack that is glued stands under
any blow.
"""

from __future__ import annotations

import math

from scenarios.model import Expectation, Place, Scene, World
from scenarios.parameters import Value, real, variant_of, whole
from scenarios.planks import MU, THICKNESS, WIDTH, lay, one_a_second

PAUSE_S = 2.0
"""From the last plank to the drop [s]."""
TIPS = math.hypot(WIDTH / 2, THICKNESS / 2) - THICKNESS / 2
"""Energy that tips one plank over its long edge, over its weight [m]."""


def dropped_plank(*, height: float = 3.0, levels: int = 4) -> Scene:
    """A plank that is dropped on a tower.

    Args:
        height: from how high [mm] above the topmost plank.
        levels: number of planks, the dropped one counted.
    """
    height = real("height", height, least=0.5, most=1000)
    levels = whole("levels", levels, least=2, most=100)
    parameters: dict[str, Value] = {"height": height, "levels": levels}
    tower = one_a_second([lay(0.0, level=level)] for level in range(1, levels))
    dropped = Place(tower[-1].time + PAUSE_S, (lay(0.0, level=levels),), height * 1e-3)
    if height * 1e-3 <= TIPS / 2:
        expectation = Expectation("stand", f"it brings less than half of what tips a plank ({TIPS * 1e3:.1f} mm m g)")
    else:
        expectation = Expectation("study", f"it brings energy enough to tip a plank ({TIPS * 1e3:.1f} mm m g)")
    return Scene(
        scenario="dropped_plank",
        variant=variant_of(dropped_plank, parameters),
        parameters=parameters,
        world=World(friction=MU),
        actions=(*tower, dropped),
        expectation=expectation,
        look_for="a blow must wake what it can move, and only that; what is glued stands under any blow",
        planar=True,
    )
