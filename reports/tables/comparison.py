"""The comparison matrix: a row for each scene, engine, profile and policy, as text and as what it is sorted by."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from reports.statistics.groups import ALONE, Group, GroupKey, compare_groups
from reports.statistics.intervals import deviation
from reports.statistics.survival import PairedTest, holm
from reports.tables.outcomes import ADOPTED_NOTE, adopted_mark, outcome
from reports.tables.table import NOTHING, Table
from reports.tables.wording import median_level, told, troubles


@dataclass(frozen=True, slots=True)
class Column:
    """What a column shows."""

    title: str
    explanation: str
    unit: str = ""


COLUMNS = (
    Column("seeds", "number of different builds; seed 0 is exact, the others are a hand's"),
    Column("levels", "its end; of several seeds the median level of collapse [95 % interval], and how many fell"),
    Column("right", "trials that went as theory demands, of those that theory can judge"),
    Column("sink", "how far the highest intact level lay below its ideal height", "mm"),
    Column("creep", "fastest mean motion of a brick while the finished stack was watched", "mm/s"),
    Column("p50", "median frame time ± median absolute deviation over seeds", "ms"),
    Column("p99", "99th percentile of the frame time ± median absolute deviation over seeds", "ms"),
    Column("ratio", "frame time over that of the same standing stack all awake [95 % interval]"),
    Column(
        "against none",
        "pairs of a seed with the engine alone: how many came farther / less far; p of no difference, by Holm's method "
        "for all comparisons of this column",
    ),
)


@dataclass(frozen=True, slots=True)
class Figure:
    """One entry of the matrix."""

    text: str
    sort: float
    """What the column is sorted by; nan comes last."""


@dataclass(frozen=True, slots=True)
class MatrixRow:
    """One cell of the comparison, with its figures in the order of ``COLUMNS``."""

    cell: Group
    judgement: str
    """right, wrong, mixed, or open where theory says nothing or the trials did not come so far."""
    figures: tuple[Figure, ...]
    trouble: str
    note: str
    """What else the reader of its figures must know; empty if nothing."""


def matrix(cells: Sequence[Group]) -> list[MatrixRow]:
    """The rows of all cells, in their order."""
    by_key = {cell.key: cell for cell in cells}
    tests = _tests([(cell, by_key[alone]) for cell in cells if (alone := GroupKey(*cell.key[:3], ALONE)) in by_key])
    return [_row(cell, tests.get(cell.key)) for cell in cells]


def matrix_table(rows: Sequence[MatrixRow], caption: str) -> Table:
    """The comparison as a table of text, under its caption."""
    titles = (f"{column.title} [{column.unit}]" if column.unit else column.title for column in COLUMNS)
    notes = (
        caption,
        *(f"{column.title}: {column.explanation}." for column in COLUMNS),
        *dict.fromkeys(row.note for row in rows if row.note),
    )
    return Table(
        "Comparison",
        (*GroupKey._fields, *titles, "ended otherwise"),
        tuple((*row.cell.key, *(figure.text for figure in row.figures), row.trouble or NOTHING) for row in rows),
        notes,
        id="comparison",
    )


def _tests(compared: Sequence[tuple[Group, Group]]) -> dict[GroupKey, tuple[PairedTest, float]]:
    """The paired test of each cell with its engine alone, and its p-value corrected for all of them."""
    tests = {cell.key: compare_groups(cell, alone) for cell, alone in compared if cell is not alone}
    decided = {
        key: (test, test.p_value) for key, test in tests.items() if test is not None and test.p_value is not None
    }
    corrected = holm([p_value for _, p_value in decided.values()])
    return {key: (test, p_value) for (key, (test, _)), p_value in zip(decided.items(), corrected, strict=True)}


def _row(cell: Group, test: tuple[PairedTest, float] | None) -> MatrixRow:
    judged, right = len(cell.judged), cell.count("right")
    figures = (
        Figure(str(len(cell.draws)), len(cell.draws)),
        _levels(cell),
        Figure(f"{right}/{judged}", right / judged) if judged else Figure(NOTHING, math.nan),
        _measured(cell, "sink_m", 2, 1e3),
        _measured(cell, "creep_m_s", 4, 1e3),
        _timed(cell, "frame_ms_p50"),
        _timed(cell, "frame_ms_p99"),
        _ratio(cell),
        _paired(test),
    )
    judgement = "open" if not judged else "right" if right == judged else "mixed" if right else "wrong"
    note = ADOPTED_NOTE if adopted_mark(cell.draws) else ""
    return MatrixRow(cell, judgement, figures, troubles(cell), note)


def _levels(cell: Group) -> Figure:
    survival = cell.survival
    if len(cell.draws) == 1 or survival is None:
        sort = survival.median if survival is not None else math.nan
        reached = cell.draws[0].height_levels
        return Figure(outcome(cell.draws[:1]).rstrip(" ✓✗"), reached if math.isinf(sort) else sort)
    fallen = sum(life.fell for life in cell.lifetimes.values())
    if not fallen:
        least = min(life.level for life in cell.lifetimes.values())
        return Figure(f"none fell, ≥{least}{adopted_mark(cell.draws)}", least)
    text = f"{median_level(survival)}; {fallen} of {len(cell.lifetimes)} fell{adopted_mark(cell.draws)}"
    return Figure(text, min(survival.median, float(survival.level[-1])))


def _measured(cell: Group, field: str, digits: int, scale: float) -> Figure:
    estimate = cell.estimate(field)
    return Figure(told(estimate, digits, scale), math.nan if estimate is None else estimate.value * scale)


def _timed(cell: Group, field: str) -> Figure:
    estimate = cell.estimate(field)
    if estimate is None:
        return Figure(NOTHING, math.nan)
    spread = deviation(cell.values(field))
    return Figure(f"{estimate.value:.3f}" + ("" if spread is None else f" ± {spread:.3f}"), estimate.value)


def _ratio(cell: Group) -> Figure:
    estimate = cell.estimate("frame_ratio")
    return Figure(told(estimate, 2), math.nan if estimate is None else estimate.value)


def _paired(tested: tuple[PairedTest, float] | None) -> Figure:
    if tested is None:
        return Figure(NOTHING, math.nan)
    test, p_value = tested
    told = "p < 0.001" if p_value < 0.001 else f"p = {p_value:.3f}"
    return Figure(f"{test.first_farther} / {test.second_farther}; {told}", p_value)
