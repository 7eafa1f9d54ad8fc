"""The git checkout of the suite: its commit, its state and its tracked files."""

from __future__ import annotations

import subprocess

from bench.machine.source_digest import ROOT


def git(*arguments: str) -> str | None:
    """Return the output of a git command in this checkout; None if the command fails, or does not end within 10 s.

    Without git or a checkout every command fails.
    """
    try:
        done = subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True, check=True, timeout=10)
    except (OSError, subprocess.SubprocessError):
        return None
    return done.stdout.strip()


def head() -> str | None:
    """Return the commit of this checkout; None without git or a checkout."""
    return git("rev-parse", "HEAD")


def is_modified() -> bool:
    """Return whether tracked files differ from the commit; False without git, where ``head`` returns None."""
    return bool(git("status", "--porcelain", "--untracked-files=no"))


def tracked_files(folder: str) -> list[str]:
    """Return the paths of the tracked files below a folder, relative to the checkout, sorted; empty without git."""
    return sorted(name for name in (git("ls-files", "-z", "--", folder) or "").split("\0") if name)
