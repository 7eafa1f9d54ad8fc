"""A plank that rests on a fixed table and reaches beyond the table's edge: the simplest stack that tips.

Theory: the plank tips if more than half of its length lies beyond the edge.

The scene places the plank without a gap, so that no energy of a drop affects the outcome.

Look for: the limit changes if an engine lets contacts sink in, or if its contact points lie inside the edge. A
bisection of ``reach`` finds each engine's limit (study ``thresholds``).
"""

from __future__ import annotations

from typing import Annotated

from scenarios.margins import by_margin
from scenarios.model import Place, World
from scenarios.parameters import Real
from scenarios.planks import LENGTH, MU, THICKNESS, WIDTH, box, lay
from scenarios.scenario import Plan, dynamic_scenario

TABLE = 6 * THICKNESS
"""Height [m] of the table, which leaves room to tip."""


@dynamic_scenario
def overhang(*, reach: Annotated[float, Real(0.1, 0.9)] = 0.4) -> Plan:
    """Build a plank that rests on a table and reaches beyond the table's edge.

    Args:
        reach: length of the part beyond the edge, as a share of the plank's length.
    """
    table = box((2 * LENGTH, 2 * WIDTH, TABLE), -LENGTH, level=1)
    return Plan(
        world=World(friction=MU, fixed=(table,)),
        actions=(Place(0.0, (lay((reach - 0.5) * LENGTH, level=1, bottom=TABLE),), 0.0),),
        expectation=by_margin(1 - 2 * reach, "reach = 0.5", falls_at=1),
        look_for="a plank that tips with its centre above the table, or stays with its centre beyond the edge",
        planar=True,
    )
