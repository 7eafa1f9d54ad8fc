"""``bench history``: run a study over many versions, and report at which versions figures change."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated

import typer

from adapters.engines import ENGINES
from bench.cli.completion import STUDY
from bench.cli.console import ERR, OUT, RESULTS, input_errors, note, relative
from bench.compare.baseline import read_baseline
from bench.compare.checkouts import checked_out
from bench.execution.results import check_folder
from bench.history.bisection import BisectionError, first_new
from bench.history.build import build_history, read_explanations
from bench.history.figures import Figure, figures_of, first_failure
from bench.history.measure import (
    Measured,
    forget_failed,
    measure_commit,
    measure_release,
    read_measured,
    write_study,
)
from bench.history.publish import publish_history
from bench.history.tracking import tracked_versions
from bench.history.versions import VersionsError, commits, kept_records, released
from bench.machine.source_digest import PUBLISHED
from bench.studies.schema import Study, load_study
from bench.studies.selection import Selection, selected
from reports.page.history_page import failures_table, steps_table, write_history_page
from reports.records.atomic import write_atomic
from reports.records.history import HISTORY, History, write_history
from reports.tables.table import render
from scenarios.lookup import look_up


def history(
    engine: Annotated[str | None, typer.Option(help="The engine whose releases, or whose trials, to compare.")] = None,
    versions: Annotated[
        str | None, typer.Option(help="Releases of its package: all, a range 3.0..4.0, or 3.3.0,4.0.0.")
    ] = None,
    commit_range: Annotated[
        str | None, typer.Option("--commits", metavar="A..B", help="Commits of this repository instead.")
    ] = None,
    records: Annotated[
        str | None,
        typer.Option(metavar="BRANCH:PATH", help="Baseline files that the commits of a branch kept: runs nothing."),
    ] = None,
    study: Annotated[str, typer.Option(help="The study that every version runs.", autocompletion=STUDY)] = "history",
    out: Annotated[Path | None, typer.Option(help="Folder of the history [results/history-ENGINE].")] = None,
    bisect: Annotated[
        str | None, typer.Option(metavar="FIGURE", help="Find only the first version with the new value of a figure.")
    ] = None,
    explain: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Quoted lines of changelogs that explain steps (TOML).")
    ] = None,
    track: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Also write the figures for benchmark-tracking actions.")
    ] = None,
    publish: Annotated[bool, typer.Option("--publish", help="Copy the page into docs/results/history.")] = False,
    retry: Annotated[bool, typer.Option("--retry", help="Run the versions that failed again.")] = False,
    keep: Annotated[bool, typer.Option("--keep", help="Keep the environments of the releases.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the history as JSON instead of tables.")] = False,
) -> None:
    """Run a study over releases or commits, or read kept records; write one page with every step and its version."""
    with input_errors():
        _check_sources(engine, versions, commit_range, records)
        folder = out or RESULTS / f"history-{engine or 'stillstack'}"
        check_folder(folder)
        quotes = read_explanations(explain) if explain else []
        if retry:
            forget_failed(folder)
        package, commit = "", ""
        if records is not None:
            measured = [_of_record(name, content, engine) for name, content in kept_records(records)]
        else:
            plan = selected(load_study(study), Selection((engine,) if engine else (), (), (), (), None, None))
            names, measure, package, commit = _runs(plan, engine, versions, commit_range, folder, keep)
            if bisect is not None:
                _bisect(bisect, names, measure, folder)
                return
            for name in names:
                measure(name)
            measured = [read_measured(name, folder) for name in names]
        built = build_history(
            measured,
            subject=engine or "stillstack",
            package=package,
            study=study,
            commit=commit,
            explanations=quotes,
        )
        write_history(folder / HISTORY, built)
        write_history_page(folder / "index.html", built)
        if track is not None:
            write_atomic(track, (json.dumps(tracked_versions(built), indent=1) + "\n").encode())
        if publish:
            note(f"published in {relative(publish_history(built, folder, PUBLISHED / 'history', explain))}")
    note(f"the page is {relative(folder / 'index.html')}")
    _show(built, as_json)


def _check_sources(engine: str | None, versions: str | None, commit_range: str | None, records: str | None) -> None:
    """Check that the user names one source of versions, no unknown engine, and an engine for releases.

    Raises:
        UnknownNameError: if no engine has the given name.
        VersionsError: if the user names no source or several sources, or releases without an engine.
    """
    if engine is not None:
        look_up("engine", engine, ENGINES)
    sources = {"--versions": versions, "--commits": commit_range, "--records": records}
    given = [option for option, source in sources.items() if source is not None]
    if len(given) != 1:
        raise VersionsError(
            f"a history needs exactly one source of versions, got {', '.join(given) or 'none'}: give one of "
            "--versions, --commits or --records"
        )
    if versions is not None and engine is None:
        raise VersionsError(
            f"--versions {versions} needs the engine whose releases to compare, got no --engine: add --engine NAME, "
            "such as --engine mujoco"
        )


def _runs(
    plan: Study, engine: str | None, versions: str | None, commit_range: str | None, folder: Path, keep: bool
) -> tuple[list[str], Callable[[str], None], str, str]:
    """Return the names of the versions, the function that measures a version, the package and the suite's commit.

    Package and commit are empty for commits of this repository.

    Raises:
        VersionsError: if the engine has no Python package, or the range names no versions.
    """
    if commit_range is not None:
        names = commits(commit_range)
        file = write_study(plan, folder)
        return names, lambda name: measure_commit(name, plan, file, folder, ERR), "", ""
    package = getattr(ENGINES[str(engine)], "package", None)
    if package is None or package.startswith("@"):
        raise VersionsError(
            f"--versions needs an engine with a Python package, but engine '{engine}' has none: give --commits or "
            "--records instead of --versions, or another engine with --engine"
        )
    names = released(package, str(versions))
    suite = checked_out("HEAD", ERR)
    file = write_study(plan, folder)

    def measure(name: str) -> None:
        measure_release(str(engine), package, name, suite, file, folder, ERR, keep=keep)

    return names, measure, package, suite.name


def _of_record(name: str, content: bytes, engine: str | None) -> Measured:
    """Return the figures in the ``content`` of a baseline file; ``engine`` limits the figures to one engine."""
    with TemporaryDirectory() as scratch:
        path = Path(scratch, "baseline.json")
        path.write_bytes(content)
        side = read_baseline(path)
    trials = [one for one in side.trials if engine in (None, one.engine)]
    processors = sorted({machine.processor for machine in side.machines.values()})
    failure = first_failure(trials) if trials else f"no trial of {engine}"
    return Measured(name, () if failure else tuple(figures_of(trials)), failure, (), " and ".join(processors))


def _bisect(figure: str, names: Sequence[str], measure: Callable[[str], None], folder: Path) -> None:
    """Print the first version with the new value of a figure."""
    known: dict[str, Figure] = {}

    def value(index: int) -> float | None:
        measure(names[index])
        measured = read_measured(names[index], folder)
        found = {one.name: one for one in measured.figures}
        known.update(found)
        if found:
            look_up("figure", figure, found)
        note(f"{names[index]}: {found[figure].value if found else measured.message}")
        return found[figure].value if found else None

    if len(names) == 1:
        raise BisectionError(
            f"--bisect needs at least two versions, got only {names[0]}: name more versions with --versions"
        )
    for end in (0, len(names) - 1):
        value(end)
    if figure not in known:
        raise BisectionError(
            f"the first and the last version, {names[0]} and {names[-1]}, must have a value of '{figure}', but neither "
            "has any figure: name other versions with --versions or --commits"
        )
    result = first_new(names, value, known[figure])
    skipped = ", ".join(names[index] for index in result.untested)
    OUT.print(
        f"first version with the new {figure}: {names[result.first_new]}; last with the old: {names[result.last_old]}"
        + (f"; without a value between both: {skipped}" if skipped else ""),
        highlight=False,
    )


def _show(built: History, as_json: bool) -> None:
    if as_json:
        typer.echo(built.model_dump_json(indent=1))
        return
    render(steps_table(built), OUT)
    if any(point.message for point in built.points):
        render(failures_table(built), OUT)
