"""A digest of the sources, to identify the code and the engine settings of a result."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from pathlib import Path

ROOT = Path(__file__).parents[2]
"""Folder of the checkout."""
PORTS = "ports"
"""Name of the folder of the core's ports to engines. A digest of the core leaves out this folder, because a port only
passes data between engine and core."""
SUITE = tuple(
    ROOT / name for name in ("stability_core", f"stability_core/{PORTS}", "scenarios", "adapters", "reports", "bench")
)
"""Folders of the suite's code."""
PUBLISHED = ROOT / "docs" / "results"
"""Folder of the published studies."""
ROUNDS = PUBLISHED / "rounds"
"""Folder of the frozen rounds, each in a folder named by its date."""


def sources_digest(folders: Iterable[Path]) -> str:
    """Return the digest of names and content of all Python files and engine profiles below ``folders``.

    The digest has 16 hexadecimal digits. A subfolder ``PORTS`` counts only if ``folders`` lists it.
    """
    digest = hashlib.blake2b(digest_size=8)
    for folder in folders:
        for path in sorted([*folder.rglob("*.py"), *folder.glob("profiles/*.toml")]):
            name = path.relative_to(folder)
            if name.parts[0] != PORTS:
                digest.update(name.as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()
