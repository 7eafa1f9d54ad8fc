"""The comparison: a row for each group of trials, with text and sort keys."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from reports.statistics.groups import ALONE, Group, GroupKey, compare_groups
from reports.statistics.intervals import LEAST_RATIOS, deviation, paired_ratio
from reports.statistics.known_faults import KnownFault, faults_of
from reports.statistics.survival import PairedTest, holm
from reports.tables.outcomes import ADOPTED_NOTE, adopted_mark, outcome
from reports.tables.table import NOTHING, Table
from reports.tables.wording import MICRO, creep_doubt, median_level, number, ratio_text, troubles
from scenarios.threads import Thread, thread_of


@dataclass(frozen=True, slots=True)
class Column:
    """Column of the comparison, with its meaning."""

    title: str
    explanation: str
    unit: str = ""


COLUMNS = (
    Column("seeds", "number of different builds; seed 0 is exact, the others have placement noise"),
    Column("levels", "final level; of several seeds the median collapse level [95 % interval], and how many fell"),
    Column("right", "trials whose outcome theory demands, of those judged"),
    Column("sink", "depth of the highest intact level below its ideal height", "mm"),
    Column(
        "creep",
        "slope of the position of the brick that is fastest for its thickness, over the last half of the watch; the "
        "limit is 1 % of the thickness a minute, 1.3 for a plank; ?: above the limit, but the 95 % interval reaches "
        "below the limit, so that the stack counts as still; trembles: the interval [in brackets] reaches 0, so that "
        "the brick shakes, and its direction is not known",
        "µm/s",
    ),
    Column("p50", "median frame time ± median absolute deviation over seeds", "ms"),
    Column("p99", "99th percentile of the frame time ± median absolute deviation over seeds", "ms"),
    Column(
        "ratio",
        "frame time over the frame time of the same standing stack all awake: the median of at least "
        f"{LEAST_RATIOS} pairs [95 % interval; of five pairs their range]",
    ),
    Column(
        "against none",
        "pairs of a seed, two or more, with the engine alone: higher levels / lower levels; p of no difference, by "
        "Holm's method for all comparisons of this column",
    ),
)


@dataclass(frozen=True, slots=True)
class Entry:
    """Entry of the comparison, as text and as sort key."""

    text: str
    sort: float
    """Sort key of the entry; NaN comes last."""


@dataclass(frozen=True, slots=True)
class ComparisonRow:
    """Row of the comparison for one group of trials."""

    group: Group
    judgement: str
    """Judgement of the group: ``right`` if all judged trials are right, ``wrong`` if none is right, else ``mixed``;
    ``open`` if no trial was judged."""
    entries: tuple[Entry, ...]
    """Entries in the order of ``COLUMNS``."""
    trouble: str
    """Numbers of draws that neither completed nor collapsed, in words; empty if all completed or collapsed."""
    note: str
    """Further note for the reader; empty without a note."""
    thread: Thread | None = None
    """Public discussion (thread) from which the scene comes; None for other scenes."""
    faults: tuple[KnownFault, ...] = ()
    """Known faults of the engine that the row shows."""


def comparison_rows(groups: Sequence[Group]) -> list[ComparisonRow]:
    """Return the row of each group, in the order of the groups."""
    by_key = {group.key: group for group in groups}
    tests = _tests([(group, by_key[alone]) for group in groups if (alone := GroupKey(*group.key[:3], ALONE)) in by_key])
    return [_row(group, tests.get(group.key)) for group in groups]


def comparison_table(rows: Sequence[ComparisonRow], caption: str) -> Table:
    """Return the comparison as a table of text, with ``caption`` as its first note."""
    titles = (f"{column.title} [{column.unit}]" if column.unit else column.title for column in COLUMNS)
    notes = (
        caption,
        *(f"{column.title}: {column.explanation}." for column in COLUMNS),
        *dict.fromkeys(row.note for row in rows if row.note),
    )
    flags = {
        "thread": [row.thread.name if row.thread else "" for row in rows],
        "known fault": [", ".join(fault.thread for fault in row.faults) for row in rows],
    }
    shown = {title: names for title, names in flags.items() if any(names)}
    cells = [(*_cells(row), *(names[number] or NOTHING for names in shown.values())) for number, row in enumerate(rows)]
    header = (*GroupKey._fields, *titles, "ended otherwise", *shown)
    return Table("Comparison", header, tuple(cells), notes, id="comparison")


def _cells(row: ComparisonRow) -> tuple[str, ...]:
    return (*row.group.key, *(entry.text for entry in row.entries), row.trouble or NOTHING)


def _tests(compared: Sequence[tuple[Group, Group]]) -> dict[GroupKey, tuple[PairedTest, float]]:
    """Return the paired test of each group against the engine alone, with its p-value corrected by Holm's method.

    Args:
        compared: each group with the group of the same scene, engine and profile under the policy ``none``.
    """
    tests = {group.key: compare_groups(group, alone) for group, alone in compared if group is not alone}
    decided = {
        key: (test, test.p_value) for key, test in tests.items() if test is not None and test.p_value is not None
    }
    corrected = holm([p_value for _, p_value in decided.values()])
    return {key: (test, p_value) for (key, (test, _)), p_value in zip(decided.items(), corrected, strict=True)}


def _row(group: Group, test: tuple[PairedTest, float] | None) -> ComparisonRow:
    judged, right = len(group.judged), group.count("right")
    entries = (
        Entry(str(len(group.draws)), len(group.draws)),
        _levels(group),
        Entry(f"{right}/{judged}", right / judged) if judged else Entry(NOTHING, math.nan),
        _measured(group, "sink_m", 2, 1e3),
        _creep(group),
        _timed(group, "frame_ms_p50"),
        _timed(group, "frame_ms_p99"),
        _ratio(group),
        _paired(test),
    )
    judgement = "open" if not judged else "right" if right == judged else "mixed" if right else "wrong"
    note = ADOPTED_NOTE if adopted_mark(group.draws) else ""
    thread = thread_of(group.trials[0].parameters)
    return ComparisonRow(group, judgement, entries, troubles(group), note, thread, faults_of(group))


def _levels(group: Group) -> Entry:
    survival = group.survival
    if len(group.draws) == 1 or survival is None:
        sort = survival.median if survival is not None else math.nan
        reached = group.draws[0].height_levels
        return Entry(outcome(group.draws[:1]).rstrip(" ✓✗"), reached if math.isinf(sort) else sort)
    fallen = sum(life.fell for life in group.lifetimes.values())
    if not fallen:
        least = min(life.level for life in group.lifetimes.values())
        return Entry(f"none fell, ≥{least}{adopted_mark(group.draws)}", least)
    text = f"{median_level(survival)}; {fallen} of {len(group.lifetimes)} fell{adopted_mark(group.draws)}"
    return Entry(text, min(survival.median, float(survival.level[-1])))


def _measured(group: Group, field: str, digits: int, scale: float) -> Entry:
    estimate = group.estimate(field)
    return Entry(number(estimate, digits, scale), math.nan if estimate is None else estimate.value * scale)


def _creep(group: Group) -> Entry:
    entry = _measured(group, "creep_m_s", 3, 1e6)
    is_uncertain = any(trial.creep_is_uncertain for trial in group.draws)
    if not is_uncertain:
        return entry
    error = group.draws[0].creep_error_m_s if len(group.draws) == 1 else None
    interval, mark = creep_doubt(entry.sort / MICRO, error)
    return Entry(f"{entry.text}{interval} {mark}", entry.sort)


def _timed(group: Group, field: str) -> Entry:
    estimate = group.estimate(field)
    if estimate is None:
        return Entry(NOTHING, math.nan)
    spread = deviation(group.values(field))
    return Entry(f"{estimate.value:.3f}" + ("" if spread is None else f" ± {spread:.3f}"), estimate.value)


def _ratio(group: Group) -> Entry:
    estimate = paired_ratio(group.measured("frame_ratio"))
    return Entry(ratio_text(estimate), math.nan if estimate is None else estimate.value)


def _paired(tested: tuple[PairedTest, float] | None) -> Entry:
    if tested is None:
        return Entry(NOTHING, math.nan)
    test, p_value = tested
    p_text = "p < 0.001" if p_value < 0.001 else f"p = {p_value:.3f}"
    return Entry(f"{test.first_farther} / {test.second_farther}; {p_text}", p_value)
