"""The first version with a new value of a figure, by a bisection that runs about log2(n) of n versions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from bench.history.figures import Figure
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


def first_new(versions: Sequence[str], value: Callable[[int], float | None], figure: Figure) -> FirstNew:
    """Return two versions between which a figure takes its new value.

    A version is new if its value is nearer to the last version's value than to the first version's value, on the scale
    of the figure's kind. The function skips a version without a value, and tests another version near the middle
    instead. If the figure changes more than once, the function returns only one of the changes.

    Args:
        versions: names of the versions, at least two.
        value: function that returns the value of a version, by its index; None without a value.
        figure: the figure, for its name, kind and unit.

    Raises:
        BisectionError: if the first or last version has no value, or their values do not differ by a step.
    """
    scale, count = SCALES[figure.kind], len(versions)
    ends = [value(index) for index in (0, count - 1)]
    measured = [f"{_shown(end, figure.unit)} in {versions[place]}" for place, end in zip((0, -1), ends, strict=True)]
    if ends[0] is None or ends[1] is None:
        raise BisectionError(
            f"'{figure.name}' must have a value in the first and in the last version, got {' and '.join(measured)}: "
            "name other versions with --versions or --commits"
        )
    old, new = (scale.transformed(end) for end in ends if end is not None)
    if abs(new - old) < scale.least_step:
        raise BisectionError(
            f"'{figure.name}' must differ by a step between the first and the last version, got "
            f"{' and '.join(measured)}: name other versions with --versions or --commits, or another figure with "
            "--bisect"
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


def _shown(value: float | None, unit: str) -> str:
    if value is None:
        return "no value"
    return f"{value:.4g} {'level' if value == 1 and unit == 'levels' else unit}"
