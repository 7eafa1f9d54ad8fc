"""The command line: ``uv run -m bench VERB``. Exit status 0 done, 1 a check failed, 2 bad usage or input."""

from __future__ import annotations

import io
import json
import os
import sys
import warnings
import webbrowser
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated, TypeAlias

import typer
from rich.console import Console

from adapters import EngineNotInstalledError, ProfileError
from bench.catalogue import print_catalogue
from bench.compare import showing
from bench.compare.baseline import BaselineError, read_baseline, write_baseline
from bench.compare.benchmarks import are_benchmarks, compare_benchmarks, read_benchmarks
from bench.compare.checkouts import CheckoutError, prepare
from bench.compare.comparison import NothingInCommonError, compare_runs
from bench.compare.findings import GATES, chosen_gates
from bench.compare.interleaved import run_interleaved
from bench.compare.tracking import tracked
from bench.conformance import check_engine
from bench.environment import describe
from bench.estimate import estimate
from bench.interruption import Interruption
from bench.plan import Trial, plan_trials
from bench.replaying import export_gltf, replay_trial
from bench.results import Results, ResultsError, check_folder, missing_trials
from bench.running import ClusterError, outcomes_here, outcomes_on_cluster
from bench.selection import Selection, selected
from bench.studies import Study, StudyError, load_study
from bench.trial import Outcome
from reports.records.atomic import write_atomic
from reports.records.folder import TRIALS, ResultsFolder
from reports.records.recording import RecordingError
from reports.records.trial import RecordError, RecordWarning, TrialRecord
from reports.report import build_report
from reports.tables.table import Table, render
from scenarios.registry import SCENARIOS, build
from stability_core.lookup import UnknownNameError

app = typer.Typer(
    add_completion=False,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    help="Do your engine's bricks stand when they should, and fall when they should?",
)
RESULTS = Path("results")
"""Where a run leaves its results unless told otherwise; estimates are made from what lies there."""
Outcomes: TypeAlias = Callable[[Sequence[Trial], Interruption], Iterator[Outcome]]
"""Runs trials until they are done or a wish to stop is noted."""
_LOG_WIDTH = 110
for _stream in (sys.stdout, sys.stderr):  # a terminal that has no such letters shows their codes
    if isinstance(_stream, io.TextIOWrapper):
        _stream.reconfigure(errors="backslashreplace")
_out = Console(width=None if sys.stdout.isatty() else _LOG_WIDTH)
_err = Console(stderr=True)


@app.command()
def run(
    study: Annotated[str, typer.Argument(help="A study's name (see 'list') or a TOML file.")] = "paper",
    engine: Annotated[list[str] | None, typer.Option(help="Only this engine; may be repeated.")] = None,
    scenario: Annotated[
        list[str] | None,
        typer.Option(help="Only this scenario, or FILE.toml with bricks of your own; may be repeated."),
    ] = None,
    policy: Annotated[list[str] | None, typer.Option(help="Only this policy; may be repeated.")] = None,
    profile: Annotated[
        list[str] | None, typer.Option(help="This profile, or one varied: game@scale=10; may be repeated.")
    ] = None,
    seeds: Annotated[int | None, typer.Option(min=1, help="Seeds 0 to N - 1; seed 0 builds exactly.")] = None,
    jobs: Annotated[int, typer.Option(min=1, help="Trials at a time; more than one disturbs the timings.")] = 1,
    dask: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="Run the trials on the Dask cluster with this scheduler.")
    ] = None,
    out: Annotated[Path | None, typer.Option(help="Results folder [results/STUDY-TIME].")] = None,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="List the trials and how long they take; write nothing.")
    ] = False,
    fresh: Annotated[bool, typer.Option("--fresh", help="Replace the trials that the folder holds.")] = False,
    accept_changes: Annotated[
        bool, typer.Option("--accept-changes", help="Go on with a folder although study, commit or machine changed.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print records as JSON lines in place of tables.")] = False,
) -> None:
    """Run a study, or go on with one that was cut off, and print what stood and what fell."""
    with _input_errors():
        wanted = Selection(engine or (), scenario or (), policy or (), profile or (), seeds)
        if dask is not None and jobs > 1:
            raise ClusterError("--jobs is for this machine: on a cluster the workers' threads say how many trials run")
        chosen = selected(load_study(study), wanted)
        trials = plan_trials(chosen)
        folder = out or RESULTS / f"{chosen.name}-{datetime.now(UTC):%Y%m%d-%H%M%S}"
        check_folder(folder)
        if dry_run:
            _show_plan(trials, chosen, folder, fresh, jobs)
            return
        environment = describe(chosen.engines)
        results = Results(folder, chosen, environment, fresh=fresh, accept_changes=accept_changes)

        def outcomes(waiting: Sequence[Trial], interruption: Interruption) -> Iterator[Outcome]:
            if dask is None:
                return outcomes_here(chosen, waiting, environment, jobs, interruption, _err)
            return outcomes_on_cluster(chosen, waiting, environment, dask, interruption, _err, results.know)

        _run(trials, results, outcomes, as_json)
    tables = _report(folder)
    if not as_json:
        for table in tables:
            render(table, _out)
    _tell(f"{len(results.finished)} trials are kept in {_relative(folder)}")


