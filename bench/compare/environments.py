"""Environments with resolved packages, which comparisons share and keep for later comparisons.

An environment contains exactly the resolved packages, without the suite, which runs from a checkout's folder. An
environment may extend a shared environment. Then it contains only the packages that the shared environment lacks or has
in another version, and Python looks for its packages first.
"""

from __future__ import annotations

import hashlib
import os
import shutil
from collections.abc import Sequence
from pathlib import Path

from filelock import FileLock
from packaging.requirements import Requirement
from rich.console import Console

from bench.compare.commands import PYTHON, UV, call
from reports.records.atomic import write_atomic

CACHE = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "stillstack"
"""Folder of the suite's caches."""
_REQUIREMENTS = "requirements.txt"
"""File in an environment's folder with its packages. ``environment`` writes this file last, so that the file
marks a complete environment."""
_LINK = "shared.pth"
"""File that adds the folder of the shared environment's packages, after the environment's own packages."""


def environments_folder() -> Path:
    """Return the folder of all environments."""
    return CACHE / "environments"


def environment(name: str, pins: Sequence[str], console: Console, *, on: Sequence[str] = ()) -> Path:
    """Return the interpreter of an environment with the packages ``pins``; create the environment if necessary.

    Args:
        name: the side of the comparison, for messages.
        pins: requirements with versions.
        console: console that shows the start of the installation.
        on: packages of the shared environment to extend; empty for an environment that extends none.

    Raises:
        CheckoutError: if uv cannot create the environment or install a package.
    """
    own = sorted(set(pins) - set(on))
    shared = environment("the suite", on, console) if on else None
    folder = environments_folder() / _digest(pins, on)
    python = folder / ".venv" / "bin" / "python"
    folder.parent.mkdir(parents=True, exist_ok=True)
    with FileLock(folder.with_suffix(".lock")):
        if (folder / _REQUIREMENTS).exists():
            return python
        console.print(f"installing {len(own)} packages for {name}", highlight=False)
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        draft = folder / "draft.txt"
        draft.write_text("".join(f"{pin}\n" for pin in own), encoding="utf-8")
        call(name, [UV, "venv", "--quiet", "--python", PYTHON, str(folder / ".venv")], folder)
        fix = "a package has no wheel for this machine and does not build; choose another version"
        call(name, [UV, "pip", "sync", "--quiet", "--python", str(python), str(draft)], folder, fix)
        if shared is not None:
            (_packages(python) / _LINK).write_text(f"{_packages(shared)}\n", encoding="utf-8")
        write_atomic(folder / _REQUIREMENTS, draft.read_bytes())
    return python


def is_complete(pins: Sequence[str], on: Sequence[str] = ()) -> bool:
    """Return whether an environment with ``pins`` exists that extends the shared environment with ``on``."""
    return (environments_folder() / _digest(pins, on) / _REQUIREMENTS).exists()


def remove_environment(python: Path) -> None:
    """Remove the environment of an interpreter, unless the environment is outside ``environments_folder``.

    The cache of uv keeps the packages.
    """
    folder = python.parents[2]
    if folder.parent == environments_folder():
        with FileLock(folder.with_suffix(".lock")):
            shutil.rmtree(folder, ignore_errors=True)
        folder.with_suffix(".lock").unlink(missing_ok=True)


def prune_environments() -> list[Path]:
    """Remove all environments; return their folders."""
    folders = sorted(path for path in environments_folder().glob("*") if path.is_dir())
    for folder in folders:
        remove_environment(folder / ".venv" / "bin" / "python")
    return folders


def _packages(python: Path) -> Path:
    """Return the folder of the packages of an interpreter's environment."""
    return python.parents[1] / "lib" / f"python{PYTHON}" / "site-packages"


def _digest(pins: Sequence[str], on: Sequence[str] = ()) -> str:
    """Return the digest of the packages and of the content of local files, because a rebuild may change a file."""
    digest = hashlib.blake2b("\n".join(sorted(on)).encode(), digest_size=6)
    for pin in sorted(pins):
        digest.update(pin.encode() + b"\0")
        address = Requirement(pin).url or ""
        path = Path(address.removeprefix("file://"))
        if address.startswith("file://") and path.is_file():
            digest.update(path.read_bytes())
    return digest.hexdigest()
