"""The table of thresholds: the limit of each stack on each engine, also in percent of the exact limit."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from reports.records.trial import TrialRecord
from reports.statistics.thresholds import Threshold, thresholds_of
from reports.tables.table import NOTHING, Table

TITLE = "Thresholds by bisection"
"""Title of the table."""


def threshold_tables(records: Sequence[TrialRecord], study: Mapping[str, Any]) -> list[Table]:
    """Return the table of thresholds in a list, which is empty if the study has no bisected parameter."""
    found = thresholds_of(records, study)
    if not found:
        return []
    header = ("scene", "parameter", "engine", "profile", "policy", "own limit", "exact", "% of exact")
    notes = (
        "Own limit: where the trials' outcome changes between standing and falling, with half the width of the last "
        "bracket, which holds those of all seeds. Exact: by bisection of exact statics; two values are those with the "
        "bisector and with a plank's face as the normal of a ridge.",
        "Both ends of the search are tried first: where the outcome does not change between them there is no number.",
    )
    rows = tuple(_row(threshold) for threshold in found)
    return [Table(TITLE, header, rows, notes, id="thresholds")]


def _row(one: Threshold) -> tuple[str, ...]:
    whole, exact = one.whole, _distinct(one.exact)
    limits = " / ".join(f"{value:.4g}" for value in exact) or NOTHING
    head = (one.scene, one.parameter, one.engine, one.profile, one.policy)
    if whole is None:
        return (*head, one.why, limits, NOTHING)
    return (*head, _rounded(whole.middle, whole.half_width), limits, percent_of_exact(one))


def percent_of_exact(one: Threshold) -> str:
    """Return a threshold in percent of each distinct exact limit, with its uncertainty; a dash without a value."""
    whole = one.whole
    if whole is None:
        return NOTHING
    shares = ((100 * whole.middle / value, 100 * whole.half_width / value) for value in _distinct(one.exact) if value)
    return " / ".join(_rounded(*share) for share in shares) or NOTHING


def _distinct(exact: tuple[float | None, float | None]) -> list[float]:
    """Return the known exact limits; a single limit if both conventions for a ridge agree within 0.1 %."""
    known = [value for value in exact if value is not None]
    return known[:1] if len(known) == 2 and math.isclose(*known, rel_tol=1e-3) else known


def _rounded(value: float, error: float) -> str:
    """Format a value with its error, rounded to the second significant digit of the error."""
    digits = max(0, 1 - math.floor(math.log10(error)))
    return f"{value:.{digits}f} ± {error:.{digits}f}"
