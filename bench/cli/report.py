"""``bench report``: make the page, pictures and tables of a results folder."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from bench.cli.console import OUT, input_errors, read_folder, relative, tell
from bench.execution.results import TRIALS, missing_trials
from bench.publishing.replays import draw_stills, first_stacks, write_replays
from reports.page.study_page import write_page
from reports.records.trial import RecordError
from reports.report import write_report
from reports.statistics.groups import groups_of
from reports.statistics.height_cost import cost_points
from reports.statistics.pairs import pair_rows
from reports.tables.capabilities import capability_table, engines_of
from reports.tables.collapse_levels import collapse_level_tables
from reports.tables.height_cost import cost_table
from reports.tables.pairs import pair_tables
from reports.tables.piles import pile_tables
from reports.tables.repeatability import repeat_tables
from reports.tables.study import study_tables
from reports.tables.table import Table, render


def report(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="A results folder.")],
    stills: Annotated[bool, typer.Option("--stills", help="Draw the final state of all trials, however many.")] = False,
) -> None:
    """Make a folder's page, pictures and tables anew from its raw records, and print the tables."""
    with input_errors():
        tables = make_report(folder, all_stills=stills)
    for table in tables:
        render(table, OUT)


def make_report(folder: Path, *, all_stills: bool = False) -> list[Table]:
    """Write the report of a results folder into it; return its tables without the engines' capabilities."""
    records = read_folder(folder)
    if not records:
        raise RecordError(f"{folder / TRIALS}: holds no trial yet")
    of_pairs = pair_tables(pair_rows(groups_of(records)))
    tables = [*of_pairs, *study_tables(records), *pile_tables(records), *collapse_level_tables(records)]
    tables += repeat_tables(folder, records)
    points = cost_points(folder, records)
    if points:
        tables.append(cost_table(points))
    engines = engines_of(folder)
    write_report(folder, records, [*tables, *([capability_table(engines)] if engines else [])])
    if points:
        from reports.figures.height_cost import write_cost_figure  # half a second that other reports need not wait

        write_cost_figure(folder / "report" / "cost.svg", points)
    stacks = first_stacks(folder, records)
    write_replays(folder, stacks)
    if trouble := draw_stills(folder, stacks, however_many=all_stills):
        tell(trouble)
    page = write_page(folder, records, missing_trials(folder, records))
    tell(f"the page of it all: {relative(page)}")
    return tables
