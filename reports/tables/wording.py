"""Texts of estimates, creeps, levels, counts and lists."""

from __future__ import annotations

import math
from collections.abc import Sequence

from reports.statistics.groups import Group
from reports.statistics.intervals import Estimate
from reports.statistics.survival import Survival
from reports.tables.table import NOTHING

MICRO = 1e6
"""Factor from m/s to µm/s."""
_WENT_WRONG = {
    "timeout": ("timed out", "timed out"),
    "diverged": ("diverged", "diverged"),
    "crashed": ("crashed", "crashed"),
    "error": ("ended in an error", "ended in errors"),
    "out_of_memory": ("ran out of memory", "ran out of memory"),
    "unsupported": ("is unsupported", "are unsupported"),
}


def some(names: Sequence[str], most: int = 3) -> str:
    """Return the first ``most`` names of a list and the number of further names, such as ``a, b, c and 20 more``."""
    more = len(names) - most
    return ", ".join(names[:most]) + (f" and {more} more" if more > 0 else "")


def quantity(number: int, noun: str) -> str:
    """Return a number of things as text, such as ``1 trial`` or ``23 trials``."""
    return f"{number} {noun}{'s' * (number != 1)}"


def number(estimate: Estimate | None, digits: int, scale: float = 1.0) -> str:
    """Format an estimate with ``digits`` decimals and its interval, such as ``0.07 [0.06, 0.09]``; a dash for None.

    The text omits an interval whose rounded ends are equal. ``scale`` multiplies all numbers.
    """
    if estimate is None:
        return NOTHING
    return _with_interval(estimate, digits, scale, "")


def ratio_text(estimate: Estimate | None) -> str:
    """Format a ratio with its interval, such as ``0.027 [0.026, 0.030]``.

    A ratio below 0.1 has three decimals; any other ratio has two. The text is a dash for None.
    """
    return number(estimate, 3 if estimate is not None and estimate.value < 0.1 else 2)


def percent(estimate: Estimate | None) -> str:
    """Format a ratio in percent with its interval, such as ``88 % [71, 97]``; return a dash for None."""
    if estimate is None:
        return NOTHING
    return _with_interval(estimate, 0, 100.0, " %")


def _with_interval(estimate: Estimate, digits: int, scale: float, unit: str) -> str:
    text = f"{estimate.value * scale:.{digits}f}{unit}"
    if estimate.low is None or estimate.high is None:
        return text
    low, high = f"{estimate.low * scale:.{digits}f}", f"{estimate.high * scale:.{digits}f}"
    return text if low == high else f"{text} [{low}, {high}]"


def micrometres(speed: float) -> str:
    """Format a speed [µm/s] with two decimals, from 100 on without decimals."""
    return f"{speed:.2f}" if speed < 100 else f"{speed:.0f}"


def creep_doubt(creep_m_s: float, error_m_s: float | None) -> tuple[str, str]:
    """Return the 95 % interval [µm/s] and the mark of a creep that is not certainly above its limit.

    The mark is ``trembles`` if the interval reaches 0, because the brick then has no certain direction; else ``?``.
    The interval is empty without a measured error.

    Args:
        creep_m_s: the creep [m/s].
        error_m_s: half width of its interval [m/s].
    """
    if error_m_s is None:
        return "", "?"
    low, high = (max(0.0, creep_m_s + side * error_m_s) * MICRO for side in (-1, 1))
    return f" [{micrometres(low)}, {micrometres(high)}]", "?" if low > 0 else "trembles"


def median_level(survival: Survival | None) -> str:
    """Format the median collapse level with its interval, such as ``9 [8, 11]``; a dash for None.

    For example, the text is ``>30`` if the median lies above 30, the highest built level.
    """
    if survival is None:
        return NOTHING
    highest = float(survival.level[-1])
    text = _level(survival.median, highest)
    interval = survival.median_interval
    if interval is None or interval == (survival.median, survival.median):
        return text
    return f"{text} [{_level(interval[0], highest)}, {_level(interval[1], highest)}]"


def _level(level: float, highest: float) -> str:
    return f">{highest:g}" if math.isinf(level) else f"{level:g}"


def troubles(group: Group) -> str:
    """Return as text the counts of draws that neither completed nor collapsed, such as ``2 of 20 timed out``.

    The text is empty if all draws completed or collapsed.
    """
    counts = {status: sum(trial.status == status for trial in group.draws) for status in _WENT_WRONG}
    return ", ".join(
        f"{count} of {len(group.draws)} {_WENT_WRONG[status][count > 1]}" for status, count in counts.items() if count
    )
