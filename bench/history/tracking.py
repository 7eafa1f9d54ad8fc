"""A history in the format of benchmark-tracking actions (``customSmallerIsBetter``), a list for each version."""

from __future__ import annotations

from typing import Any

from reports.records.history import History, Series

_LARGER_IS_BETTER = frozenset({"levels", "collapse", "tilt"})
"""Kinds of figures to leave out, because their best value is not the smallest value."""


def tracked_versions(history: History) -> list[dict[str, Any]]:
    """Return name and figures of each version that did not fail, without the kinds in ``_LARGER_IS_BETTER``."""
    series = [one for one in history.series if one.kind not in _LARGER_IS_BETTER]
    return [
        {"version": point.version, "figures": _figures(series, index)}
        for index, point in enumerate(history.points)
        if not point.message
    ]


def _figures(series: list[Series], index: int) -> list[dict[str, str | float]]:
    named = ((one, one.values[index]) for one in series)
    return [{"name": one.name, "unit": one.unit, "value": value} for one, value in named if value is not None]
