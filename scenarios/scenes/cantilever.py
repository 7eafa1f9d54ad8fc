"""A beam on a pier, with a counterweight on the inner end and a load on the outer end.

The scene may remove the counterweight or the load after the placements.

Theory: the beam has the mass m and the length L, the counterweight the mass 2 m, and the load the mass p. The moments
about the pier's edge, over g, are

    beam             0.05 m L    inward
    counterweight    0.80 m L    inward
    load             0.30 p L    outward

- With both weights the stack stands while p < 2.83 m.
- Without the counterweight the beam carries at most m / 6, and the stack falls.
- Without the load the stack stands.

Look for: the counterweight decides, although it is not above or below the load. A rule that considers only bodies
straight above their support errs: the beam stands without its counterweight, or tips with its counterweight.
"""

from __future__ import annotations

from typing import Annotated

from scenarios.margins import by_margin
from scenarios.model import Action, Expectation, Remove, World
from scenarios.parameters import Choice, Margin, Scale, Value
from scenarios.planks import MU, box, one_a_second, plank_of
from scenarios.scenario import Plan, scenario

PIER = 6.0
"""Height of the pier in thicknesses of a plank, which leaves room to tip."""
COUNTERWEIGHT = 2.0
"""Mass of the counterweight over the mass of the beam."""
BEAM_ARM, COUNTERWEIGHT_ARM, LOAD_ARM = -0.05, -0.4, 0.3
"""Positions of the centres along x, from the pier's edge, in lengths of the beam."""
PIECE = 0.3
"""Length of the counterweight and of the load, in lengths of the beam."""
LIMIT = -(BEAM_ARM + COUNTERWEIGHT * COUNTERWEIGHT_ARM) / LOAD_ARM
"""Mass of the load at the limit of balance, over the mass of the beam."""


@scenario
def cantilever(
    *,
    margin: Margin = 0.3,
    taken: Annotated[str, Choice("nothing", "load", "counterweight")] = "nothing",
    scale: Scale = 1.5,
) -> Plan:
    """Build a beam beyond its pier, held by a counterweight, then optionally remove a weight.

    Args:
        margin: share by which the load is lighter than the limit; negative if the load is heavier.
        taken: brick that the scene removes two seconds after the load's placement: "nothing", "load" or
            "counterweight".
        scale: factor on all lengths, relative to the standard plank.

    Raises:
        ValueError: if ``taken`` is not "nothing" and ``margin`` is not positive.
    """
    if taken != "nothing" and margin <= 0:
        raise ValueError(
            f"margin must be positive with taken = '{taken}', got {margin:g}, because without a positive margin the "
            "beam may fall before the removal: use a positive margin, or taken = 'nothing'"
        )
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
        expectation = Expectation("stand", "without the load the counterweight still holds the beam")
    elif taken == "counterweight":
        expectation = Expectation("fall", "alone the beam carries at most a sixth of its mass", 4, not_before_s=time)
    return Plan(
        world=World(friction=MU),
        actions=actions,
        expectation=expectation,
        look_for="the beam turns about the pier's edge as soon as its counterweight is too light or gone",
        partner=common,
        planar=True,
    )
