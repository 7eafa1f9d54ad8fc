"""Run both versions in alternating order (A B, B A, A B ...), so that slow drifts of the machine's speed cancel."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from rich.console import Console

from bench.compare.baseline import read_baseline
from bench.compare.checkouts import Checkout
from bench.compare.failures import require_results
from bench.compare.side import Baseline, Machine
from bench.compare.timing import Part
from bench.studies.schema import Study
from bench.studies.tolerance import Tolerance
from bench.studies.toml_text import to_toml
from reports.records.atomic import write_atomic
from reports.records.trial import TrialRecord


def run_interleaved(
    sides: tuple[Checkout, Checkout], study: Study, rounds: int, out: Path, console: Console
) -> tuple[Baseline, Baseline]:
    """Run ``study`` ``rounds`` times with base and with head, in alternating order; return the results of both sides.

    The result for each side joins the repeats of all runs of this side. An interrupted run continues in the same
    folder.

    Args:
        sides: checkouts of base and head.
        study: the study for both sides; the comparison uses the tolerances of this study.
        rounds: number of runs of each side.
        out: folder for the results of all runs.
        console: console that shows the start of each run.

    Raises:
        CheckoutError: if a side cannot run the study.
        BaselineError: if a run of a side has no records, or an invalid file.
        SideFailedError: if no trial of a run has a result.
    """
    out.mkdir(parents=True, exist_ok=True)
    plan = (out / "study.toml").resolve()
    write_atomic(plan, to_toml(_without_tolerances(study)).encode())
    results: tuple[list[Baseline], list[Baseline]] = ([], [])
    for number in range(rounds):
        for side in (0, 1) if number % 2 == 0 else (1, 0):
            folder = out / f"{('base', 'head')[side]}-{number + 1}"
            console.print(f"round {number + 1} of {rounds}: {sides[side].name}", highlight=False)
            sides[side].run(plan, folder.resolve())
            run = read_baseline(folder)
            require_results(run, sides[side].name)
            results[side].append(run)
    tolerances = {scenario.name: scenario.tolerance for scenario in study.scenario}
    base, head = (as_repeats(runs, study.repeats) for runs in results)
    return base, head.model_copy(update={"tolerances": tolerances})


def as_repeats(runs: Sequence[Baseline], repeats: int) -> Baseline:
    """Join several runs of a study, each with ``repeats`` repeats, into one run with more repeats."""
    shares: dict[str, Mapping[Part, float]] = {}
    machines: dict[str, Machine] = {}
    trials: list[TrialRecord] = []
    for number, run in enumerate(runs):
        machines.update(run.machines)
        for record in run.trials:
            repeat = record.repeat + number * repeats
            name = f"{record.trial.rpartition('.r')[0]}.r{repeat}"
            trials.append(record.model_copy(update={"trial": name, "repeat": repeat}))
            if record.trial in run.shares:
                shares[name] = run.shares[record.trial]
    joined = runs[0].model_copy(update={"shares": shares, "machines": machines, "trials": trials})
    return joined.with_trace_files({name: file for run in runs for name, file in run.trace_files.items()})


def _without_tolerances(study: Study) -> Study:
    """Return the study without tolerances, because an older version of the suite may reject that field."""
    plain = [scenario.model_copy(update={"tolerance": Tolerance()}) for scenario in study.scenario]
    return study.model_copy(update={"scenario": plain})
