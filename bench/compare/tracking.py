"""Figures of a run in the format of benchmark-tracking actions (``customSmallerIsBetter``)."""

from __future__ import annotations

from bench.compare.side import Baseline

_PERCENT = 100.0


def tracked(side: Baseline) -> list[dict[str, str | float]]:
    """Return figures for which smaller is better: missing levels, and ratios of parts of a frame to the engine's step.

    The figures contain no times in milliseconds, because times vary between machines.
    """
    figures: list[dict[str, str | float]] = []
    for record in side.trials:
        if record.expectation.outcome == "stand" and not side.is_limited(record):
            missed = record.levels_planned - record.height_levels
            figures.append({"name": f"{record.trial}: levels missed", "unit": "levels", "value": missed})
        for part, share in side.shares.get(record.trial, {}).items():
            if part == "engine":
                continue
            name = f"{record.trial}: {part}"
            figures.append({"name": name, "unit": "% of the engine's step", "value": round(_PERCENT * share, 2)})
    return figures
