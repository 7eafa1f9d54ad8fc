"""The server from which trials are forked: it has loaded the harness and the engines, but never opened one.

Several threads may ask at once how one of its processes ended. ``multiprocessing`` reads a child's exit status from a
pipe, where it lies once. Of two threads that ask at the same moment one gets it, and the other, which finds the pipe at
its end, notes 255. Here they do: starting a trial looks after all children, while other threads wait for theirs.
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
"""Environment variable that names the policies for which the server compiles: it is started with no other word."""


class _Popen(popen_forkserver.Popen):
    _asking: ClassVar[threading.Lock] = threading.Lock()
    """Held for as long as it takes to read a status that has come."""

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
"""In place of ``multiprocessing.get_context("forkserver")``."""


def start_server(engines: Sequence[str], core_policies: Sequence[str]) -> None:
    """Start the server from which trials are forked; a Ctrl-C in the terminal reaches neither it nor them.

    Args:
        engines: whose modules it loads.
        core_policies: for which it compiles the core; a policy that no trial uses costs nothing.
    """
    modules = [ENGINES[engine].module for engine in engines]
    core = ["bench.execution.preload_core"] if core_policies else []
    os.environ[WANTED_POLICIES] = ",".join(core_policies)
    forkserver.set_forkserver_preload(["bench.execution.worker", *modules, *core, "bench.execution.preload"])
    resource_tracker.ensure_running()  # its start would let the signal through again
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})  # works in a cluster worker's threads too
    try:
        forkserver.ensure_running()
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def await_server() -> None:
    """Return when the server has loaded everything, and compiled the core if need be."""
    in_process(os.getpid, None)().result()


def stop_everything() -> None:
    """End the server and every trial that still runs."""
    for child in psutil.Process().children(recursive=True):
        try:
            child.kill()
        except psutil.NoSuchProcess:
            continue


def in_process(function: Callable[..., Any], timeout_s: float | None) -> Callable[..., Any]:
    """``function`` in a fresh process that is ended after ``timeout_s`` [s]."""
    # pebble 5.2 declares the keyword as mp_context but reads it as context, and silently forks without it
    return process(name="stillstack-trial", timeout=timeout_s, context=CONTEXT)(function)  # type: ignore[call-overload, no-any-return]
