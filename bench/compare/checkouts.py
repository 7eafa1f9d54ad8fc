"""Checkouts of two versions of the suite, each with its own environment."""

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
"""Folder that keeps the checkouts, so that a later comparison need not install or compile them again."""
_UV = os.environ.get("UV", "uv")  # 'uv run' sets this variable
_INHERITED = ("VIRTUAL_ENV", "PYTHONPATH")
"""Environment variables to remove, because they would make a checkout use the environment of this process."""


class CheckoutError(ValueError):
    """A version that cannot be checked out, installed or run; the message names the reason and the fix."""


@dataclass(frozen=True, slots=True)
class Checkout:
    """A version of the suite that can be run."""

    name: str
    """Name given by the user."""
    folder: Path

    @property
    def python(self) -> Path:
        """Path of the interpreter in the checkout's environment."""
        return self.folder / ".venv" / "bin" / "python"

    def run(self, study: Path, out: Path) -> None:
        """Run or continue a study with this version.

        Args:
            study: file of the study.
            out: results folder.

        Raises:
            CheckoutError: if the run fails.
        """
        _call(self.name, [str(self.python), "-m", "bench", "run", str(study), "--out", str(out)], self.folder)


def prepare(version: str, packages: Sequence[str], console: Console) -> Checkout:
    """Return a checkout of ``version`` with its own environment.

    Args:
        version: a commit, a branch or a tag; or a folder with a checkout, which stays unchanged.
        packages: packages to install over the locked environment, such as the wheel of another build of an engine.
        console: console that shows the start of each slow step.

    Raises:
        CheckoutError: if there is no such version, or it cannot be installed.
    """
    if (Path(version) / "bench" / "__main__.py").is_file():
        checkout = Checkout(version, Path(version).resolve())
        if packages:
            raise CheckoutError(
                f"this command installs packages only for commits, branches and tags, but {version} is a folder: "
                f"install {packages[0]} in its environment, and leave out the package"
            )
        if not checkout.python.exists():
            raise CheckoutError(
                f"{version}: the folder must contain an environment (.venv), but does not: run 'uv sync' there"
            )
        return checkout
    commit = _call(version, ["git", "rev-parse", "--verify", "--end-of-options", f"{version}^{{commit}}"], ROOT).strip()
    variant = hashlib.blake2b("\0".join(packages).encode(), digest_size=4).hexdigest() if packages else "locked"
    checkout = Checkout(version, _HOME / f"{commit[:12]}-{variant}")
    if not (checkout.folder / "bench").exists():
        console.print(f"checking out {version} (commit {commit[:12]})", highlight=False)
        _call(version, ["git", "worktree", "add", "--detach", "--force", str(checkout.folder), commit], ROOT)
    console.print(f"installing the locked packages of {version}", highlight=False)
    _call(version, [_UV, "sync", "--locked"], checkout.folder)
    if packages:
        found = [str(Path(package).resolve()) if Path(package).exists() else package for package in packages]
        _call(version, [_UV, "pip", "install", "--python", str(checkout.python), "--", *found], checkout.folder)
    return checkout


def _call(version: str, command: Sequence[str], folder: Path) -> str:
    """Return the output of a command.

    Raises:
        CheckoutError: if the command cannot be run, or fails; the message ends with its error output.
    """
    environment = {name: value for name, value in os.environ.items() if name not in _INHERITED}
    try:
        done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    except OSError as error:
        raise CheckoutError(
            f"{version}: {command[0]} cannot be run ({error.strerror}): install {command[0]}, or repair the checkout"
        ) from error
    if done.returncode != 0:
        words = " ".join(done.stderr.split())[-500:] or "no error output"
        raise CheckoutError(f"{version}: '{' '.join(command[:4])} ...' failed; correct this error: {words}")
    return done.stdout
