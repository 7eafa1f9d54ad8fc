"""The command line: ``uv run -m bench VERB``. Exit status 0 done, 1 a check failed, 2 bad usage or input."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from adapters import EngineNotInstalledError
from bench.catalogue import print_catalogue
from bench.conformance import check_engine
from bench.environment import describe, digest
from bench.plan import Trial, plan_trials
from bench.policies import BENCH_POLICIES
from bench.progress import show_progress
from bench.results import TRIALS, Results, ResultsError, check_folder
from bench.runner import get_ready, run_trials
from bench.selection import Selection, selected
from bench.studies import Study, StudyError, load_study
from reports.records import RecordError, read_records
from reports.tables import render, study_tables, write_report
from stability_core.lookup import UnknownNameError

INTERRUPTED = 130
"""Exit status after an interrupt, as shells have it."""

app = typer.Typer(
    add_completion=False,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    help="Do your engine's bricks stand when they should, and fall when they should?",
)
_LOG_WIDTH = 110
_out = Console(width=None if sys.stdout.isatty() else _LOG_WIDTH)
_err = Console(stderr=True)


@app.command()
def run(
    study: Annotated[str, typer.Argument(help="A study's name (see 'list') or a TOML file.")] = "paper",
    engine: Annotated[list[str] | None, typer.Option(help="Only this engine; may be repeated.")] = None,
    scenario: Annotated[list[str] | None, typer.Option(help="Only this scenario; may be repeated.")] = None,
    policy: Annotated[list[str] | None, typer.Option(help="Only this policy; may be repeated.")] = None,
    profile: Annotated[list[str] | None, typer.Option(help="This profile of the engines; may be repeated.")] = None,
    seeds: Annotated[int | None, typer.Option(min=1, help="Seeds 0 to N - 1; seed 0 builds exactly.")] = None,
    jobs: Annotated[int, typer.Option(min=1, help="Trials at a time; more than one disturbs the timings.")] = 1,
    out: Annotated[Path | None, typer.Option(help="Results folder [results/STUDY-TIME].")] = None,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="List the trials and write nothing.")] = False,
    fresh: Annotated[bool, typer.Option("--fresh", help="Replace the results that the folder holds.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print records as JSON lines in place of tables.")] = False,
) -> None:
    """Run a study and print what stood and what fell."""
    with _input_errors():
        wanted = Selection(engine or (), scenario or (), policy or (), profile or (), seeds)
        chosen = selected(load_study(study), wanted)
        trials = plan_trials(chosen)
        folder = out or Path("results") / f"{chosen.name}-{datetime.now(UTC):%Y%m%d-%H%M%S}"
        check_folder(folder, fresh)
    if dry_run:
        for trial in trials:
            typer.echo(trial.id)
        _err.print(
            f"{len(trials)} trials of at most {chosen.limits.trial_wall_s:g} s each would be run.", highlight=False
        )
        return
    with _input_errors():
        environment = describe(chosen.engines)
        results = Results(folder, chosen, environment)
    _run(chosen, trials, results, digest(environment), jobs, as_json)
    records = read_records(folder / TRIALS)
    write_report(folder, records)
    if not as_json:
        for table in study_tables(records):
            render(table, _out)
    _err.print(f"{results.kept} trials are kept in {_relative(folder)}", highlight=False, soft_wrap=True)


def _run(study: Study, trials: list[Trial], results: Results, environment: str, jobs: int, as_json: bool) -> None:
    """Run the trials and keep each as it finishes, also when the run is interrupted."""
    try:
        policies = sorted({core for name in study.policies if (core := BENCH_POLICIES[name].core) is not None})
        if policies:
            _err.print("compiling the core once", highlight=False)
        get_ready(policies)
        with show_progress(trials, _err) as progress:
            for outcome in run_trials(trials, study.limits, environment, jobs, progress):
                results.keep(outcome)
                if as_json:
                    typer.echo(outcome.record.model_dump_json())
    except KeyboardInterrupt:
        kept = f"{results.kept} of {len(trials)} trials are kept in {_relative(results.folder)}"
        _err.print(f"interrupted: {kept}", highlight=False, soft_wrap=True)
        raise typer.Exit(INTERRUPTED) from None
    finally:
        results.close()


@app.command()
def report(folder: Annotated[Path, typer.Argument(metavar="DIR", help="A results folder.")]) -> None:
    """Make a folder's tables anew from its raw records, and print them."""
    with _input_errors():
        records = read_records(folder / TRIALS)
        write_report(folder, records)
    for table in study_tables(records):
        render(table, _out)


@app.command(name="list")
def list_() -> None:
    """What can be run: scenarios and what theory says of them, engines, profiles, policies and studies."""
    print_catalogue(_out)


@app.command()
def check(
    engine: Annotated[str, typer.Argument(help="An engine's name.")],
    profile: Annotated[str, typer.Option(help="Profile of the engine.")] = "game",
) -> None:
    """Check that an engine's adapter keeps the contract that the core relies on."""
    with _input_errors():
        failed = check_engine(engine, profile, _out)
    raise typer.Exit(1 if failed else 0)


@contextmanager
def _input_errors() -> Iterator[None]:
    """Input that cannot be used ends the program with its fix, not with a trace."""
    try:
        yield
    except (UnknownNameError, StudyError, ResultsError, RecordError, EngineNotInstalledError, OSError) as error:
        _err.print(f"error: {error}", markup=False, highlight=False, soft_wrap=True)
        raise typer.Exit(2) from error


def _relative(folder: Path) -> str:
    return os.path.relpath(folder)


if __name__ == "__main__":
    app()
