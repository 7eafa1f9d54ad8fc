"""``bench run``: run a study, or continue an interrupted run."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated, TypeAlias

import typer

from adapters import check_installed
from bench.cli.completion import ENGINE, POLICY, PROFILE, SCENARIO, STUDY
from bench.cli.console import ERR, RESULTS, input_errors, note, read_folder, relative
from bench.cli.report import make_report, show
from bench.execution.errors import ClusterError
from bench.execution.estimate import estimate
from bench.execution.execute import outcomes_here, outcomes_on_cluster
from bench.execution.results import Results, check_folder
from bench.execution.signals import Interruption
from bench.machine.calibration import speed_now
from bench.machine.environment import describe
from bench.machine.source_digest import PUBLISHED
from bench.studies.plan import Trial, later_trials, plan_trials, waiting_trials
from bench.studies.schema import Study, load_study, study_names
from bench.studies.selection import Selection, installed_part, selected
from bench.trial.run_trial import Outcome
from reports.records.folder import PARQUET, TRIALS
from reports.replays.live_view import open_viewer, require_rerun

_VIEWER_PORT = 9876
"""Port of Rerun's viewer: Rerun's default port, so that the run uses a viewer that is already open at this port."""
Outcomes: TypeAlias = Callable[[Sequence[Trial], Interruption], Iterator[Outcome]]
"""Type of a function that runs trials until all are done or an interruption is set, and yields their outcomes."""


def run(
    study: Annotated[
        str, typer.Argument(help="A study's name (see 'list') or a TOML file.", autocompletion=STUDY)
    ] = "paper",
    engine: Annotated[
        list[str] | None, typer.Option(help="Only this engine; may be repeated.", autocompletion=ENGINE)
    ] = None,
    scenario: Annotated[
        list[str] | None,
        typer.Option(
            help="Only this scenario, or a FILE with your own bricks (.toml, .xml, .urdf, .usd); may be repeated.",
            autocompletion=SCENARIO,
        ),
    ] = None,
    policy: Annotated[
        list[str] | None, typer.Option(help="Only this policy; may be repeated.", autocompletion=POLICY)
    ] = None,
    profile: Annotated[
        list[str] | None,
        typer.Option(
            help="Only this profile, or a variation of it: game@scale=10; may be repeated.", autocompletion=PROFILE
        ),
    ] = None,
    seeds: Annotated[
        int | None, typer.Option(min=1, help="Run seeds 0 to N - 1; seed 0 has no placement noise.")
    ] = None,
    hours: Annotated[
        float | None,
        typer.Option(min=1e-3, help="Simulated time [h] for which every trial is watched, for studies such as 'soak'."),
    ] = None,
    jobs: Annotated[
        int, typer.Option(min=1, help="Number of concurrent trials; more than 1 disturbs the timings.")
    ] = 1,
    dask: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="Run the trials on the Dask cluster with this scheduler.")
    ] = None,
    out: Annotated[Path | None, typer.Option(help="Results folder [results/STUDY-TIME].")] = None,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="List the trials and estimate their duration; write nothing.")
    ] = False,
    fresh: Annotated[bool, typer.Option("--fresh", help="Replace the trials that the folder holds.")] = False,
    accept_changes: Annotated[
        bool, typer.Option("--accept-changes", help="Continue in a folder although study, commit or machine changed.")
    ] = False,
    watch: Annotated[
        bool, typer.Option("--watch", help="Show the running trials in Rerun's viewer, which disturbs the timings.")
    ] = False,
    watch_at: Annotated[
        str | None,
        typer.Option(metavar="ADDRESS", help="Show them in the open viewer at rerun+http://HOST:PORT/proxy."),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print records as JSON lines instead of tables.")] = False,
    no_report: Annotated[bool, typer.Option("--no-report", help="Write the records only: no tables, no page.")] = False,
) -> None:
    """Run a study, or continue an interrupted run, and print the outcomes."""
    with input_errors():
        wanted = Selection(engine or (), scenario or (), policy or (), profile or (), seeds, hours)
        if dask is not None and jobs > 1:
            raise ClusterError(
                "--jobs and --dask exclude each other, because --jobs applies to this machine only: leave out "
                "--jobs, and start each worker with --nthreads"
            )
        if dask is not None and (watch or watch_at):
            raise ClusterError(
                "--watch applies to trials on this machine only, as --watch-at does, but --dask is given: leave out "
                "--watch and --watch-at, or leave out --dask"
            )
        chosen = selected(load_study(study), wanted)
        if study in study_names() and not engine:
            chosen, missing = installed_part(chosen)
            for reason in missing:
                note(f"left out: {reason}")
        else:
            for name in chosen.engines:
                check_installed(name)
        folder = out or RESULTS / f"{chosen.name}-{datetime.now(UTC):%Y%m%d-%H%M%S}"
        check_folder(folder)
        if dry_run:
            _show_plan(chosen, folder, fresh, jobs)
            return
        viewer = _viewer(watch, watch_at)
        environment = describe(chosen.engines)
        results = Results(folder, chosen, environment, fresh=fresh, accept_changes=accept_changes)

        def outcomes(waiting: Sequence[Trial], interruption: Interruption) -> Iterator[Outcome]:
            if dask is None:
                return outcomes_here(chosen, waiting, environment, jobs, interruption, ERR, viewer=viewer)
            return outcomes_on_cluster(chosen, waiting, environment, dask, interruption, ERR, results.know)

        _run(chosen, results, outcomes, as_json)
    report = None if no_report else make_report(folder)
    note(f"{len(results.finished)} trials are kept in {relative(folder)}")
    if report is not None and not as_json:
        show(report)


def _viewer(opens: bool, address: str | None) -> str | None:
    """Return the address of the Rerun viewer, or None without a viewer.

    Without an ``address``, open a viewer if ``opens`` is True.
    """
    if address is not None:
        require_rerun()
        return address
    return open_viewer(_VIEWER_PORT) if opens else None


def _show_plan(study: Study, folder: Path, fresh: bool, jobs: int) -> None:
    """List the trials that the run would execute, and print their estimated duration."""
    kept = {} if fresh or not (folder / TRIALS).exists() else {one.trial: one.status for one in read_folder(folder)}
    waiting = waiting_trials(study, kept)
    for trial in waiting:
        typer.echo(trial.id)
    known = {trial.id for trial in plan_trials(study)}
    later = later_trials(study)[len(kept.keys() - known) :]
    earlier = sorted(path.parent for path in RESULTS.glob(f"*/{TRIALS}"))
    published = sorted(path.parent for path in PUBLISHED.glob(f"*/{PARQUET}"))
    now = speed_now()
    expected = estimate(
        [*waiting, *later],
        study.limits.trial_wall_s,
        dict.fromkeys([*earlier, folder, *published]),
        calibration_ms=now.calibration_ms,
        busy=now.busy,
    )
    note(expected.summary(jobs))
    if kept:
        note(f"{len(kept)} more trials are already in the folder")
    if later:
        note(f"up to {len(later)} of these are later steps of a bisection, which depend on the outcomes of the others")


def _run(study: Study, results: Results, outcomes: Outcomes, as_json: bool) -> None:
    """Run the trials that have no record, and write each outcome at once.

    If trials are left, print how to continue. After an interruption, exit with the status of its signal.
    """
    waiting = waiting_trials(study, results.statuses)
    if results.torn:
        note("the last line of trials.jsonl is incomplete after an interruption: the run repeats that trial")
    if there := len(results.finished):
        note(f"continuing: {there} of {there + len(waiting)} trials are already in the folder")
    with Interruption() as interruption:
        try:
            while waiting and not interruption.is_set():
                for outcome in outcomes(waiting, interruption):
                    results.keep(outcome)
                    if as_json:
                        typer.echo(outcome.record.model_dump_json())
                waiting = waiting_trials(study, results.statuses)
        finally:
            results.close()
            if left := len(waiting_trials(study, results.statuses)):
                kept = len(results.finished)
                note(f"interrupted: {kept} of {kept + left} trials are kept in {relative(results.folder)}")
                note(f"to continue, run the same command with --out {relative(results.folder)}")
        if interruption.is_set():
            raise typer.Exit(interruption.exit_status)
