"""A bridge: two outer planks reach out from piers toward each other, and a middle plank lies on their tips.

Theory:

- An outer plank of mass m and length L has its middle 0.2 L behind the pier's edge, and its tip 0.3 L beyond the edge.
- The middle plank, of mass k, overlaps each outer plank by 0.1 L. At best half its weight acts 0.2 L beyond the edge.
- Moments about an edge show that the bridge stands while k / 2 < m.
- Friction below the middle plank, with the coefficient mu, may push each outer plank outward. The force is mu g k / 2,
  and acts a thickness t above the edge. This force shortens the arm of 0.2 L by mu t. The scene has a known answer if
  the bridge stands without this friction, or falls in spite of it.

The two outer planks are mirror images. The scene places both outer planks together.

Look for: both outer planks tip at once, and the middle plank drops between them. Each outer plank alone stands easily.
"""

from __future__ import annotations

from scenarios.margins import by_margin
from scenarios.model import Brick, World
from scenarios.parameters import Margin, Scale
from scenarios.planks import MU, box, one_a_second, plank_of
from scenarios.scenario import Plan, scenario

PIER = 6.0
"""Height of the piers in thicknesses of a plank, which leaves room to tip."""
BEHIND, SHARED, GAP = 0.2, 0.1, 0.4
"""Lengths over the length of a plank:

- BEHIND: distance of an outer plank's middle behind its pier's edge;
- SHARED: overlap of an outer plank with the middle plank;
- GAP: distance between the tips of the outer planks.
"""
TIP = 0.5 - BEHIND
ARM = TIP - SHARED
"""Least distance beyond the edge at which half the middle plank's weight can act, in lengths of a plank."""


@scenario
def plank_bridge(*, margin: Margin = 0.3, scale: Scale = 2.5) -> Plan:
    """Build two planks that reach out from piers, and a third plank that lies on their tips.

    Args:
        margin: share by which the middle plank is lighter than the limit without friction; if negative, share by which
            it is heavier than the limit with friction.
        scale: factor on all lengths, relative to the standard plank.
    """
    length, width, thickness, mass = plank_of(scale)
    limit = 2 * BEHIND / (ARM if margin > 0 else ARM - MU * thickness / length)
    top, edge = PIER * thickness, (TIP + GAP / 2) * length
    piers = [box((length, width, top), side * (edge + length / 2), level=1) for side in (-1, 1)]
    outer = [box((length, width, thickness), side * (edge + BEHIND * length), level=2, bottom=top) for side in (-1, 1)]
    middle: Brick = box(
        ((GAP + 2 * SHARED) * length, width, thickness),
        0.0,
        level=3,
        bottom=top + thickness,
        mass=(1 - margin) * limit * mass,
    )
    return Plan(
        world=World(friction=MU),
        actions=one_a_second([piers, outer, [middle]]),
        expectation=by_margin(margin, f"a middle plank of {limit:.2f} times an outer plank, by moments", falls_at=3),
        look_for="both outer planks tip at once, and the middle plank drops between them",
        partner={"margin": abs(margin)},
        planar=True,
    )
