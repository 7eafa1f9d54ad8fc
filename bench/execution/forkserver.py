"""The server from which trials are forked: it has loaded the harness and the engines, but never opened an engine.

Several threads may read the exit status of a child at the same time. ``multiprocessing`` reads it from a pipe, which
holds it once, so the second of two threads finds the end of the pipe and records 255. That happens here, because
starting a trial polls all children while other threads wait for theirs. So one lock guards the read.
"""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Sequence
from multiprocessing import connection, context, forkserver, popen_forkserver, resource_tracker
from multiprocessing.process import BaseProcess
from typing import Any, ClassVar

import psutil
from pebble.concurrent import process

from adapters import ENGINES

WANTED_POLICIES = "STILLSTACK_CORE_POLICIES"
"""Environment variable with the policies to compile: the server takes no arguments."""


class _Popen(popen_forkserver.Popen):
    _asking: ClassVar[threading.Lock] = threading.Lock()
    """Held while a status is read."""

    def poll(self, flag: int = os.WNOHANG) -> int | None:
        if self.returncode is None and connection.wait([self.sentinel], 0 if flag == os.WNOHANG else None):
            with self._asking:
                super().poll(flag)
        return self.returncode


class _Process(context.ForkServerProcess):
    @staticmethod
    def _Popen(process_obj: BaseProcess) -> popen_forkserver.Popen:  # noqa: N802 - multiprocessing calls it so
        return _Popen(process_obj)


class _Context(context.ForkServerContext):
    Process = _Process


CONTEXT = _Context()
"""Replacement for ``multiprocessing.get_context("forkserver")``."""


def start_server(engines: Sequence[str], core_policies: Sequence[str], *, reads_contacts: bool = False) -> None:
    """Start the server from which trials are forked; a Ctrl-C in the terminal reaches neither it nor the trials.

    Args:
        engines: engines whose modules it loads.
        core_policies: policies for which it compiles the core; none if no trial uses the core.
        reads_contacts: whether trials of an engine alone read contacts, too.
    """
    modules = [ENGINES[engine].module for engine in engines]
    core = ["bench.execution.preload_core"] if core_policies else []
    contacts = ["bench.execution.preload_contacts"] if core_policies or reads_contacts else []
    os.environ[WANTED_POLICIES] = ",".join(core_policies)
    last = "bench.execution.preload"
    forkserver.set_forkserver_preload(["bench.execution.worker", *modules, *core, *contacts, last])
    resource_tracker.ensure_running()  # its start would unblock the signal
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})  # works in a cluster worker's threads too
    try:
        forkserver.ensure_running()
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def await_server() -> None:
    """Wait until the server has loaded everything, and compiled the core if necessary."""
    in_process(os.getpid, None)().result()


def stop_everything() -> None:
    """End the server and every running trial."""
    for child in psutil.Process().children(recursive=True):
        try:
            child.kill()
        except psutil.NoSuchProcess:
            continue


def in_process(function: Callable[..., Any], timeout_s: float | None) -> Callable[..., Any]:
    """Return ``function`` wrapped to run in a fresh process that is ended after ``timeout_s`` [s]."""
    # pebble 5.2 declares the keyword as mp_context but reads it as context, and silently forks without it
    return process(name="stillstack-trial", timeout=timeout_s, context=CONTEXT)(function)  # type: ignore[call-overload, no-any-return]
