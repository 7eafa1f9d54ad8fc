"""The table of the cost of height: levels that stood, and frame time, for each engine and profile."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from reports.records.trial import TrialRecord
from reports.statistics.height_cost import CostPoint, cost_points
from reports.tables.table import Table


def height_cost_tables(folder: Path, records: Sequence[TrialRecord]) -> list[Table]:
    """Return the table of the cost of height in a list, which is empty without cost points (see ``cost_points``)."""
    points = cost_points(folder, records)
    return [cost_table(points)] if points else []


def cost_table(points: Sequence[CostPoint]) -> Table:
    """Return the table of levels and frame times: a row per scene, engine and profile, two columns per policy."""
    policies = list(dict.fromkeys(point.policy for point in points))
    cells = {(point.scene, point.engine, point.profile, point.policy): point for point in points}
    rows = []
    for scene, engine, profile in dict.fromkeys((point.scene, point.engine, point.profile) for point in points):
        found = [cells.get((scene, engine, profile, policy)) for policy in policies]
        rows.append((scene, engine, profile, *(text for point in found for text in _described(point))))
    header = ("scene", "engine", "profile", *(f"{policy}: {what}" for policy in policies for what in ("levels", "ms")))
    notes = (
        "Levels that stood, and the median frame time in ms while the highest of them was on top: the cost of the "
        "stack at its tallest. ≥: stopped by the time limit. “-”: no level stood, or no frames were kept.",
    )
    return Table("Cost of height", header, tuple(rows), notes, id="height_cost")


def _described(point: CostPoint | None) -> tuple[str, str]:
    if point is None:
        return "-", "-"
    return f"{'≥' if point.is_bound else ''}{point.levels:g}/{point.planned}", f"{point.frame_ms:.3f}"
