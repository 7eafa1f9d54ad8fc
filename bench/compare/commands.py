"""Run commands of other programs (git, uv, another checkout of the suite), and turn failures into messages."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Sequence
from pathlib import Path

UV = os.environ.get("UV", "uv")  # 'uv run' sets this variable
"""Name or path of uv."""
PYTHON = "3.11"
"""Version of Python in every environment, as in the suite's ``.python-version``."""
_INHERITED = ("VIRTUAL_ENV", "PYTHONPATH", "PYTHONHOME", "PYTHONDONTWRITEBYTECODE")
"""Environment variables to remove. The first three would make a command use the environment of this process; without
the last, every run in a new environment compiles all packages again."""
_LONGEST = 700
"""Greatest length of the error output in a message [characters]."""


class CheckoutError(ValueError):
    """A failure to check out, install or run a version; the message names the reason and the fix."""


def call(name: str, command: Sequence[str], folder: Path, fix: str = "correct this error") -> str:
    """Return the output of a command.

    Args:
        name: the version, or the side of a comparison, for which the command runs, for messages.
        command: the program and its arguments.
        folder: working directory.
        fix: advice to the user, for the message about a failed command.

    Raises:
        CheckoutError: if the command does not start, or if it fails; then the message ends with its error output.
    """
    environment = {key: value for key, value in os.environ.items() if key not in _INHERITED}
    try:
        done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    except OSError as error:
        raise CheckoutError(
            f"{name}: cannot run {command[0]} in {folder} ({error.strerror}): {_remedy(Path(command[0]), folder)}"
        ) from error
    if done.returncode != 0:
        words = _reason(done.stderr)[-_LONGEST:] or "no error output"
        shown = " ".join([Path(command[0]).name, *command[1:4]])
        raise CheckoutError(f"{name}: '{shown} ...' failed; {fix}: {words}")
    return done.stdout


def _remedy(program: Path, folder: Path) -> str:
    """Return the advice to the user for a program that does not start in a folder."""
    if not folder.is_dir():
        return "restore this folder, or remove the kept checkouts with 'bench compare --prune'"
    if program.name.startswith("python"):
        return "run 'uv sync' in this folder, or remove the kept environments with 'bench compare --prune'"
    return f"install {program.name}"


def _reason(output: str) -> str:
    """Return an error output as one line, from the last line "error: ..." on; all lines without such a line."""
    _, mark, last = ("\n" + output).rpartition("\nerror: ")
    return " ".join((last if mark else output).split())
