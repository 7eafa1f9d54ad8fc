"""Run the trials of a study on this machine, several at a time if required, and yield their outcomes."""

from __future__ import annotations

import os
import tempfile
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, wait
from pathlib import Path
from typing import Protocol

import psutil

from bench.execution.worker import IsolatedTrial
from bench.machine.environment import allowed_cores
from bench.studies.plan import Trial
from bench.studies.schema import Limits
from bench.trial.playback import Progress
from bench.trial.run_trial import Outcome
from reports.records.trial import TrialRecord

_POLL_S = 0.2
"""Greatest interval between checks for progress and interruptions [s]."""
_CALM_S = 0.2
"""Time over which the harness measures the load of each processor core [s], to find idle cores."""


class Observer(Protocol):
    """Receiver of the progress of a run."""

    def started(self, trial: Trial) -> None:
        """Receive the start of a trial."""

    def progressed(self, trial: Trial, progress: Progress) -> None:
        """Receive the progress of a trial."""

    def finished(self, trial: Trial, record: TrialRecord) -> None:
        """Receive the end of a trial, successful or not."""


def run_trials(
    trials: Sequence[Trial],
    limits: Limits,
    environment: str,
    jobs: int,
    observer: Observer,
    stopped: Callable[[], bool] = lambda: False,
    *,
    viewer: str | None = None,
) -> Iterator[Outcome]:
    """Yield outcomes in the order in which trials finish.

    If the iteration ends early, the function ends the running trials.

    Args:
        trials: the trials to run.
        limits: limits of a trial.
        environment: digest of the environment, for the records.
        jobs: greatest number of concurrent trials; more than 1 disturbs the timings.
        observer: object that receives the progress.
        stopped: function that returns True to end the run early, without outcomes of the running trials.
        viewer: address of the viewer of Rerun that shows the trials; None without a viewer.
    """
    waiting = deque(trials)
    running: list[IsolatedTrial] = []
    free = _cores(jobs)
    with tempfile.TemporaryDirectory(prefix="stillstack-") as folder:
        try:
            while waiting or running:
                while waiting and len(running) < jobs:
                    one = IsolatedTrial(waiting.popleft(), limits, environment, free.pop(), Path(folder), viewer)
                    running.append(one)
                    observer.started(one.trial)
                done = wait([one.future for one in running], _POLL_S, FIRST_COMPLETED).done
                if stopped():
                    return
                for one in list(running):
                    for progress in one.news():
                        observer.progressed(one.trial, progress)
                    if one.future in done:
                        running.remove(one)
                        free.append(one.core)
                        outcome = one.outcome()
                        observer.finished(one.trial, outcome.record)
                        yield outcome
        finally:
            for one in running:
                one.stop()


def _cores(jobs: int) -> list[int | None]:
    """Return a processor core for each concurrent trial, the core with the lowest load last.

    All trials of a call of ``run_trials`` use these cores, so that the caches of the cores keep their data. If this
    process may use fewer cores than ``jobs``, or the system does not support affinity, all entries are None. The system
    then chooses the cores.
    """
    allowed = allowed_cores()
    if jobs > len(allowed) or not hasattr(os, "sched_setaffinity"):
        return [None] * jobs
    busy = dict(enumerate(psutil.cpu_percent(_CALM_S, percpu=True)))
    return list(sorted(allowed, key=lambda core: (-busy.get(core, 0.0), core))[-jobs:])
