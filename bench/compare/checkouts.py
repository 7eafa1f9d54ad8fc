"""Checkouts of two versions of the suite, each with an environment of its own packages."""

from __future__ import annotations

import shutil
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console

from bench.compare.commands import CheckoutError, call
from bench.compare.environments import CACHE, environment
from bench.compare.requirements import pinned
from bench.machine.source_digest import ROOT

_NO_REPORT = "--no-report"
"""Option of ``bench run`` that earlier versions of the suite do not have."""


@dataclass(frozen=True, slots=True)
class Checkout:
    """A version of the suite, ready to run."""

    name: str
    """Name for messages and tables."""
    folder: Path
    python: Path
    """Interpreter of its environment."""
    pins: tuple[str, ...] = ()
    """Packages of the environment with their versions; empty for a folder with its own environment."""

    def run(self, study: Path, out: Path, *, report: bool = True) -> None:
        """Run or continue a study with this version.

        Args:
            study: file of the study.
            out: results folder.
            report: False to write no report, if this version of the suite can omit the report.

        Raises:
            CheckoutError: if the run fails.
        """
        command = [str(self.python), "-m", "bench", "run", str(study), "--out", str(out)]
        can_omit = _NO_REPORT in (self.folder / "bench" / "cli" / "run.py").read_text(encoding="utf-8")
        call(self.name, [*command, *([] if report or not can_omit else [_NO_REPORT])], self.folder)


def prepare(
    version: str,
    packages: Sequence[str],
    console: Console,
    *,
    engines: Iterable[str],
    allow_dirty: bool = False,
    option: str = "",
) -> Checkout:
    """Return a checkout of ``version`` with its own environment.

    Args:
        version: a commit, a branch or a tag; or a folder with a checkout, which stays unchanged.
        packages: packages that replace locked packages, such as the wheel of another build of an engine.
        console: console that shows the start of each slow step.
        engines: names of the engines to install.
        allow_dirty: True to accept uncommitted changes.
        option: option of the user's command that accepts uncommitted changes, for the message; empty without an option.

    Raises:
        CheckoutError: if the version does not exist; if uv cannot install a package; if the version has uncommitted
            changes, and ``allow_dirty`` is False; or for a folder without an environment, or with ``packages``.
    """
    if (Path(version) / "bench" / "__main__.py").is_file():
        return _folder(version, packages, allow_dirty, option)
    folder = checked_out(version, console, allow_dirty=allow_dirty, option=option)
    pins = pinned(version, folder, engines, packages)
    return Checkout(version, folder, environment(version, pins, console), tuple(pins))


def checked_out(version: str, console: Console, *, allow_dirty: bool = False, option: str = "") -> Path:
    """Return the cached checkout of a version, without an environment; create the checkout if necessary.

    Raises:
        CheckoutError: if the version does not exist; or, without ``allow_dirty``, if the version is the present commit
            and the checkout has uncommitted changes.
    """
    commit = call(
        version,
        ["git", "rev-parse", "--verify", "--end-of-options", f"{version}^{{commit}}"],
        ROOT,
        "name a commit, a branch, a tag, or the folder of a checkout",
    ).strip()
    if not allow_dirty and commit == call(version, ["git", "rev-parse", "HEAD"], ROOT).strip():
        _refuse_changes(version, ROOT, "a checkout of the commit leaves out uncommitted changes", option)
    folder = CACHE / "checkouts" / commit[:12]
    if not (folder / "bench").exists():
        console.print(f"checking out {version} (commit {commit[:12]})", highlight=False)
        call(version, ["git", "worktree", "add", "--detach", "--force", str(folder), commit], ROOT)
    return folder


def named_by_difference(sides: tuple[Checkout, Checkout], packages: tuple[Sequence[str], Sequence[str]]) -> list[str]:
    """Return the names of base and head, which state their differences: version of the suite, chosen packages, or both.

    If only one side has chosen packages, the name of the other side states the locked versions of these packages.
    """
    pins = [dict(pin.partition("==")[::2] for pin in side.pins if "==" in pin) for side in sides]
    chosen = sorted({name for versions in pins for name in versions if len({pin.get(name) for pin in pins}) > 1})
    names = []
    for side, pin, asked in zip(sides, pins, packages, strict=True):
        replaced = [Path(package).name if Path(package).exists() else package.replace("==", " ") for package in asked]
        chosen_names = {package.split(" ")[0] for package in replaced}
        wanted = {package.partition("==")[0] for of_side in packages for package in of_side}
        kept = [f"{name} {pin[name]}" for name in chosen if name in wanted - chosen_names and name in pin]
        same_suite = sides[0].name == sides[1].name
        parts = [*([] if same_suite else [side.name]), *replaced, *kept]
        names.append(", ".join(parts) or side.name)
    return names


def prune_checkouts(console: Console) -> int:
    """Remove all checkouts from the cache; return their number."""
    folders = sorted(path for path in (CACHE / "checkouts").glob("*") if path.is_dir())
    for folder in folders:
        try:
            call(folder.name, ["git", "worktree", "remove", "--force", str(folder)], ROOT)
        except CheckoutError:  # of another clone, or damaged
            shutil.rmtree(folder, ignore_errors=True)
        console.print(f"removed the checkout {folder.name}", highlight=False)
    call("prune", ["git", "worktree", "prune"], ROOT)
    return len(folders)


def _folder(version: str, packages: Sequence[str], allow_dirty: bool, option: str) -> Checkout:
    """Return the checkout in a folder of the user, with the environment ``.venv`` of this folder.

    Raises:
        CheckoutError: if ``packages`` is not empty; if the folder has no environment; or, without ``allow_dirty``, if
            the folder has uncommitted changes.
    """
    checkout = Checkout(version, Path(version).resolve(), Path(version).resolve() / ".venv" / "bin" / "python")
    if packages:
        raise CheckoutError(
            f"--base-with and --head-with need a commit, a branch or a tag, but {version} is a folder: install "
            f"{', '.join(packages)} in the environment of the folder, and leave out the option"
        )
    if not checkout.python.exists():
        raise CheckoutError(
            f"{version}: the folder must contain an environment (.venv), but does not: run 'uv sync' in the folder"
        )
    if not allow_dirty and (checkout.folder / ".git").exists():
        _refuse_changes(version, checkout.folder, "no commit names the changed sources", option)
    return checkout


def _refuse_changes(version: str, folder: Path, why: str, option: str) -> None:
    """Raise ``CheckoutError`` if tracked files have uncommitted changes."""
    changed = call(version, ["git", "status", "--porcelain", "--untracked-files=no"], folder).splitlines()
    if changed:
        changes = f"{len(changed)} files with uncommitted changes, the first {changed[0][3:]!r}"
        if len(changed) == 1:
            changes = f"1 file with uncommitted changes, {changed[0][3:]!r}"
        raise CheckoutError(
            f"{version}: {folder} has {changes}, but {why}: run 'git commit' or 'git stash' in the folder"
            f"{f', or give {option}' if option else ''}"
        )