def _show_plan(trials: list[Trial], study: Study, folder: Path, fresh: bool, jobs: int) -> None:
    """List the trials that a run would run, and tell how long they will take."""
    kept = set() if fresh or not (folder / TRIALS).exists() else {one.trial for one in _records(folder)}
    waiting = [trial for trial in trials if trial.id not in kept]
    for trial in waiting:
        typer.echo(trial.id)
    earlier = sorted(path.parent for path in RESULTS.glob(f"*/{TRIALS}"))
    _tell(estimate(waiting, study.limits.trial_wall_s, dict.fromkeys([*earlier, folder])).told(jobs))
    if len(waiting) < len(trials):
        _tell(f"{len(trials) - len(waiting)} more are already there")


def _run(trials: Sequence[Trial], results: Results, outcomes: Outcomes, as_json: bool) -> None:
    """Run the trials that are not yet kept and keep each as it finishes, also when the run is cut off."""
    waiting = [trial for trial in trials if trial.id not in results.finished]
    if results.torn:
        _tell("the last line of trials.jsonl was torn by a cut: that trial is run again")
    if len(waiting) < len(trials):
        _tell(f"going on: {len(trials) - len(waiting)} of {len(trials)} trials are already there")
    with Interruption() as interruption:
        try:
            for outcome in outcomes(waiting, interruption) if waiting else ():
                results.keep(outcome)
                if as_json:
                    typer.echo(outcome.record.model_dump_json())
        finally:
            results.close()
            kept = sum(trial.id in results.finished for trial in trials)
            if kept < len(trials):
                _tell(f"interrupted: {kept} of {len(trials)} trials are kept in {_relative(results.folder)}")
                _tell(f"to go on, run the same with --out {_relative(results.folder)}")
        if interruption.is_set():
            raise typer.Exit(interruption.exit_status)


@app.command()
def report(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="A results folder.")],
    stills: Annotated[bool, typer.Option("--stills", help="Draw the final state of all trials, however many.")] = False,
) -> None:
    """Make a folder's page, pictures and tables anew from its raw records, and print the tables."""
    with _input_errors():
        tables = _report(folder, all_stills=stills)
    for table in tables:
        render(table, _out)


@app.command()
def replay(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="A results folder.")],
    trial: Annotated[str, typer.Argument(help="Id of one of its trials.")],
    show: Annotated[bool, typer.Option("--open/--no-open", help="Open it in the browser.")] = True,
    gltf: Annotated[
        Path | None, typer.Option(metavar="FILE.glb", help="Write the trial as animated glTF in place of a replay.")
    ] = None,
) -> None:
    """Show a trial in the browser, side by side with the other policies on the same stack."""
    with _input_errors():
        if gltf is not None:
            export_gltf(folder, _records(folder), trial, gltf)
            _tell(f"the animation is {_relative(gltf)}")
            return
        page = replay_trial(folder, _records(folder), trial)
    _tell(f"the replay is {_relative(page)}")
    if show and not webbrowser.open(page.resolve().as_uri()):
        _tell("no browser could be opened: open that file in one")


def _report(folder: Path, *, all_stills: bool = False) -> tuple[Table, ...]:
    """Write a folder's report; returns the tables that are printed."""
    results = ResultsFolder(folder)
    with _told_warnings():
        missing = missing_trials(folder, results.records)
    made = build_report(results, missing, all_stills=all_stills)
    for notice in made.notices:
        _tell(notice)
    _tell(f"the page of it all: {_relative(made.page)}")
    return made.tables


def _records(folder: Path) -> list[TrialRecord]:
    """A folder's records; a torn last line is told in a line of its own."""
    with _told_warnings():
        return ResultsFolder(folder).records


