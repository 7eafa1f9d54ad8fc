"""``bench compare``: compare two runs, baselines, benchmark files or versions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from bench.cli.alarm_pictures import draw_alarms
from bench.cli.completion import STUDY
from bench.cli.console import ERR, OUT, RESULTS, input_errors, note
from bench.compare import render
from bench.compare.baseline import of_engines, read_baseline
from bench.compare.benchmarks import are_benchmarks, compare_benchmarks, read_benchmarks
from bench.compare.checkouts import Checkout, named_by_difference, prepare, prune_checkouts
from bench.compare.comparison import compare_runs
from bench.compare.environments import prune_environments
from bench.compare.findings import GATES, chosen_gates
from bench.compare.interleave import run_interleaved
from bench.execution.results import check_folder
from bench.studies.schema import Study, load_study, study_names
from bench.studies.selection import Selection, default_part, selected
from reports.records.atomic import write_atomic


def compare(
    base: Annotated[
        str,
        typer.Argument(
            help="The base: a results folder, a baseline file or a pytest-benchmark file; with --run a version."
        ),
    ] = "",
    head: Annotated[str, typer.Argument(help="The head: the same kinds as BASE.")] = "",
    fail_on: Annotated[str, typer.Option(help="Gates whose alarms give exit status 1, or 'none'.")] = ",".join(GATES),
    across_versions: Annotated[
        bool, typer.Option("--across-versions", help="Also judge trials whose engine has another version.")
    ] = False,
    poses: Annotated[
        bool, typer.Option("--poses", help="As --across-versions; also judge whether poses changed between versions.")
    ] = False,
    engine: Annotated[list[str] | None, typer.Option(help="Compare only this engine; may be repeated.")] = None,
    require_all: Annotated[
        bool, typer.Option("--require-all", help="A trial of BASE that HEAD does not have is an alarm.")
    ] = False,
    markdown: Annotated[Path | None, typer.Option(metavar="FILE", help="Write the tables as Markdown.")] = None,
    junit: Annotated[Path | None, typer.Option(metavar="FILE", help="Write JUnit XML.")] = None,
    pictures: Annotated[
        Path | None,
        typer.Option(metavar="FOLDER", help="Draw the stacks with a worse outcome; HEAD must be a results folder."),
    ] = None,
    pictures_at: Annotated[
        str, typer.Option(metavar="URL", help="Address of that folder in the Markdown [FOLDER].")
    ] = "",
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON instead of tables.")] = False,
    run_both: Annotated[
        bool, typer.Option("--run", help="BASE and HEAD are commits, branches, tags or checkouts: run both here.")
    ] = False,
    study: Annotated[str, typer.Option(help="With --run: the study that both run.", autocompletion=STUDY)] = "smoke",
    rounds: Annotated[int, typer.Option(min=1, max=100, help="With --run: runs of each version, alternating.")] = 2,
    base_with: Annotated[
        list[str] | None, typer.Option(help="With --run: a package or wheel to install for BASE.")
    ] = None,
    head_with: Annotated[
        list[str] | None, typer.Option(help="With --run: a package or wheel to install for HEAD.")
    ] = None,
    out: Annotated[Path | None, typer.Option(help="With --run: results folder [results/compare-TIME].")] = None,
    allow_dirty: Annotated[
        bool, typer.Option("--allow-dirty", help="With --run: accept uncommitted changes of a checkout.")
    ] = False,
    prune: Annotated[
        bool, typer.Option("--prune", help="Remove the kept checkouts and environments; compare nothing.")
    ] = False,
) -> None:
    """Compare two runs for regressions of outcome, trajectory and time; exit status 1 if a gate raises an alarm."""
    if prune:
        _prune()
        return
    if not (base and head):
        got = f"only {base or head}" if base or head else "neither"
        raise typer.BadParameter(
            f"a comparison needs BASE and HEAD, got {got}: name both, or remove the kept checkouts with --prune"
        )
    if pictures is not None and (run_both or not Path(head).is_dir()):
        raise typer.BadParameter(
            f"--pictures needs a results folder as HEAD, because only a results folder has recordings, got {head!r}"
            f"{' with --run' if run_both else ''}: leave out --pictures, or give a results folder as HEAD"
            f"{' without --run' if run_both else ''}"
        )
    with input_errors():
        gates = chosen_gates(fail_on)
        judge = partial(compare_runs, across_versions=across_versions, poses=poses, require_all=require_all)
        if run_both:
            plan = default_part(load_study(study)) if study in study_names() else load_study(study)
            plan = selected(plan, Selection(engine or ()))
            folder = out or RESULTS / f"compare-{datetime.now(UTC):%Y%m%d-%H%M%S}"
            check_folder(folder)
            packages = tuple(base_with or ()), tuple(head_with or ())
            versions = _prepared((base, head), packages, plan, allow_dirty)
            sides = run_interleaved(versions, plan, rounds, folder, ERR)
            comparison = judge(*sides, (versions[0].name, versions[1].name))
        elif are_benchmarks(Path(base), Path(head)):
            gates = tuple(gate for gate in gates if gate == "time")
            frame_times = read_benchmarks(Path(base)), read_benchmarks(Path(head))
            comparison = compare_benchmarks(*frame_times, across_versions=across_versions)
        else:
            sides = (
                of_engines(read_baseline(Path(base)), engine, base),
                of_engines(read_baseline(Path(head)), engine, head),
            )
            comparison = judge(*sides, (base, head))
        drawn = draw_alarms(comparison, gates, Path(head), pictures) if pictures is not None else []
        if markdown is not None:
            shown = [(trial, f"{pictures_at or pictures}/{file.name}") for trial, file in drawn]
            write_atomic(markdown, render.markdown(comparison, gates, shown).encode())
        if junit is not None:
            write_atomic(junit, render.junit(comparison, gates))
    if as_json:
        typer.echo(render.as_json(comparison, gates))
    else:
        render.show(comparison, gates, OUT)
    raise typer.Exit(1 if comparison.alarms(gates) else 0)


def _prepared(
    versions: tuple[str, str], packages: tuple[Sequence[str], Sequence[str]], plan: Study, allow_dirty: bool
) -> tuple[Checkout, Checkout]:
    """Return the checkouts of base and head, with names that state their differences."""
    base, head = (
        prepare(version, chosen, ERR, engines=plan.engines, allow_dirty=allow_dirty, option="--allow-dirty")
        for version, chosen in zip(versions, packages, strict=True)
    )
    names = named_by_difference((base, head), packages)
    return replace(base, name=names[0]), replace(head, name=names[1])


def _prune() -> None:
    """Remove all checkouts and environments from the cache, and print how many of each."""
    with input_errors():
        checkouts, environments = prune_checkouts(ERR), prune_environments()
    note(f"removed {checkouts} checkouts and {len(environments)} environments")
