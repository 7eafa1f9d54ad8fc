"""Runs the trials of a study, some at a time, and hands on what each leaves behind."""

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
"""How often progress and the wish to stop are looked at [s]."""
_CALM_S = 0.2
"""How long the cores are watched to find those that nobody uses [s]."""


class Observer(Protocol):
    """Who is told how a run goes on."""

    def started(self, trial: Trial) -> None:
        """A trial begins."""

    def progressed(self, trial: Trial, progress: Progress) -> None:
        """A trial has got somewhat further."""

    def finished(self, trial: Trial, record: TrialRecord) -> None:
        """A trial has ended, however it did."""


def run_trials(
    trials: Sequence[Trial],
    limits: Limits,
    environment: str,
    jobs: int,
    observer: Observer,
    stopped: Callable[[], bool] = lambda: False,
) -> Iterator[Outcome]:
    """Outcomes in the order in which trials finish; those still running are ended when the caller stops.

    Args:
        trials: what to run.
        limits: when a trial stops.
        environment: digest of the environment, for the records.
        jobs: how many trials run at a time; more than one disturbs the timings.
        observer: is told how it goes on.
        stopped: whether to end early, without those that still run.
    """
    waiting = deque(trials)
    running: list[IsolatedTrial] = []
    free = _cores(jobs)
    with tempfile.TemporaryDirectory(prefix="stillstack-") as folder:
        try:
            while waiting or running:
                while waiting and len(running) < jobs:
                    one = IsolatedTrial(waiting.popleft(), limits, environment, free.pop(), Path(folder))
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
    """A core for each trial that runs at a time, the calmest last; None where there are too few, or the system cannot.

    A trial that stays on its core finds its caches warm, and all of a study's trials the same ones.
    """
    allowed = allowed_cores()
    if jobs > len(allowed) or not hasattr(os, "sched_setaffinity"):
        return [None] * jobs
    busy = dict(enumerate(psutil.cpu_percent(_CALM_S, percpu=True)))
    return list(sorted(allowed, key=lambda core: (-busy.get(core, 0.0), core))[-jobs:])
