"""Two versions of the suite side by side, each with its own checkout and environment."""

from __future__ import annotations

import hashlib
import os
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console

from bench.machine.source_digest import ROOT

_HOME = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "stillstack" / "checkouts"
"""Checkouts are kept: the next comparison with the same base finds it installed, and its core compiled."""
_UV = os.environ.get("UV", "uv")  # set by 'uv run'
_INHERITED = ("VIRTUAL_ENV", "PYTHONPATH")
"""Variables that would lead a checkout to the environment of this process."""


class CheckoutError(ValueError):
    """A version that cannot be checked out, installed or run; the message states the reason."""


@dataclass(frozen=True, slots=True)
class Checkout:
    """A version of the suite that can be run."""

    name: str
    """Name given by the user."""
    folder: Path

    @property
    def python(self) -> Path:
        """The interpreter of its environment."""
        return self.folder / ".venv" / "bin" / "python"

    def run(self, study: Path, out: Path) -> None:
        """Run or continue a study with this version.

        Raises:
            CheckoutError: if the run fails.
        """
        _call(self.name, [str(self.python), "-m", "bench", "run", str(study), "--out", str(out)], self.folder)


def prepare(version: str, packages: Sequence[str], console: Console) -> Checkout:
    """Return a checkout of ``version`` with its own environment.

    Args:
        version: a commit, a branch or a tag; or a folder with a checkout, which is used unchanged.
        packages: packages to install over the locked environment, such as the wheel of another build of an engine.
        console: prints the long steps.

    Raises:
        CheckoutError: if there is no such version, or it cannot be installed.
    """
    if (Path(version) / "bench" / "__main__.py").is_file():
        checkout = Checkout(version, Path(version).resolve())
        if packages:
            raise CheckoutError(f"{version} is a folder, which is used unchanged: install {packages[0]} there yourself")
        if not checkout.python.exists():
            raise CheckoutError(f"{version} has no environment: run 'uv sync' there")
        return checkout
    commit = _call(version, ["git", "rev-parse", "--verify", "--end-of-options", f"{version}^{{commit}}"], ROOT).strip()
    variant = hashlib.blake2b("\0".join(packages).encode(), digest_size=4).hexdigest() if packages else "locked"
    checkout = Checkout(version, _HOME / f"{commit[:12]}-{variant}")
    if not (checkout.folder / "bench").exists():
        console.print(f"checking out {version} ({commit[:12]})", highlight=False)
        _call(version, ["git", "worktree", "add", "--detach", "--force", str(checkout.folder), commit], ROOT)
    console.print(f"installing what {version} needs", highlight=False)
    _call(version, [_UV, "sync", "--locked"], checkout.folder)
    if packages:
        found = [str(Path(package).resolve()) if Path(package).exists() else package for package in packages]
        _call(version, [_UV, "pip", "install", "--python", str(checkout.python), "--", *found], checkout.folder)
    return checkout


def _call(version: str, command: Sequence[str], folder: Path) -> str:
    """Return the output of a command; its error output becomes the message if it fails.

    Raises:
    CheckoutError: if the command cannot be run or fails.
    """
    environment = {name: value for name, value in os.environ.items() if name not in _INHERITED}
    try:
        done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    except OSError as error:
        raise CheckoutError(f"{version}: {command[0]} cannot be run ({error.strerror})") from error
    if done.returncode != 0:
        words = " ".join(done.stderr.split())[-500:] or "no error output"
        raise CheckoutError(f"{version}: '{' '.join(command[:4])} ...' failed: {words}")
    return done.stdout
