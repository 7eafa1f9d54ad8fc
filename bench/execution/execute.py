"""Run the trials of a study in processes of this machine or on a cluster, and show the progress."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import nullcontext
from typing import Any

from rich.console import Console

from bench.execution.compile_bar import CompileBar
from bench.execution.forkserver import await_server, start_server, stop_everything
from bench.execution.local import run_trials
from bench.execution.progress import show_progress
from bench.execution.signals import Interruption
from bench.machine.environment import digest
from bench.studies.plan import Trial
from bench.studies.policies import BENCH_POLICIES
from bench.studies.schema import Study
from bench.trial.run_trial import Outcome


def outcomes_here(
    study: Study,
    trials: Sequence[Trial],
    environment: Mapping[str, Any],
    jobs: int,
    interruption: Interruption,
    console: Console,
    *,
    viewer: str | None = None,
) -> Iterator[Outcome]:
    """Run the ``trials`` on this machine, ``jobs`` at a time, and yield their outcomes.

    An interruption ends the running trials and the fork server. The viewer of Rerun at the address ``viewer`` shows the
    running trials; None means that there is no viewer.
    """
    core_policies = _core_policies(study)
    try:
        core_log = "ERROR" if console.is_terminal else "WARNING"  # on a terminal, a bar shows what the core would log
        start_server(study.engines, core_policies, reads_contacts=study.limits.forces, core_log=core_log)
        with interruption.at_once(), CompileBar(console) if core_policies else nullcontext():
            await_server()
        with show_progress(trials, console) as progress:
            yield from run_trials(
                trials, study.limits, digest(environment), jobs, progress, interruption.is_set, viewer=viewer
            )
    except KeyboardInterrupt:  # raised only while the server starts; the check below handles it
        pass
    if interruption.is_set():
        stop_everything()


def outcomes_on_cluster(
    study: Study,
    trials: Sequence[Trial],
    environment: Mapping[str, Any],
    address: str,
    interruption: Interruption,
    console: Console,
    know: Callable[[Mapping[str, Any]], None],
) -> Iterator[Outcome]:
    """Yield the outcomes of ``trials`` in the order in which workers finish the trials.

    Before each outcome, the function calls ``know`` with the environment whose digest is in the record.

    Raises:
        ClusterError: if no scheduler answers; if the client loses the scheduler; if a worker has other code, packages
            or engines than the client; or if a worker cannot run a trial.
    """
    from bench.execution.dask import connected, run_on_cluster  # its import takes 0.5 s; only a cluster needs it

    with connected(address) as client:
        workers = len(client.scheduler_info(n_workers=-1)["workers"])
        waits = "" if workers else ": the run waits for a first worker"
        console.print(f"workers at {address}: {workers}{waits}", highlight=False, soft_wrap=True)
        with show_progress(trials, console) as progress:
            for outcome, where in run_on_cluster(
                client,
                trials,
                study.limits,
                study.engines,
                _core_policies(study),
                environment,
                progress,
                interruption.is_set,
            ):
                know(where)
                yield outcome


def _core_policies(study: Study) -> list[str]:
    return [core for name in study.policies if (core := BENCH_POLICIES[name].core)]
