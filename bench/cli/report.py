"""``bench report``: write the page, figures and tables of a results folder."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from bench.cli.console import OUT, input_errors, note, printed_warnings, relative
from bench.execution.results import missing_trials
from reports.records.folder import ResultsFolder
from reports.tables.table import first_rows, render, with_short_notes

if TYPE_CHECKING:
    from reports.report import Report

_PLACES = 8
"""Greatest number of places of the ranking that the terminal shows. The files of the report contain all places."""

_NOTE = 700
"""Greatest length of a note on the terminal [characters]. ``tables.md`` contains the whole notes."""


def report(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="A results folder.")],
    stills: Annotated[bool, typer.Option("--stills", help="Draw the final state of all trials, however many.")] = False,
    single: Annotated[
        bool, typer.Option("--single", help="Write the page also as one file with stills and replays inside.")
    ] = False,
) -> None:
    """Write the page, figures and tables of a results folder; print the tables and then the verdict."""
    with input_errors():
        made = make_report(folder, all_stills=stills)
        if single:
            from reports.page.single import write_single  # only this option needs its imports

            note(f"the page as one file: {relative(write_single(made.page))}")
    show(made)


def make_report(folder: Path, *, all_stills: bool = False) -> Report:
    """Write the report of a results folder, print its notices, and return the report."""
    from reports.report import build_report  # its imports take seconds, and other commands do not need them

    results = ResultsFolder(folder)
    with printed_warnings():
        missing = missing_trials(folder, results.records)
    made = build_report(results, missing, all_stills=all_stills)
    for notice in made.notices:
        note(notice)
    note(f"the page: {relative(made.page)}")
    return made


def show(report: Report) -> None:
    """Print the tables of a report, the first places of the ranking, and then the verdict."""
    for table in report.tables:
        render(with_short_notes(table, _NOTE), OUT)
    if report.ranking.rows:
        render(first_rows(report.ranking, _PLACES), OUT)
    style = "bold green" if report.is_all_right else "bold yellow"
    OUT.print(report.verdict, style=style, markup=False, highlight=False, soft_wrap=True)
