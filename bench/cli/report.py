"""``bench report``: write the page, figures and tables of a results folder."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from bench.cli.console import OUT, input_errors, note, printed_warnings, relative
from bench.execution.results import missing_trials
from reports.records.folder import ResultsFolder
from reports.tables.table import Table, render


def report(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="A results folder.")],
    stills: Annotated[bool, typer.Option("--stills", help="Draw the final state of all trials, however many.")] = False,
) -> None:
    """Write the page, figures and tables of a results folder from its raw records, and print the tables."""
    with input_errors():
        tables = make_report(folder, all_stills=stills)
    for table in tables:
        render(table, OUT)


def make_report(folder: Path, *, all_stills: bool = False) -> tuple[Table, ...]:
    """Write the report of a results folder, print its notices, and return the tables to print."""
    from reports.report import build_report  # its imports take seconds, and other commands do not need them

    results = ResultsFolder(folder)
    with printed_warnings():
        missing = missing_trials(folder, results.records)
    made = build_report(results, missing, all_stills=all_stills)
    for notice in made.notices:
        note(notice)
    note(f"the page: {relative(made.page)}")
    return made.tables
