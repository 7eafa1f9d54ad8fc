"""Run a study on a Dask cluster: workers run each trial in its own process, and the client collects the outcomes.

The user starts scheduler and workers with Dask's commands (``dask scheduler``, ``dask worker``) from the same checkout.
A worker runs as many trials at a time as it has threads. Dask runs the trials of a lost worker again on another worker.
A trial gets the status crashed if it loses more workers than Dask's setting ``distributed.scheduler.allowed-failures``.
"""

from __future__ import annotations

import logging
import multiprocessing
import platform
import tempfile
import threading
import time
import uuid
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from distributed import CancelledError, Client, Future, KilledWorker, as_completed

from bench.execution.errors import ClusterError
from bench.execution.forkserver import await_server, start_server
from bench.execution.local import Observer
from bench.execution.worker import IsolatedTrial
from bench.machine.environment import describe, digest
from bench.studies.plan import Trial
from bench.studies.schema import Limits
from bench.trial.run_trial import Outcome, bare_record

CONNECT_S = 10
"""Greatest time to wait for the answer of a scheduler [s]."""
_POLL_S = 0.2
"""Interval of the checks for outcomes, for an interruption and for a lost scheduler [s]."""
_DECISIVE = ("python", "packages", "lock_sha256", "sources", "settings", "engines")
"""Properties of an environment that must be the same on every worker, so that a trial has one outcome everywhere."""

_LOST = "the client lost the Dask scheduler: start the scheduler again, then continue with --out and the results folder"
"""Message of the error after the loss of the scheduler."""

_at_work: dict[str, set[IsolatedTrial]] = {}
"""Running trials of this worker, by the name of their run."""
_preparing = threading.Lock()
"""Lock that each thread of this worker holds while the thread starts the fork server."""


class Order(NamedTuple):
    """Instructions for a worker, the same for all trials of a run."""

    run: str
    """Unique name of the run."""
    engines: tuple[str, ...]
    """Engines whose modules the worker loads."""
    core_policies: tuple[str, ...]
    """Policies for which the worker compiles the core."""
    limits: Limits
    """Limits of each trial."""
    decisive: Mapping[str, Any]
    """Values of the properties in ``_DECISIVE`` on the client."""


class RemoteOutcome(NamedTuple):
    """Outcome of a trial, with its environment."""

    outcome: Outcome
    environment: Mapping[str, Any]
    """Environment whose digest is in the record: of the worker, or of the client if the trial lost its workers."""


@contextmanager
def connected(address: str) -> Iterator[Client]:
    """Yield a connection to the scheduler at ``address``, such as ``tcp://10.0.0.1:8786``.

    From then on, the log of Dask contains only critical messages.

    Raises:
        ClusterError: if the address is invalid, or no scheduler answers within ``CONNECT_S``.
    """
    logging.getLogger("distributed").setLevel(logging.CRITICAL)  # its tracebacks would repeat the ClusterErrors
    try:
        client = Client(address, timeout=CONNECT_S, set_as_default=False)
    except (OSError, ValueError) as error:
        raise ClusterError(
            f"--dask: no Dask scheduler answers at {address}: correct the address, or start a scheduler with 'uv run "
            f"dask scheduler', and workers with 'uv run dask worker {address}'"
        ) from error
    with client:
        yield client


