"""A tower of planks on ground that tilts: gravity turns, as whoever stands on the ground sees it.

Theory: on a slope of angle a, planks hold while tan a <= mu, whatever lies on them: below the friction angle of 24.2
deg all stand, above it they slide. They lie along the slope and are far lower than long, so that nothing tips.

What to look for: a frozen tower must feel that the ground tilts, though nothing touches it anew.
"""

from __future__ import annotations

from scenarios.model import Action, Scene, Tilt, World
from scenarios.parameters import Value, real, variant_of, whole
from scenarios.planks import MU, lay, one_a_second
from scenarios.scenes.shared.slopes import TILT_S, on_slope

PAUSE_S = 2.0
"""From the last plank to the tilt [s]."""


def tilted_ground(*, angle: float = 28.0, levels: int = 4) -> Scene:
    """A tower of planks on ground that tilts: gravity turns.

    Args:
        angle: of the ground in the end [deg].
        levels: number of planks.
    """
    angle = real("angle", angle, least=0.1, most=45.0)
    levels = whole("levels", levels, least=1, most=6)
    parameters: dict[str, Value] = {"angle": angle, "levels": levels}
    actions: tuple[Action, ...] = one_a_second([lay(0.0, level=level)] for level in range(1, levels + 1))
    time = actions[-1].time + PAUSE_S
    actions += (Tilt(time, (0.0, 1.0), angle / TILT_S, TILT_S),)
    return Scene(
        scenario="tilted_ground",
        variant=variant_of(tilted_ground, parameters),
        parameters=parameters,
        world=World(friction=MU),
        actions=actions,
        expectation=on_slope(angle, levels, time),
        look_for="above the friction angle the tower slides off, though nothing has touched it",
        pair=variant_of(tilted_ground, parameters | {"angle": 28.0}),
        planar=True,
    )
