"""A digest of the sources: the version of the code and of the engines' settings behind a result."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from pathlib import Path

ROOT = Path(__file__).parents[2]
SUITE = tuple(ROOT / name for name in ("stability_core", "scenarios", "adapters", "reports", "bench"))
"""Every folder whose code takes part in a trial."""
PUBLISHED = ROOT / "docs" / "results"
"""Folder of the published studies."""


def sources_digest(folders: Iterable[Path]) -> str:
    """Return the digest of all Python files below ``folders``, and of the engines' profiles: names and content."""
    digest = hashlib.blake2b(digest_size=8)
    for folder in folders:
        for path in sorted([*folder.rglob("*.py"), *folder.glob("profiles/*.toml")]):
            digest.update(path.relative_to(folder).as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()
