"""Interruptions: Ctrl-C, ``kill`` and a closed terminal set a flag, which the run checks between complete writes."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from types import FrameType, TracebackType
from typing import Any

_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


class Interruption(AbstractContextManager["Interruption"]):
    """Context in which the first signal to stop sets ``signal``, and later signals change nothing."""

    def __init__(self) -> None:
        self.signal: int | None = None
        """Number of the first signal to stop; None if there was none."""
        self._before: dict[int, Any] = {}
        self._raises = False

    def __enter__(self) -> Interruption:
        self._before = {number: signal.signal(number, self._note) for number in _SIGNALS}
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def is_set(self) -> bool:
        """Return whether a signal to stop has arrived."""
        return self.signal is not None

    @property
    def exit_status(self) -> int:
        """Exit status of a program that ``signal`` has stopped: 128 plus ``signal``; 128 without a signal."""
        return 128 + (self.signal or 0)

    @contextmanager
    def at_once(self) -> Iterator[None]:
        """Make the first interruption raise KeyboardInterrupt inside the block, for calls that cannot check the flag.

        Raises:
            KeyboardInterrupt: if a signal arrives inside the block, or has arrived before.
        """
        if self.signal is not None:
            raise KeyboardInterrupt
        self._raises = True
        try:
            yield
        finally:
            self._raises = False

    def _note(self, number: int, _: FrameType | None) -> None:
        if self.signal is None:
            self.signal = number
            if self._raises:
                raise KeyboardInterrupt
