"""Margins: the distance of a scene from its limit, and the outcome that may be claimed there.

``margin`` is the share by which the deciding quantity (a load, an offset, a coefficient of friction) lies on the safe
side of its limit; a negative margin lies beyond the limit. Scenes claim no answer within 5 % of a limit, because a real
drop has energy that statics ignores. Stacks that tip are large enough that the energy of placing a brick does not tip
them.
"""

from __future__ import annotations

from scenarios.model import Expectation

MIN_MARGIN = 0.05
"""Least distance of a known answer from its limit, as a share of the limit."""
ROUNDING = 1e-9
"""Rounding error of a share."""


def by_margin(margin: float, limit: str, *, falls_at: int, not_before_s: float = 0.0) -> Expectation:
    """Return the expectation for a scene with this margin: it stands, falls at a level, or is a study near the limit.

    Args:
        margin: distance from the limit, as a share of the limit; negative beyond it.
        limit: the deciding quantity, in words.
        falls_at: level at which a scene beyond the limit falls.
        not_before_s: earliest time [s] of the fall.
    """
    if abs(margin) < MIN_MARGIN - ROUNDING:
        return Expectation("study", f"within {MIN_MARGIN:.0%} of {limit}: placement errors decide")
    if margin > 0:
        return Expectation("stand", f"{margin:.0%} inside {limit}")
    return Expectation("fall", f"{-margin:.0%} beyond {limit}", falls_at, not_before_s)
