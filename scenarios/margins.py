"""How far a scene lies from its limit, and what may be claimed there.

``margin`` is the share by which what decides (a load, an offset, a coefficient of friction) lies on the safe side of
its limit; a negative one lies beyond. A real drop has energy that statics does not know, so no answer is claimed within
5 % of a limit, and known answers of stacks that tip are built large enough to outlast the energy of laying a brick.
"""

from __future__ import annotations

from scenarios.model import Expectation

CERTAIN = 0.05
"""Least share of the limit by which a known answer must lie off it."""
ANSWERED = 1e-9
"""Rounding of a share."""


def by_margin(margin: float, limit: str, *, falls_at: int, not_before_s: float = 0.0) -> Expectation:
    """What must happen ``margin`` on the safe side of ``limit``, which is told in words; else it falls at a level.

    Args:
        margin: share of the limit; negative beyond it.
        limit: what decides.
        falls_at: level at which it falls beyond the limit.
        not_before_s: when [s] that becomes due at the earliest.
    """
    if abs(margin) < CERTAIN - ANSWERED:
        return Expectation("study", f"within {CERTAIN:.0%} of {limit}: how the bricks are laid decides")
    if margin > 0:
        return Expectation("stand", f"{margin:.0%} inside {limit}")
    return Expectation("fall", f"{-margin:.0%} beyond {limit}", falls_at, not_before_s)
