"""Runs trials, each in a fresh process: a crash or a hang costs one trial, and no engine sees another's leftovers."""

from __future__ import annotations

import faulthandler
import multiprocessing
import os
import signal
import sys
import tempfile
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, wait
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path
from time import monotonic
from typing import Any, Protocol

from pebble import ProcessExpired, ProcessFuture
from pebble.concurrent import process

from bench.plan import Trial
from bench.play import Progress
from bench.rehearsal import rehearse
from bench.studies import Limits
from bench.trial import Outcome, bare_record, run_trial
from reports.records import Status, TrialRecord

GRACE_S = 60.0
"""A trial stops itself at its limit; a process that still lives so much later [s] hangs in the engine."""
_POLL_S = 0.2
_TELL_S = 0.25
"""Progress is told no more often than this [s], lest telling disturbs the timing."""
_START_METHOD = "forkserver" if "forkserver" in multiprocessing.get_all_start_methods() else "spawn"
_CONTEXT = multiprocessing.get_context(_START_METHOD)


class Observer(Protocol):
    """Who is told how a run goes on."""

    def started(self, trial: Trial) -> None:
        """A trial begins."""

    def progressed(self, trial: Trial, progress: Progress) -> None:
        """A trial has got somewhat further."""

    def finished(self, trial: Trial, record: TrialRecord) -> None:
        """A trial has ended, however it did."""


@dataclass(frozen=True, slots=True)
class _Running:
    trial: Trial
    future: ProcessFuture[Outcome]
    progress: Connection
    log: Path


def get_ready(policies: Sequence[str]) -> None:
    """Start the server from which trials are forked; it loads the harness, and compiles the core for ``policies``.

    A trial's process is fresh all the same: the server never opens an engine. It saves seconds a trial of loading the
    core, and no trial pays for compiling it.
    """
    modules = ["bench.runner", *(["bench.compiled_core"] if policies else [])]
    multiprocessing.set_forkserver_preload(modules)
    for policy in policies:
        _in_process(rehearse, None)(policy).result()


def run_trials(
    trials: Sequence[Trial], limits: Limits, environment: str, jobs: int, observer: Observer
) -> Iterator[Outcome]:
    """Outcomes in the order in which trials finish; those still running are stopped when the caller stops.

    Args:
        trials: what to run.
        limits: when a trial stops.
        environment: digest of the environment, for the records.
        jobs: how many trials run at a time; more than one disturbs the timings.
        observer: is told how it goes on.
    """
    waiting = deque(trials)
    running: list[_Running] = []
    with tempfile.TemporaryDirectory(prefix="stillstack-") as folder:
        try:
            while waiting or running:
                while waiting and len(running) < jobs:
                    running.append(_start(waiting.popleft(), limits, environment, Path(folder)))
                    observer.started(running[-1].trial)
                done = wait([one.future for one in running], _POLL_S, FIRST_COMPLETED).done
                for one in list(running):
                    for progress in _drain(one.progress):
                        observer.progressed(one.trial, progress)
                    if one.future in done:
                        running.remove(one)
                        one.progress.close()
                        outcome = _outcome(one, environment)
                        observer.finished(one.trial, outcome.record)
                        yield outcome
        finally:
            for one in running:
                one.future.cancel()  # type: ignore[no-untyped-call]


def _start(trial: Trial, limits: Limits, environment: str, folder: Path) -> _Running:
    reader, writer = _CONTEXT.Pipe(duplex=False)
    log = folder / f"{trial.id}.log"
    future = _in_process(_run_in_child, limits.trial_wall_s + GRACE_S)(trial, limits, environment, writer, log)
    writer.close()
    return _Running(trial, future, reader, log)


def _in_process(function: Callable[..., Any], timeout_s: float | None) -> Callable[..., Any]:
    """``function`` in a fresh process that an interrupt does not reach: the parent stops it."""
    # pebble 5.2 declares the keyword as mp_context but reads it as context, and silently forks without it
    launch = process(name="stillstack-trial", timeout=timeout_s, context=_CONTEXT)(function)  # type: ignore[call-overload]

    def start(*arguments: Any) -> Any:
        with _interrupts_ignored():
            return launch(*arguments)

    return start


@contextmanager
def _interrupts_ignored() -> Iterator[None]:
    """A child starts with the parent's way of handling an interrupt, already while it still imports."""
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def _run_in_child(trial: Trial, limits: Limits, environment: str, writer: Connection, log: Path) -> Outcome:
    _send_output_to(log)
    last = -_TELL_S

    def tell(progress: Progress) -> None:
        nonlocal last
        now = monotonic()
        if now - last >= _TELL_S:
            last = now
            writer.send(progress)

    return run_trial(trial, limits, environment, tell)


def _send_output_to(log: Path) -> None:
    """Engines print at will: keep it off the terminal, and keep it for a crash's last words."""
    with log.open("w", encoding="utf-8") as file:
        os.dup2(file.fileno(), 1)
        os.dup2(file.fileno(), 2)
    faulthandler.enable(sys.stderr)


def _drain(reader: Connection) -> Iterator[Progress]:
    try:
        while reader.poll():
            yield reader.recv()
    except (EOFError, OSError):
        return


def _outcome(one: _Running, environment: str) -> Outcome:
    try:
        return one.future.result()
    except ProcessExpired as error:
        return _lost(one, environment, "crashed", f"{_ending(error.exitcode)}: {_last_words(one.log)}")
    except TimeoutError:
        return _lost(one, environment, "timeout", "the engine hung and was stopped; how far it got is not known")
    except MemoryError:
        return _lost(one, environment, "out_of_memory", "the process ran out of memory")
    except Exception as error:  # a fault of the harness itself costs this trial, not the run
        return _lost(one, environment, "error", f"harness: {type(error).__name__}: {error}")


def _lost(one: _Running, environment: str, status: Status, message: str) -> Outcome:
    """The record of a trial whose process left none."""
    scene = one.trial.build_scene()
    return Outcome(bare_record(one.trial, scene, environment, status, message), [])


def _ending(exitcode: int | None) -> str:
    if exitcode is not None and exitcode < 0:
        return f"the process died of {signal.Signals(-exitcode).name}"
    return f"the process ended with status {exitcode}"


def _last_words(log: Path) -> str:
    """What a crashed process printed last: Python's line on a fatal error if there is one."""
    if not log.exists():
        return "it said nothing"
    lines = [line.strip() for line in log.read_text(encoding="utf-8", errors="replace").splitlines() if line.strip()]
    fatal = [line for line in lines if line.startswith("Fatal Python error")]
    return (fatal or lines or ["it said nothing"])[-1][:300]
