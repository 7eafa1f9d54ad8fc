"""Engines that print when they are imported would speak in the middle of the suite's own output."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager

_STDERR = 2


@contextmanager
def silenced_stderr() -> Iterator[None]:
    """The process's stderr goes nowhere; C code prints past Python's ``sys.stderr``."""
    kept, nowhere = os.dup(_STDERR), os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, _STDERR)
        yield
    finally:
        os.dup2(kept, _STDERR)
        os.close(kept)
        os.close(nowhere)
