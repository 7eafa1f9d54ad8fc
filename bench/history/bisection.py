"""The first version with a new value of a figure, by a bisection that runs about log2(n) of n versions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from reports.records.history import Kind
from reports.statistics.steps import SCALES


class BisectionError(ValueError):
    """Error for a bisection that cannot start; the message names the fix."""


@dataclass(frozen=True, slots=True)
class FirstNew:
    """Result of a bisection: indices of versions."""

    last_old: int
    first_new: int
    untested: tuple[int, ...]
    """Versions without a value between ``last_old`` and ``first_new``. The first new version may be among them."""


def first_new(count: int, value: Callable[[int], float | None], kind: Kind) -> FirstNew:
    """Return two versions between which a figure takes its new value.

    A version is new if its value is nearer to the last version's value than to the first version's value, on the scale
    of ``kind``. The function skips a version without a value, and tests another version near the middle instead. If the
    figure changes more than once, the function returns only one of the changes.

    Args:
        count: number of versions.
        value: function that returns the value of a version, by its index; None without a value.
        kind: kind of the figure.

    Raises:
        BisectionError: if the first or last version has no value, or their values do not differ by a step.
    """
    scale = SCALES[kind]
    ends = [value(index) for index in (0, count - 1)]
    if ends[0] is None or ends[1] is None:
        raise BisectionError(
            f"the first and the last version must have a value of the figure, got {ends[0]} and {ends[1]}: choose "
            "other ends"
        )
    old, new = (scale.transformed(end) for end in ends if end is not None)
    if abs(new - old) < scale.least_step:
        raise BisectionError(
            f"the first and the last version do not differ by a step ({ends[0]:.4g} and {ends[1]:.4g}): choose other "
            "ends, or another figure"
        )
    low, high, untested = 0, count - 1, set[int]()
    while True:
        between = [index for index in range(low + 1, high) if index not in untested]
        if not between:
            return FirstNew(low, high, tuple(sorted(index for index in untested if low < index < high)))
        middle = min(between, key=lambda index: abs(2 * index - low - high))
        found = value(middle)
        if found is None:
            untested.add(middle)
        elif abs(scale.transformed(found) - new) < abs(scale.transformed(found) - old):
            high = middle
        else:
            low = middle
