"""Margins: the distance of a scene from its limit of stability, and the outcome that theory gives at this distance.

The deciding quantity is a load, an offset or a coefficient of friction. The margin is the distance of this quantity
from its limit, as a share of the limit. A positive margin lies on the safe side, a negative margin beyond the limit.
Scenes within 5 % of a limit have no known answer, because a real drop has energy that statics ignores. Stacks that
could tip have large bricks, so that the energy of placing a brick does not tip the stack.
"""

from __future__ import annotations

from scenarios.model import Expectation

MIN_MARGIN = 0.05
"""Least distance from the limit at which a scene has a known answer, as a share of the limit."""
ROUNDING = 1e-9
"""Greatest rounding error of a margin, as a share of the limit."""


def by_margin(margin: float, limit: str, *, falls_at: int, not_before_s: float = 0.0) -> Expectation:
    """Return the expectation for a scene with ``margin``: stand, fall, or study (no known answer).

    Args:
        margin: distance from the limit, as a share of the limit; negative beyond the limit.
        limit: the limit of the deciding quantity, in words.
        falls_at: level at which a scene beyond the limit falls.
        not_before_s: earliest time [s] of the fall.
    """
    if abs(margin) < MIN_MARGIN - ROUNDING:
        return Expectation("study", f"within {MIN_MARGIN:.0%} of {limit}: placement errors decide")
    if margin > 0:
        return Expectation("stand", f"{margin:.0%} inside {limit}")
    return Expectation("fall", f"{-margin:.0%} beyond {limit}", falls_at, not_before_s)
