"""Atomic writes: after an interruption a file has either its old content or its complete new content."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def atomic_file(path: Path) -> Iterator[Path]:
    """Yield the path of a draft in the same folder. At the end of the block, the draft replaces ``path``.

    An error in the block leaves ``path`` unchanged and deletes the draft.
    """
    draft = path.with_name(path.name + ".part")
    try:
        yield draft
        with draft.open("rb") as file:
            os.fsync(file.fileno())  # without it, a power cut could leave an empty file under the new name
        draft.replace(path)
    finally:
        draft.unlink(missing_ok=True)


def write_atomic(path: Path, content: bytes) -> None:
    """Write ``content`` into a file atomically."""
    with atomic_file(path) as draft:
        draft.write_bytes(content)
