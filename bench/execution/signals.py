"""Ctrl-C, ``kill`` and a closed terminal as a wish to stop, looked at where nothing is half done."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from types import FrameType, TracebackType
from typing import Any

_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


class Interruption(AbstractContextManager["Interruption"]):
    """While entered, a signal to stop only sets ``signal``; pressing Ctrl-C again changes nothing."""

    def __init__(self) -> None:
        self.signal: int | None = None
        """Number of the first signal that asked to stop; None if none did."""
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
        """Whether a signal asked to stop."""
        return self.signal is not None

    @property
    def exit_status(self) -> int:
        """What a shell tells of a program that was stopped so."""
        return 128 + (self.signal or 0)

    @contextmanager
    def at_once(self) -> Iterator[None]:
        """While entered, a wish to stop breaks off a call that cannot look: it raises KeyboardInterrupt, once."""
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
