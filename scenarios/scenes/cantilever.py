"""A cantilever: a beam on a pier, a counterweight on its inner end, a load on its outer end; then one is taken.

Theory: moments about the pier's edge, in a beam's mass m and length L: the beam holds with m L / 20, the counterweight
of 2 m with 0.4 L, and the load p pulls with 0.3 L, so all of it stands while p < 2.83 m. Without the counterweight the
beam carries no more than m / 6, and falls; without the load it stands all the better.

Look for: the counterweight decides, though it does not lie above the load. A rule that looks only at bodies straight
above their support lets the beam stand without its counterweight, or tips it while the counterweight is there.
"""

from __future__ import annotations

from typing import Annotated

from scenarios.margins import by_margin
from scenarios.model import Action, Expectation, Remove, World
from scenarios.parameters import Choice, Margin, Scale, Value
from scenarios.planks import MU, box, one_a_second, plank_of
from scenarios.scenario import Plan, scenario

PIER = 6.0
"""Height of the pier in thicknesses of a plank: room to tip."""
COUNTERWEIGHT = 2.0
"""Mass of the counterweight over the mass of the beam."""
BEAM_ARM, COUNTERWEIGHT_ARM, LOAD_ARM = -0.05, -0.4, 0.3
"""Centres along x from the pier's edge, in lengths of the beam."""
PIECE = 0.3
"""Length of counterweight and load, in lengths of the beam."""
LIMIT = -(BEAM_ARM + COUNTERWEIGHT * COUNTERWEIGHT_ARM) / LOAD_ARM
"""The load that balances everything, over the mass of the beam."""


@scenario
def cantilever(
    *,
    margin: Margin = 0.3,
    taken: Annotated[str, Choice("nothing", "load", "counterweight")] = "nothing",
    scale: Scale = 1.5,
) -> Plan:
    """A beam that reaches beyond its pier, held by a counterweight; then load or counterweight is taken away.

    Args:
        margin: share by which the load is lighter than the limit; a negative one is heavier.
        taken: "nothing", "load" or "counterweight", two seconds after the load was laid.
        scale: size of everything over that of the standard plank.
    """
    if taken != "nothing" and margin <= 0:
        raise ValueError(f"margin must be positive where something is taken, got {margin:g}: it has fallen before")
    length, width, thickness, mass = plank_of(scale)
    top, piece = PIER * thickness, (PIECE * length, width, thickness)
    bricks = [
        box((length, width, top), -length / 2, level=1),
        box((length, width, thickness), BEAM_ARM * length, level=2, bottom=top),
        box(piece, COUNTERWEIGHT_ARM * length, level=3, bottom=top + thickness, mass=COUNTERWEIGHT * mass),
        box(piece, LOAD_ARM * length, level=4, bottom=top + thickness, mass=(1 - margin) * LIMIT * mass),
    ]
    actions: tuple[Action, ...] = one_a_second([brick] for brick in bricks)
    time = actions[-1].time + 2.0
    expectation = by_margin(margin, f"a load of {LIMIT:.2f} times the beam, by moments about the edge", falls_at=4)
    common: dict[str, Value] = {"margin": abs(margin)}
    if taken != "nothing":
        actions += (Remove(time, {"counterweight": 2, "load": 3}[taken]),)
        common["taken"] = "load"
    if taken == "load":
        expectation = Expectation("stand", "without its load the beam is held all the better")
    elif taken == "counterweight":
        expectation = Expectation("fall", "alone the beam carries a sixth of its mass", 4, not_before_s=time)
    return Plan(
        world=World(friction=MU),
        actions=actions,
        expectation=expectation,
        look_for="the beam turns about the pier's edge as soon as its counterweight is too light or gone",
        partner=common,
        planar=True,
    )
