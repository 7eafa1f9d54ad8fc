"""The fork server: the process that forks all trials. The server loads harness and engines, but opens no engine.

A lock guards the read of a child's exit status. ``multiprocessing`` reads the status from a pipe. The pipe contains the
status only once, so that the second of two threads would find the end of the pipe and record status 255. Two threads
may read at the same time, because the start of a trial polls all children while other threads wait for their own
children.
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
"""Environment variable with the policies to compile, separated by commas, because the server takes no arguments."""
CORE_LOG = "STILLSTACK_CORE_LOG"
"""Environment variable with the lowest level of messages that the core logs in the server."""


class _Popen(popen_forkserver.Popen):
    _asking: ClassVar[threading.Lock] = threading.Lock()
    """Lock that guards the read of a child's exit status."""

    def poll(self, flag: int = os.WNOHANG) -> int | None:
        if self.returncode is None and connection.wait([self.sentinel], 0 if flag == os.WNOHANG else None):
            with self._asking:
                super().poll(flag)
        return self.returncode


class _Process(context.ForkServerProcess):
    @staticmethod
    def _Popen(process_obj: BaseProcess) -> popen_forkserver.Popen:  # noqa: N802 - the name that multiprocessing requires
        return _Popen(process_obj)


class _Context(context.ForkServerContext):
    Process = _Process


CONTEXT = _Context()
"""Replacement for ``multiprocessing.get_context("forkserver")``, with the lock around the read of exit statuses."""


def start_server(
    engines: Sequence[str], core_policies: Sequence[str], *, reads_contacts: bool = False, core_log: str = "WARNING"
) -> None:
    """Start the fork server, so that Ctrl-C in the terminal interrupts neither the server nor the trials.

    A server that already runs stays as it is.

    Args:
        engines: engines whose modules the server loads.
        core_policies: policies for which the server compiles the core; empty if no trial uses the core.
        reads_contacts: True if trials without the core also read contacts.
        core_log: lowest level of messages that the core logs in the server, such as the message about its compilation.
    """
    modules = [ENGINES[engine].module for engine in engines]
    core = ["bench.execution.preload_core"] if core_policies else []
    contacts = ["bench.execution.preload_contacts"] if core_policies or reads_contacts else []
    os.environ |= {WANTED_POLICIES: ",".join(core_policies), CORE_LOG: core_log}
    last = "bench.execution.preload"
    forkserver.set_forkserver_preload(["bench.execution.worker", *modules, *core, *contacts, last])
    resource_tracker.ensure_running()  # its start inside ensure_running would unblock SIGINT
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})  # inherited by the server
    try:
        forkserver.ensure_running()
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def await_server() -> None:
    """Wait until the server has loaded all modules and, if a policy needs the core, its kernels."""
    in_process(os.getpid, None)().result()


def stop_everything() -> None:
    """Kill all descendants of this process, among them the server and every running trial."""
    for child in psutil.Process().children(recursive=True):
        try:
            child.kill()
        except psutil.NoSuchProcess:
            continue


def in_process(function: Callable[..., Any], timeout_s: float | None) -> Callable[..., Any]:
    """Return a function that runs ``function`` in a new process and returns the future of the result.

    The library pebble ends the process after ``timeout_s`` [s]; None sets no limit.
    """
    # pebble 5.2 declares the keyword as mp_context but reads it as context, and silently forks without it
    return process(name="stillstack-trial", timeout=timeout_s, context=CONTEXT)(function)  # type: ignore[call-overload, no-any-return]