def run_on_cluster(
    client: Client,
    trials: Sequence[Trial],
    limits: Limits,
    engines: Sequence[str],
    core_policies: Sequence[str],
    environment: Mapping[str, Any],
    observer: Observer,
    stopped: Callable[[], bool] = lambda: False,
) -> Iterator[RemoteOutcome]:
    """Yield outcomes in the order in which trials finish.

    If the iteration ends early and the scheduler still answers, the function ends the running trials.

    Args:
        client: connection to the scheduler.
        trials: the trials to run.
        limits: limits of a trial.
        engines: engines whose modules the workers load.
        core_policies: policies for which the workers compile the core.
        environment: environment of this process, with the values that each worker must have too.
        observer: object that receives the progress.
        stopped: function that returns True to end the run early, without outcomes of the running trials.

    Raises:
        ClusterError: if a worker has other code, packages or engines than the client; if a worker cannot run a trial;
            or if the client loses the scheduler.
    """
    decisive = {name: environment[name] for name in _DECISIVE}
    order = Order(uuid.uuid4().hex, tuple(engines), tuple(core_policies), limits, decisive)
    # one task per trial, in the study's order; a result is dropped from memory as soon as it is yielded
    futures = client.map(
        _run_trial, trials, order=order, key=[f"{trial.id}-{order.run}" for trial in trials], pure=False, batch_size=100
    )
    by_key = {future.key: trial for future, trial in zip(futures, trials, strict=True)}
    waiting = as_completed(futures, loop=client.loop)
    del futures  # the cluster frees the result of a future without references
    try:
        while by_key:
            for future in waiting.next_batch(block=False):
                trial = by_key.pop(future.key)
                result = _result(future, trial, environment)
                observer.started(trial)
                observer.finished(trial, result.outcome.record)
                yield result
            if stopped():
                return
            if client.status != "running":
                raise ClusterError(_LOST)
            time.sleep(_POLL_S)
    finally:
        if by_key and client.status == "running":
            client.cancel(list(waiting.futures), force=True)
            client.run(_stop, order.run, on_error="ignore")


def _result(future: Future[RemoteOutcome], trial: Trial, environment: Mapping[str, Any]) -> RemoteOutcome:
    try:
        return future.result()
    except KilledWorker as error:
        message = f"Dask lost {error.allowed_failures + 1} workers with this trial; see the logs of the workers"
        record = bare_record(trial, trial.planned_scene(), digest(environment), "crashed", message)
        return RemoteOutcome(Outcome(record, []), environment)
    except ClusterError:
        raise
    except CancelledError as error:
        raise ClusterError(_LOST) from error
    except Exception as error:  # a trial never raises, so the worker failed to load the code
        why = f"{type(error).__name__}: {error}"
        raise ClusterError(
            f"a worker must run trial {trial.id}, but failed ({why}): remove the cause, and start the workers again "
            "from the same checkout"
        ) from error


def _run_trial(trial: Trial, order: Order) -> RemoteOutcome:
    """Run one trial in its own process, as a task of a worker.

    Raises:
        ClusterError: if this worker has other code, packages or engines than the client.
    """
    environment = _environment(order.engines)
    different = [name for name in _DECISIVE if environment[name] != order.decisive[name]]
    if different:
        raise ClusterError(
            f"the worker on {platform.node()} must have the code and the packages of the client, but differs in: "
            f"{', '.join(different)}; run 'uv sync' there and start the worker again from the same checkout"
        )
    with _preparing:
        _prepare(order.engines, order.core_policies)
    with tempfile.TemporaryDirectory(prefix="stillstack-") as folder:
        one = IsolatedTrial(trial, order.limits, digest(environment), None, Path(folder))
        _at_work.setdefault(order.run, set()).add(one)
        try:
            return RemoteOutcome(one.outcome(), environment)
        finally:
            _at_work[order.run].discard(one)


@cache
def _environment(engines: tuple[str, ...]) -> dict[str, Any]:
    """Return the environment of this worker. The cache is valid, because the worker loads its code only once."""
    return describe(engines)


@cache
def _prepare(engines: tuple[str, ...], core_policies: tuple[str, ...]) -> None:
    # Dask's nanny makes the worker a daemon, which may not start processes; the trials end with their parent anyway
    multiprocessing.current_process().daemon = False
    start_server(engines, core_policies)
    await_server()


def _stop(run: str) -> None:
    """End this worker's running trials of an abandoned run."""
    for one in list(_at_work.get(run, ())):
        one.stop()