@contextmanager
def _told_warnings() -> Iterator[None]:
    """Print the warnings of records that are read."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", RecordWarning)
        yield
    for warning in caught:
        _tell(f"warning: {warning.message}")


@app.command()
def baseline(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="A results folder.")],
    out: Annotated[Path, typer.Option("-o", "--out", metavar="FILE", help="The baseline to write, or to replace.")],
    track: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write figures for benchmark-tracking actions, too.")
    ] = None,
) -> None:
    """Keep in one small file what later runs are held against."""
    with _input_errors():
        side = read_baseline(folder)
        write_baseline(side, out)
        if track is not None:
            write_atomic(track, (json.dumps(tracked(side), indent=1) + "\n").encode())
    _tell(f"{len(side.trials)} trials are kept in {_relative(out)}")


@app.command()
def compare(
    base: Annotated[
        str,
        typer.Argument(
            help="What is expected: a results folder, a baseline file or a file of pytest-benchmark; a version (--run)."
        ),
    ],
    head: Annotated[str, typer.Argument(help="What is judged: the same.")],
    fail_on: Annotated[str, typer.Option(help="Gates whose alarms end with status 1, or 'none'.")] = ",".join(GATES),
    across_versions: Annotated[
        bool, typer.Option("--across-versions", help="Judge the outcomes of another version of an engine, too.")
    ] = False,
    markdown: Annotated[Path | None, typer.Option(metavar="FILE", help="Write the tables as Markdown.")] = None,
    junit: Annotated[Path | None, typer.Option(metavar="FILE", help="Write JUnit XML.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON in place of tables.")] = False,
    run_both: Annotated[
        bool, typer.Option("--run", help="BASE and HEAD are commits, branches, tags or checkouts: run both here.")
    ] = False,
    study: Annotated[str, typer.Option(help="With --run: the study that both run.")] = "smoke",
    rounds: Annotated[int, typer.Option(min=1, max=100, help="With --run: how often each runs it, in turns.")] = 2,
    base_with: Annotated[list[str] | None, typer.Option(help="With --run: a package or wheel for BASE.")] = None,
    head_with: Annotated[list[str] | None, typer.Option(help="With --run: a package or wheel for HEAD.")] = None,
    out: Annotated[Path | None, typer.Option(help="With --run: results folder [results/compare-TIME].")] = None,
) -> None:
    """Did stacking get worse, did trajectories change, did it get slower? Status 1 if so."""
    with _input_errors():
        gates = chosen_gates(fail_on)
        if run_both:
            plan = load_study(study)
            folder = out or RESULTS / f"compare-{datetime.now(UTC):%Y%m%d-%H%M%S}"
            check_folder(folder)
            versions = prepare(base, base_with or (), _err), prepare(head, head_with or (), _err)
            sides = run_interleaved(versions, plan, rounds, folder, _err)
            comparison = compare_runs(*sides, (base, head), across_versions=across_versions)
        elif are_benchmarks(Path(base), Path(head)):
            gates = tuple(gate for gate in gates if gate == "time")
            frame_times = read_benchmarks(Path(base)), read_benchmarks(Path(head))
            comparison = compare_benchmarks(*frame_times, across_versions=across_versions)
        else:
            sides = read_baseline(Path(base)), read_baseline(Path(head))
            comparison = compare_runs(*sides, (base, head), across_versions=across_versions)
        if markdown is not None:
            write_atomic(markdown, showing.markdown(comparison, gates).encode())
        if junit is not None:
            write_atomic(junit, showing.junit(comparison, gates))
    if as_json:
        typer.echo(showing.as_json(comparison, gates))
    else:
        showing.show(comparison, gates, _out)
    raise typer.Exit(1 if comparison.alarms(gates) else 0)


@app.command(name="list")
def list_(
    pictures: Annotated[bool, typer.Option("--pictures", help="Draw every scene on one sheet instead.")] = False,
    out: Annotated[Path, typer.Option(help="Where the sheet goes; .png, .svg or .pdf.")] = Path("scenes.png"),
) -> None:
    """What can be run: scenarios and what theory says of them, engines, profiles, policies and studies."""
    if not pictures:
        print_catalogue(_out)
        return
    from bench.contact_sheet import draw_contact_sheet  # a second of imports that nothing else needs

    draw_contact_sheet(out, [build(name) for name in SCENARIOS])
    _tell(f"{len(SCENARIOS)} scenes drawn in {out}")


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
    except (
        UnknownNameError,
        StudyError,
        ResultsError,
        RecordError,
        RecordingError,
        EngineNotInstalledError,
        ProfileError,
        ClusterError,
        BaselineError,
        CheckoutError,
        NothingInCommonError,
        OSError,
    ) as error:
        _err.print(f"error: {error}", markup=False, highlight=False, soft_wrap=True)
        raise typer.Exit(2) from error


def _tell(text: str) -> None:
    _err.print(text, highlight=False, soft_wrap=True)


def _relative(folder: Path) -> str:
    return os.path.relpath(folder)
