"""A study on a Dask cluster: its trials run on the workers, each in a process of its own, and come back to one writer.

Scheduler and workers are Dask's own (``dask scheduler``, ``dask worker``), started from the same checkout; how many
trials a worker runs at a time is its number of threads. Dask runs the trials of a lost worker again on another.
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
"""How long a scheduler is waited for [s]."""
_POLL_S = 0.2
"""How often the wish to stop is looked at [s]."""
_DECISIVE = ("python", "packages", "lock_sha256", "sources", "settings", "engines")
"""What must be the same on every worker, for the same trial to go the same way everywhere."""

_at_work: dict[str, set[IsolatedTrial]] = {}
"""In a worker: the trials that run there, by the run that they belong to."""
_preparing = threading.Lock()


class Order(NamedTuple):
    """What a worker is told of a run, once for all of its trials."""

    run: str
    """Unique name of the run."""
    engines: tuple[str, ...]
    core_policies: tuple[str, ...]
    limits: Limits
    decisive: Mapping[str, Any]
    """The client's own values of what must be the same."""


class RemoteOutcome(NamedTuple):
    """What came back from a worker."""

    outcome: Outcome
    environment: Mapping[str, Any]
    """Where the trial took place, as the record's digest names it."""


@contextmanager
def connected(address: str) -> Iterator[Client]:
    """A connection to the scheduler at ``address``, such as ``tcp://10.0.0.1:8786``; Dask's own log stays silent.

    Raises:
        ClusterError: if none answers there.
    """
    logging.getLogger("distributed").setLevel(logging.CRITICAL)  # its traces tell nothing that our errors do not
    try:
        client = Client(address, timeout=CONNECT_S, set_as_default=False)
    except (OSError, ValueError) as error:
        raise ClusterError(
            f"no Dask scheduler answers at {address}: start one with 'uv run dask scheduler', "
            f"and workers with 'uv run dask worker {address}'"
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
    """Outcomes in the order in which trials finish; those still running are ended when the caller stops.

    Args:
        client: connection to the scheduler.
        trials: what to run.
        limits: when a trial stops.
        engines: whose modules the workers load.
        core_policies: for which they compile the core.
        environment: of this process; a worker that would run other code or other engines is refused.
        observer: is told how it goes on.
        stopped: whether to end early, without those that still run.

    Raises:
        ClusterError: if a worker runs another checkout, or the scheduler is lost.
    """
    decisive = {name: environment[name] for name in _DECISIVE}
    order = Order(uuid.uuid4().hex, tuple(engines), tuple(core_policies), limits, decisive)
    # one task a trial, in the study's order; the results of a task are forgotten as soon as they are handed on
    futures = client.map(
        _run_trial, trials, order=order, key=[f"{trial.id}-{order.run}" for trial in trials], pure=False, batch_size=100
    )
    by_key = {future.key: trial for future, trial in zip(futures, trials, strict=True)}
    waiting = as_completed(futures, loop=client.loop)
    del futures  # a future that nobody holds is forgotten by the cluster
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
                raise ClusterError("the scheduler was lost: start it again, and the same command goes on")
            time.sleep(_POLL_S)
    finally:
        if by_key and client.status == "running":
            client.cancel(list(waiting.futures), force=True)
            client.run(_stop, order.run, on_error="ignore")


def _result(future: Future[RemoteOutcome], trial: Trial, environment: Mapping[str, Any]) -> RemoteOutcome:
    try:
        return future.result()
    except KilledWorker as error:
        message = f"{error.allowed_failures + 1} workers were lost while they ran it"
        record = bare_record(trial, trial.planned_scene(), digest(environment), "crashed", message)
        return RemoteOutcome(Outcome(record, []), environment)
    except ClusterError:
        raise
    except CancelledError as error:
        raise ClusterError("the scheduler was lost: start it again, and the same command goes on") from error
    except Exception as error:  # the trial itself raises nothing: the worker could not even load it
        why = f"{type(error).__name__}: {error}"
        raise ClusterError(f"a worker failed ({why}): start the workers anew from the same checkout") from error


def _run_trial(trial: Trial, order: Order) -> RemoteOutcome:
    """In a worker: one trial in a process of its own."""
    environment = _environment(order.engines)
    different = [name for name in _DECISIVE if environment[name] != order.decisive[name]]
    if different:
        raise ClusterError(
            f"the worker on {platform.node()} differs in: {', '.join(different)}. Start it anew from the same checkout"
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
    """As it was when this worker loaded the code: files that change later are not what it runs."""
    return describe(engines)


@cache
def _prepare(engines: tuple[str, ...], core_policies: tuple[str, ...]) -> None:
    # a worker that has a nanny is daemonic, lest it outlives it; trials see to it by themselves that they do not
    multiprocessing.current_process().daemon = False
    start_server(engines, core_policies)
    await_server()


def _stop(run: str) -> None:
    """In a worker: end the trials of a run that has been given up."""
    for one in list(_at_work.get(run, ())):
        one.stop()
