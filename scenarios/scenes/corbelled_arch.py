"""A corbelled arch: on two sides each plank reaches beyond the plank below, until a capstone bridges the gap.

Theory: a plank has the length L and the thickness t. Each side has n planks, with the step d. The capstone overlaps a
top plank by o. The coefficient of friction is mu.

- Each side alone is a leaning tower, which stands while n d < L.
- The capstone adds half a plank's weight to each side. At best this force acts at the outer end of the overlap, at
  (n - 1) d + L / 2 - o from the middle of the lowest plank. Moments about the inner edge of the lowest plank give the
  largest step d = (L + o / (n - 1)) / (n + 1).
- Friction below the capstone may push the sides apart with at most mu / 2 of the capstone's weight. This force acts
  (n - 1) t above the edge, and adds at most mu t to L. The scene has a known answer if the arch stands without this
  friction, or falls in spite of it.
- Upper parts of a side are safer, because they are shorter.

Both sides are mirror images. The scene places both sides of a course together.

Look for: only weight locks a corbelled arch. Beyond the limit both sides turn inward about their lowest planks' edges,
as soon as the scene places the capstone.
"""

from __future__ import annotations

from typing import Annotated

from scenarios.margins import by_margin
from scenarios.model import Brick, World
from scenarios.parameters import Margin, Scale, Whole
from scenarios.planks import MU, box, one_a_second, plank_of
from scenarios.scenario import Plan, scenario

SHARED = 0.15
"""Overlap o of the capstone with each side, in lengths of a plank."""


@scenario
def corbelled_arch(*, courses: Annotated[int, Whole(2, 30)] = 5, margin: Margin = 0.1, scale: Scale = 2.0) -> Plan:
    """Build two sides of planks that step inward, and a capstone across the gap.

    Args:
        courses: number of planks of each side.
        margin: share by which the steps are smaller than the limit without friction; if negative, share by which they
            are larger than the limit with friction. Below about -1 / ``courses`` the sides would fall before the
            capstone's placement.
        scale: factor on all lengths, relative to the standard plank.

    Raises:
        ValueError: if the sides would fall before the capstone's placement.
    """
    length, width, thickness, _ = plank_of(scale)
    help_of_friction = 0.0 if margin > 0 else MU * thickness / length
    limit = (1 + SHARED / (courses - 1) + help_of_friction) / (courses + 1)
    step = (1 - margin) * limit
    if courses * step >= 1:
        least = 1 - 1 / (courses * limit)
        raise ValueError(
            f"margin must be above {least:.6g} with {courses} courses, got {margin:g}, because otherwise "
            "the sides fall before the capstone's placement: use a larger margin, or fewer courses"
        )
    top_inner_end = (length - 2 * SHARED * length) / 2
    foot = top_inner_end + length / 2 + (courses - 1) * step * length
    groups: list[list[Brick]] = []
    for course in range(courses):
        x, bottom = foot - course * step * length, course * thickness
        groups.append([box((length, width, thickness), s * x, level=course + 1, bottom=bottom) for s in (-1, 1)])
    groups.append([box((length, width, thickness), 0.0, level=courses + 1, bottom=courses * thickness)])
    return Plan(
        world=World(friction=MU),
        actions=one_a_second(groups),
        expectation=by_margin(margin, f"steps of {limit:.3f} L, by moments with the capstone", falls_at=courses + 1),
        look_for="beyond the limit both sides turn inward as soon as the capstone lies on them",
        partner={"margin": abs(margin)},
        planar=True,
    )
