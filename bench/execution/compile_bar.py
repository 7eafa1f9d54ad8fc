"""Show on a terminal the number of compiled kernels of the core, while the fork server compiles the kernels."""

from __future__ import annotations

import threading
from contextlib import AbstractContextManager
from pathlib import Path
from types import TracebackType

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskID, TextColumn, TimeElapsedColumn

from stability_core.compiled import KEPT, NOT_KEPT

_TEXT = "compiling the core, once per version"
_POLL_S = 0.5
"""Interval of the counts of compiled kernels [s]."""


class CompileBar(AbstractContextManager["CompileBar"]):
    """Progress bar, which appears with the first kernel that another process adds to Numba's cache.

    A thread counts the kernels in the cache. At the end without an error, a line with number and time replaces the bar.
    Without a terminal no bar appears, because the core then logs the time of the compilation. If Numba cannot cache a
    kernel, a message replaces the bar.
    """

    def __init__(self, console: Console) -> None:
        self._console = console
        self._bar = Progress(
            TextColumn(_TEXT),
            BarColumn(bar_width=24),
            TextColumn("{task.completed:.0f} of up to {task.total:.0f} kernels"),
            TimeElapsedColumn(),
            console=console,
            transient=True,
        )
        self._task: TaskID | None = None
        self._cached = 0
        self._is_over = threading.Event()
        self._thread = threading.Thread(target=self._watch, daemon=True)

    def __enter__(self) -> CompileBar:
        if not self._console.is_terminal:
            return self
        if NOT_KEPT:
            self._console.print(
                "compiling the core, a minute or two: to keep the kernels for later runs, set NUMBA_CACHE_DIR to a "
                "folder that can be written",
                soft_wrap=True,
            )
        else:
            self._cached = kernels_cached()
            self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._is_over.set()
        if self._thread.ident is not None:
            self._thread.join()
        if self._task is None:
            return
        seconds = self._bar.tasks[0].elapsed or 0.0
        self._bar.stop()
        if error is None:
            count = kernels_cached() - self._cached
            self._console.print(f"compiled the core: {count} kernels in {seconds:.0f} s", highlight=False)

    def _watch(self) -> None:
        while not self._is_over.wait(_POLL_S):
            count = kernels_cached()
            if count > self._cached and self._task is None:
                if self._console.is_dumb_terminal:  # which cannot move its cursor, so that no bar is drawn
                    self._console.print(_TEXT, highlight=False)
                self._bar.start()
                self._task = self._bar.add_task("", total=len(KEPT))
            if self._task is not None:
                self._bar.update(self._task, completed=count)


def kernels_cached() -> int:
    """Count the core's kernels that have an index file of any version in Numba's cache."""
    folders = {Path(kernel.stats.cache_path) for kernel in KEPT}
    cached = {index.name.partition("-")[0] for folder in folders for index in folder.glob("*.nbi")}
    return sum(_index_name(kernel) in cached for kernel in KEPT)


def _index_name(kernel: object) -> str:
    """Return the start of the name of a kernel's index file: the last part of the module's name, and the function."""
    function = kernel.py_func  # type: ignore[attr-defined]
    return f"{function.__module__.rpartition('.')[2]}.{function.__qualname__}"
