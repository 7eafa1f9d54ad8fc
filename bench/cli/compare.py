"""``bench compare``: compare two runs, baselines, benchmark files or versions."""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated

import typer

from bench.cli.completion import STUDY
from bench.cli.console import ERR, OUT, RESULTS, input_errors
from bench.compare import render
from bench.compare.baseline import read_baseline
from bench.compare.benchmarks import are_benchmarks, compare_benchmarks, read_benchmarks
from bench.compare.checkouts import prepare
from bench.compare.comparison import compare_runs
from bench.compare.findings import GATES, chosen_gates
from bench.compare.interleave import run_interleaved
from bench.execution.results import check_folder
from bench.studies.schema import load_study, study_names
from bench.studies.selection import default_part
from reports.records.atomic import write_atomic


def compare(
    base: Annotated[
        str,
        typer.Argument(
            help="The base: a results folder, a baseline file or a pytest-benchmark file; with --run a version."
        ),
    ],
    head: Annotated[str, typer.Argument(help="The head: the same kinds as BASE.")],
    fail_on: Annotated[str, typer.Option(help="Gates whose alarms give exit status 1, or 'none'.")] = ",".join(GATES),
    across_versions: Annotated[
        bool, typer.Option("--across-versions", help="Also judge trials whose engine has another version.")
    ] = False,
    markdown: Annotated[Path | None, typer.Option(metavar="FILE", help="Write the tables as Markdown.")] = None,
    junit: Annotated[Path | None, typer.Option(metavar="FILE", help="Write JUnit XML.")] = None,
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
) -> None:
    """Compare two runs for regressions of outcome, trajectory and time; exit status 1 if a gate raises an alarm."""
    with input_errors():
        gates = chosen_gates(fail_on)
        if run_both:
            plan = default_part(load_study(study)) if study in study_names() else load_study(study)
            folder = out or RESULTS / f"compare-{datetime.now(UTC):%Y%m%d-%H%M%S}"
            check_folder(folder)
            versions = prepare(base, base_with or (), ERR), prepare(head, head_with or (), ERR)
            sides = run_interleaved(versions, plan, rounds, folder, ERR)
            comparison = compare_runs(*sides, (base, head), across_versions=across_versions)
        elif are_benchmarks(Path(base), Path(head)):
            gates = tuple(gate for gate in gates if gate == "time")
            frame_times = read_benchmarks(Path(base)), read_benchmarks(Path(head))
            comparison = compare_benchmarks(*frame_times, across_versions=across_versions)
        else:
            sides = read_baseline(Path(base)), read_baseline(Path(head))
            comparison = compare_runs(*sides, (base, head), across_versions=across_versions)
        if markdown is not None:
            write_atomic(markdown, render.markdown(comparison, gates).encode())
        if junit is not None:
            write_atomic(junit, render.junit(comparison, gates))
    if as_json:
        typer.echo(render.as_json(comparison, gates))
    else:
        render.show(comparison, gates, OUT)
    raise typer.Exit(1 if comparison.alarms(gates) else 0)
