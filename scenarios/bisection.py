"""Search for a threshold, the value of a parameter at which a scene's outcome changes, by bisection.

The search tries both ends of the parameter's interval first. If the outcomes at both ends agree, or a tried value has
no outcome, the search reports why there is no threshold. Otherwise the search halves the bracket, the interval that
contains the threshold. The search ends when the bracket is no wider than the tolerance. ``Bisection`` keeps no state:
each step follows from the answers so far. Therefore a caller can resume a search.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import NamedTuple

SPARE_DIGITS = 2
"""Number of decimal digits of a tried value beyond the digits of the tolerance, so that the ids of trials stay
short."""


class Bracket(NamedTuple):
    """State of a search for a threshold."""

    low: float
    """Lower end of the interval in which the answer changes, if there is a threshold."""
    high: float
    """Upper end of the same interval."""
    next: tuple[float, ...]
    """Values to try next; empty when the search has ended."""
    why: str
    """Reason why there is no threshold, in words; empty if there is a threshold, or if the search goes on."""
    low_stands: bool | None
    """True if the scene stands at the lower end, False if it falls there; None if there is no answer."""

    @property
    def is_found(self) -> bool:
        """Return whether the search has ended with a threshold."""
        return not self.next and not self.why

    @property
    def middle(self) -> float:
        """Return the middle of the bracket."""
        return (self.low + self.high) / 2

    @property
    def half_width(self) -> float:
        """Return half the width of the bracket, which is the uncertainty of the bracket's middle."""
        return (self.high - self.low) / 2


@dataclass(frozen=True, slots=True)
class Bisection:
    """Search for the threshold between ``low`` and ``high``, to within ``tolerance``."""

    low: float
    high: float
    tolerance: float
    """Greatest width of the final bracket, in the unit of the parameter."""

    @property
    def most_tries(self) -> int:
        """Return the greatest number of tried values, both ends included."""
        return 2 + max(0, math.ceil(math.log2((self.high - self.low) / self.tolerance) - 1e-9))

    def bracket(self, answers: Mapping[float, bool | None]) -> Bracket:
        """Return the bracket that follows from the answers so far.

        Args:
            answers: answer for each tried value: True if the scene stood, False if the scene fell, None if the trial
            has no answer.
        """
        low, high = self.low, self.high
        missing = tuple(value for value in (low, high) if value not in answers)
        if missing:
            return Bracket(low, high, missing, "", answers.get(low))
        stands = answers[low]
        for value in (low, high):
            if answers[value] is None:
                return Bracket(low, high, (), f"no answer at {value:g}", stands)
        if stands == answers[high]:
            outcome = "stands" if stands else "falls"
            return Bracket(low, high, (), f"{outcome} from {low:g} to {high:g}", stands)
        while high - low > self.tolerance * (1 + 1e-9):
            middle = round((low + high) / 2, self._digits)
            if middle not in answers:
                return Bracket(low, high, (middle,), "", stands)
            answer = answers[middle]
            if answer is None:
                return Bracket(low, high, (), f"no answer at {middle:g}", stands)
            low, high = (middle, high) if answer == stands else (low, middle)
        return Bracket(low, high, (), "", stands)

    def search(self, stands: Callable[[float], bool]) -> Bracket:
        """Call ``stands`` with one value after another until the search ends, and return the final bracket."""
        answers: dict[float, bool | None] = {}
        while (bracket := self.bracket(answers)).next:
            answers |= {value: stands(value) for value in bracket.next}
        return bracket

    @property
    def _digits(self) -> int:
        return max(0, SPARE_DIGITS - math.floor(math.log10(self.tolerance)))
