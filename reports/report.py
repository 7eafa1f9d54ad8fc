"""The report of a results folder: its tables, page, replays and stills.

A new table needs a file in ``reports/tables`` and a line in ``SECTIONS``.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import NamedTuple

from reports.page.scene_names import scene_names
from reports.page.study_page import write_page
from reports.records.folder import ResultsFolder
from reports.records.results import write_trials_csv
from reports.records.trial import RecordError, TrialRecord
from reports.replays.stacks import draw_stills, first_stacks, write_replays
from reports.statistics.groups import Group, groups_of
from reports.statistics.height_cost import cost_points
from reports.statistics.pairs import pair_rows, paired_scenes
from reports.statistics.ranking import rank
from reports.statistics.thresholds import of_fixed_scenes
from reports.tables.capabilities import capability_tables
from reports.tables.collapse_levels import collapse_level_tables
from reports.tables.cost import cost_tables
from reports.tables.divisions import division_tables
from reports.tables.forces import force_tables
from reports.tables.height_cost import height_cost_tables
from reports.tables.known_faults import known_fault_tables
from reports.tables.latex import table_to_latex
from reports.tables.pairs import pair_tables, paired_scenes_table
from reports.tables.piles import pile_tables
from reports.tables.repeatability import repeat_tables
from reports.tables.sleep_audit import sleep_tables
from reports.tables.soak import soak_tables
from reports.tables.study import study_tables
from reports.tables.table import Table, to_markdown, write_table_csv
from reports.tables.threads import thread_tables
from reports.tables.thresholds import threshold_tables
from reports.tables.tilt import tilt_tables
from reports.tables.verdict import ranking_table, sentence


def _fixed(folder: ResultsFolder) -> list[TrialRecord]:
    return of_fixed_scenes(folder.records, folder.study)


def _pair_tables(groups: Sequence[Group]) -> Sequence[Table]:
    return pair_tables(pair_rows(groups), paired_scenes(groups))


def _paired_scenes(records: Sequence[TrialRecord]) -> Sequence[Table]:
    scenes = paired_scenes(groups_of(records))
    return [paired_scenes_table(scenes, scene_names(records))] if scenes else ()


class Section(NamedTuple):
    """Section of a report: a group of tables."""

    id: str
    tables: Callable[[ResultsFolder], Sequence[Table]]
    """Function that returns the tables of a results folder, or no tables if the section does not apply to its study."""
    is_printed: bool = True
    """True if the terminal also shows the tables."""


SECTIONS = (
    Section("pairs", lambda folder: _pair_tables(groups_of(_fixed(folder)))),
    Section("paired_scenes", lambda folder: _paired_scenes(_fixed(folder)), is_printed=False),
    Section("study", lambda folder: study_tables(fixed) if (fixed := _fixed(folder)) else ()),
    Section("cost", lambda folder: cost_tables(folder.records, folder.environment)),
    Section("divisions", lambda folder: division_tables(_fixed(folder))),
    Section("known_faults", lambda folder: known_fault_tables(folder.records)),
    Section("threads", lambda folder: thread_tables(folder.records)),
    Section("soak", lambda folder: soak_tables(folder.records)),
    Section("thresholds", lambda folder: threshold_tables(folder.records, folder.study)),
    Section("tilt", lambda folder: tilt_tables(folder.records)),
    Section("sleep", lambda folder: sleep_tables(folder.records)),
    Section("forces", lambda folder: force_tables(folder.records)),
    Section("piles", lambda folder: pile_tables(folder.records)),
    Section("collapse_levels", lambda folder: collapse_level_tables(folder.records)),
    Section("repeatability", lambda folder: repeat_tables(folder.path, folder.records)),
    Section("height_cost", lambda folder: height_cost_tables(folder.path, folder.records)),
    Section("capabilities", lambda folder: capability_tables(folder.engines), is_printed=False),
)
"""All sections, in their order in ``tables.md``."""


OF_TIMES = frozenset({"frame_time", "comparison", "cost", "machine", "height_cost"})
"""Ids of the tables that show times. A published study leaves out these tables if several of its trials ran at once,
because its times then mean little."""


@dataclass(frozen=True, slots=True)
class Report:
    """Tables, page and notices of a report."""

    tables: tuple[Table, ...]
    """Tables that the terminal shows."""
    ranking: Table
    """Table of the ranking of the set-ups; without rows if no scene has a known answer."""
    verdict: str
    """Verdict of the study in one sentence."""
    is_all_right: bool
    """True if at least one set-up of a product is right in all scenes with a known answer."""
    page: Path
    """Path of the page."""
    notices: tuple[str, ...]
    """Messages that name missing parts of the report and the reasons."""


def tables_of(folder: ResultsFolder) -> dict[Section, Sequence[Table]]:
    """Return the tables of a results folder by section, except the ranking.

    Raises:
        RecordError: if the records are unreadable.
        pyarrow.ArrowException: if a file of frames that a table needs is incomplete.
    """
    return {section: section.tables(folder) for section in SECTIONS}


def build_report(folder: ResultsFolder, missing: Sequence[str] = (), *, all_stills: bool = False) -> Report:
    """Write tables, figures, replays, stills and the page of a results folder, from the raw files of the folder.

    Args:
        folder: a results folder with at least one trial.
        missing: ids of planned trials without a record.
        all_stills: True to draw all stills of the report, even if there are more than ``MOST_STILLS``.

    Raises:
        RecordError: if the records are unreadable, or the folder has no records.
        pyarrow.ArrowException: if a file of frames that a table needs is incomplete.
    """
    if not folder.records:
        raise RecordError(
            f"{folder.trials_file}: a report needs at least one trial, but the file contains none; run the study first"
        )
    tables = tables_of(folder)
    judged = rank(groups_of(_fixed(folder)), folder.reference_engines)
    ranking, verdict = ranking_table(judged, folder.records), sentence(judged, len(missing))
    write_tables(folder, [*([ranking] if ranking.rows else []), *chain.from_iterable(tables.values())], verdict)
    _draw_height_cost(folder)
    stacks = first_stacks(folder.path, folder.records)
    write_replays(folder.path, stacks)
    notice = draw_stills(folder.path, stacks, however_many=all_stills)
    page = write_page(folder.path, folder.records, missing)
    printed = chain.from_iterable(shown for section, shown in tables.items() if section.is_printed)
    return Report(
        tuple(printed), ranking, verdict, bool(judged.units and judged.all_right), page, (notice,) if notice else ()
    )


def write_tables(folder: ResultsFolder, tables: Sequence[Table], verdict: str) -> None:
    """Write ``report/tables.md``, ``report/trials.csv``, and each table as CSV and LaTeX in ``report/tables``.

    The verdict comes first in ``tables.md``.
    """
    folder.report.mkdir(exist_ok=True)
    (folder.report / "tables.md").write_text(f"**{verdict}**\n\n{to_markdown(tables)}", encoding="utf-8")
    write_trials_csv(folder.report / "trials.csv", folder.records)
    files = folder.report / "tables"
    files.mkdir(exist_ok=True)
    for table in tables:
        write_table_csv(files / f"{table.id}.csv", table)
        (files / f"{table.id}.tex").write_text(table_to_latex(table), encoding="utf-8")


def _draw_height_cost(folder: ResultsFolder) -> None:
    points = cost_points(folder.path, folder.records)
    if points:
        from reports.figures.height_cost import write_cost_figure  # its import takes 0.5 s; few reports need it

        write_cost_figure(folder.report / "cost.svg", points)
