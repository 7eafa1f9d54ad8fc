"""Files that are either whole or not there, whatever cuts the writing off."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def atomic_file(path: Path) -> Iterator[Path]:
    """A path to write to in place of ``path``, which then takes its place at once; nothing if the writing fails."""
    draft = path.with_name(path.name + ".part")
    try:
        yield draft
        with draft.open("rb") as file:
            os.fsync(file.fileno())  # else a power cut may leave the new name on an empty file
        draft.replace(path)
    finally:
        draft.unlink(missing_ok=True)


def write_atomic(path: Path, content: bytes) -> None:
    """Write a file that is whole or not there."""
    with atomic_file(path) as draft:
        draft.write_bytes(content)
