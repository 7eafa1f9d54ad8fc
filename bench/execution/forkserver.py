"""Processes of the fork server, of which several threads may ask at once how one ended.

``multiprocessing`` reads a child's exit status from a pipe, where it lies once. Of two threads that ask at the same
moment one gets it, and the other, which finds the pipe at its end, notes 255. Here they do: starting a trial looks
after all children, while other threads wait for theirs.
"""

from __future__ import annotations

import os
import threading
from multiprocessing import connection, context, popen_forkserver
from multiprocessing.process import BaseProcess
from typing import ClassVar


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
