"""A column of cubes, each heavier than the cube below by the same factor: the mass-ratio column of solver papers.

Theory: weight only presses a column together, so that a straight column stands at any ratio of masses. The topmost of
the n cubes has the offset d. Cube k has the mass m_k and the edge e_k. The joint above cube k tips if the centre of
mass of all cubes above the joint lies beyond the edge of cube k:

    d m_n / (m_(k+1) + ... + m_n) > e_k / 2

Equal cubes tip at the topmost joint, growing cubes at a lower joint.

Look for: an iterative solver passes a load on by one cube in each iteration. Therefore the light cubes at the bottom
sink, or the load squeezes these cubes out. For an exact solver the ratio of masses makes no difference.
"""

from __future__ import annotations

from typing import Annotated

from scenarios.margins import by_margin
from scenarios.model import Brick, Expectation, World
from scenarios.parameters import Real, Scale, Whole
from scenarios.planks import MU, box, one_a_second
from scenarios.scenario import Plan, scenario

EDGE = 0.1
"""Edge [m] of the lowest cube at scale 1."""


@scenario
def growing_column(
    *,
    levels: Annotated[int, Whole(2, 20)] = 20,
    ratio: Annotated[float, Real(1, 10)] = 1.0,
    aside: Annotated[float, Real(0, 1.5)] = 0.0,
    scale: Scale = 1.0,
) -> Plan:
    """Build a column of cubes whose masses grow upward by one ratio.

    Args:
        levels: number of cubes.
        ratio: mass of each cube over the mass of the cube below; all cubes have the same density.
        aside: offset of the topmost cube, as a share of the offset at which the column tips.
        scale: factor on all lengths; the lowest cube has an edge of 0.1 m times ``scale``.
    """
    cubes = _column(levels, ratio, EDGE * scale)
    top = cubes[-1]
    limit = _tips_at(cubes)
    cubes[-1] = box(top.size, aside * limit, level=levels, bottom=top.position[2] - top.size[2] / 2)
    return Plan(
        world=World(friction=MU),
        actions=one_a_second([cube] for cube in cubes),
        expectation=_expectation(aside, limit, levels),
        look_for="light cubes at the bottom that sink or are pressed out from under the heavy cubes",
        partner={"aside": min(aside, round(2 - aside, 9))} if aside else None,
        planar=True,
    )


def _column(levels: int, ratio: float, edge: float) -> list[Brick]:
    cubes, bottom = [], 0.0
    for level in range(1, levels + 1):
        side = edge * ratio ** ((level - 1) / 3)
        cubes.append(box((side, side, side), 0.0, level=level, bottom=bottom))
        bottom += side
    return cubes


def _tips_at(cubes: list[Brick]) -> float:
    """Return the offset [m] of the topmost cube at which the column tips at its weakest joint."""
    above, least = 0.0, float("inf")
    for upper, lower in zip(reversed(cubes), reversed(cubes[:-1]), strict=False):
        above += upper.mass
        least = min(least, lower.size[0] / 2 * above / cubes[-1].mass)
    return least


def _expectation(aside: float, limit: float, levels: int) -> Expectation:
    if not aside:
        return Expectation("stand", "weight only presses a straight column together, at any ratio of masses")
    return by_margin(1 - aside, f"{limit * 1e3:.0f} mm aside", falls_at=levels)
